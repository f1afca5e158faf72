# SPDX-License-Identifier: GPL-3.0-or-later
"""Each word of the prompt is marked while it is typed, by the real engine, also while that is at work."""

import time
from types import SimpleNamespace

import bpy
import pytest
from vibe_render.run import live as session_readings
from vibe_render.run.state import addon_state
from vibe_render.ui import live as live_ui
from vibe_render.ui import words as words_ui

from proxy_renderer.schema.targets import GENERAL, target_names


@pytest.fixture
def typing(addon):
    """An engine runs, and nothing is typed yet."""
    addon.vibe.prompt = ""
    addon_state.engine(bpy.context).start()
    return addon


def read(scene, prompt):
    """The readings of a prompt that is typed now."""
    scene.vibe.prompt = prompt
    return wait(prompt)


def wait(prompt):
    """The readings of a prompt, when they have come."""
    end = time.monotonic() + 240.0
    while addon_state.readings.newest.prompt != prompt:
        assert time.monotonic() < end
        words_ui._tick()
        time.sleep(0.005)
    return {word.text: word for word in addon_state.readings.newest.words}


def test_words_are_marked_as_understood_or_left_out(typing):
    words = read(typing, "glossy red cube, sumptuous, blorfy")
    assert [word.state for word in words.values()] == ["understood", "understood", "left out", "left out"]
    assert words["sumptuous"].others  # known words that are as near are offered, and act on a click only
    assert "cube" in words["red"].meaning.lower()
    assert not addon_state.readings.due(typing)


def test_another_reading_goes_into_the_prompt(typing):
    other = read(typing, "glossy red cube, very Sumptuous")["sumptuous"].others[0]
    assert bpy.ops.vibe.reword(word="sumptuous", other=other) == {"FINISHED"}
    assert typing.vibe.prompt == f"glossy red cube, very {other}"
    assert bpy.ops.vibe.reword(word="sumptuous", other=other) == {"CANCELLED"}


def test_what_a_word_describes_is_told_with_a_click_and_stays_with_the_scene(typing):
    assert "Plane" not in read(typing, "glossy red cube")["red"].meaning
    bpy.ops.mesh.primitive_plane_add()
    bpy.context.object.data.materials.append(bpy.data.materials.new("Floor"))
    assert bpy.ops.vibe.describe(word="red", target="Plane") == {"FINISHED"}
    assert typing.vibe.engine_options(bpy.context).target == ("red=Plane",)
    assert "Plane" in reread(typing)["red"].meaning
    assert bpy.ops.vibe.describe(word="red", target="not used") == {"FINISHED"}
    assert reread(typing)["red"].state == "left out"
    assert bpy.ops.vibe.describe(word="red", target="") == {"FINISHED"}
    assert "Plane" not in reread(typing)["red"].meaning
    assert not typing.vibe.targets


def test_the_menu_offers_what_the_word_can_describe_in_the_scene(typing):
    red = read(typing, "glossy red cube, warm light")["red"]
    offered = [*red.candidates, *red.targets]
    assert len(offered) == len({*offered})
    assert {"Subject", "Floor", "not used"} <= {*offered}
    assert {*offered} <= {*GENERAL, *typing.objects.keys()}


def test_marks_follow_a_change_of_the_scene_when_it_is_quiet(typing):
    cube = typing.objects["Subject"]
    assert "Subject" in read(typing, "glossy red subject")["red"].candidates
    cube.name = "Teapot"
    bpy.context.view_layer.update()
    addon_state.readings.scene_changed()
    assert addon_state.readings.due(typing)
    red = reread(typing)["red"]
    assert "Teapot" in (*red.candidates, *red.targets)
    assert "Subject" not in (*red.candidates, *red.targets)


def test_a_word_can_describe_what_is_selected(typing):
    """Objects together, or lights together, as the word can describe them; a click on the offer is kept."""
    word, offered = read(typing, "glossy red cube, warm light")["glossy"], []
    menu = SimpleNamespace(_draw_target=lambda _layout, target, *_: offered.append(target))
    light = next(obj for obj in typing.objects if obj.type == "LIGHT")
    things = [typing.objects["Floor"], typing.objects["Subject"]]
    for selected in (things, [light], [light, *things], [typing.camera]):
        for obj in typing.objects:
            obj.select_set(obj in selected)
        words_ui.VIBE_OT_reading._draw_selection(menu, None, bpy.context.scene, word)
    assert [{*target_names(target)} for target in offered] == [{"Floor", "Subject"}]
    assert bpy.ops.vibe.describe(word="glossy", target=offered[0]) == {"FINISHED"}
    assert typing.vibe.target_pairs() == [f"glossy={offered[0]}"]
    typing.vibe.targets.clear()


def test_a_letter_needs_no_new_sketch(typing, monkeypatch):
    made = []
    monkeypatch.setattr(session_readings, "sketch_scene", lambda *given: made.append(given))
    for prompt in ("g", "gl", "glossy", "glossy red"):
        read(typing, prompt)
    assert len(made) <= 1


def test_a_scene_that_cannot_be_exported_has_marks_too(typing):
    typing.camera = None
    assert "Floor" in read(typing, "glossy red floor, warm light")["glossy"].candidates


def test_a_choice_for_a_word_that_is_gone_is_not_sent(typing):
    typing.vibe.prompt = "glossy cube"
    bpy.ops.vibe.describe(word="red", target="lights")
    assert typing.vibe.target_pairs() == []
    typing.vibe.prompt = "Red cube"
    assert typing.vibe.target_pairs() == ["red=lights"]
    typing.vibe.targets.clear()


def reread(scene):
    """The readings of the same prompt after a choice."""
    end = time.monotonic() + 240.0
    while addon_state.readings.due(scene):
        assert time.monotonic() < end
        words_ui._tick()
        time.sleep(0.005)
    return {word.text: word for word in addon_state.readings.newest.words}


def test_they_come_while_a_look_is_drawn_and_hold_it_up_by_nothing(typing):
    bpy.context.window_manager.vibe_live = True
    typing.vibe.prompt = "glossy red cube"
    end = time.monotonic() + 240.0
    while addon_state.live.look is None:
        assert time.monotonic() < end
        live_ui._tick()
        wait(typing.vibe.prompt)
        time.sleep(0.005)
    assert addon_state.live.words.keys() == {"glossy", "red"}
    bpy.context.window_manager.vibe_live = False


def test_an_engine_that_ends_is_waited_for_by_nobody(typing):
    typing.vibe.prompt = "glossy"
    words_ui._tick()
    addon_state.close_engine()
    assert words_ui._tick() is None
    addon_state.engine(bpy.context).start()
    assert "glossy" in read(typing, "glossy")
