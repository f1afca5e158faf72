# SPDX-License-Identifier: GPL-3.0-or-later
"""Live: looks of what is typed, with the real engine; and that nothing of them stays."""

import time

import bpy
import pytest
from dump import contents, difference
from results import read
from vibe_render.run import preview
from vibe_render.run.state import addon_state
from vibe_render.scene import snapshot
from vibe_render.ui import live as live_ui


@pytest.fixture
def live(addon):
    """The switch is on, and nothing typed yet."""
    addon.vibe.prompt = ""
    bpy.context.window_manager.vibe_live = True
    yield addon_state
    bpy.context.window_manager.vibe_live = False


def settle(until=lambda: not addon_state.live.busy):
    """Blender's timer, until there is nothing more to do."""
    end = time.monotonic() + 120.0
    while not until():
        assert time.monotonic() < end
        live_ui._tick()
        time.sleep(0.01)


def type_in(scene, text):
    scene.vibe.prompt = text
    settle()


def test_looks_follow_the_words_and_leave_no_trace(live, addon):
    before = contents()
    type_in(addon, "glossy red cube")
    first = live.live.look.values
    assert preview.exists(addon)
    assert not snapshot.exists(addon)
    assert live.live.words.keys() == {"glossy", "red"}
    assert live.live.preview.is_file()
    type_in(addon, "glossy red cube, warm light")
    assert live.live.look.values != first
    assert difference(before, contents())
    type_in(addon, "")
    assert difference(before, contents()) == {}
    type_in(addon, "blue cube")
    bpy.context.window_manager.vibe_live = False
    assert live.live is None
    assert difference(before, contents()) == {}


def test_half_a_word_keeps_the_last_look(live, addon):
    type_in(addon, "glossy red cube")
    look = live.live.look
    type_in(addon, "glossy red cube, qzx")
    assert live.live.look.values == look.values


def test_a_key_gives_up_what_is_under_way(live, addon):
    addon.vibe.prompt = "glossy red cube"
    settle(lambda: live.live._asked)
    type_in(addon, "matte blue cube")
    assert live.live.words.keys() == {"matte", "blue"}


def test_the_scene_is_read_again_only_after_a_change(live, addon):
    type_in(addon, "glossy red cube")
    job = live.live._job / "scene.json"
    first = job.stat().st_mtime_ns
    type_in(addon, "glossy green cube")
    assert job.stat().st_mtime_ns == first
    bpy.data.lights["Point"].energy = 321.0
    bpy.context.view_layer.update()
    type_in(addon, "glossy blue cube")
    assert job.stat().st_mtime_ns > first
    assert live.live.look.values.get("light/Point/power", [321.0]) != [1000.0]


def test_a_vibe_goes_on_from_the_look_and_cancel_takes_it_away(live, addon):
    before = contents()
    type_in(addon, "glossy red cube")
    session = addon_state.begin(bpy.context)
    assert preview.exists(addon)
    while not session.asked:
        assert session.advance()
    assert preview.exists(addon)
    addon_state.cancel()
    assert not preview.exists(addon)
    assert {k for k in difference(before, contents()) if ".vibe" not in k} == set()


def test_a_file_and_an_undo_hold_none(live, addon, tmp_path):
    before = read(addon)
    bpy.ops.ed.undo_push(message="Scene")
    type_in(addon, "glossy red cube")
    shown = read(addon)
    bpy.ops.ed.undo_push(message="Words")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a.blend"), copy=True)
    assert read(addon) == shown != before
    bpy.ops.ed.undo()
    bpy.context.window_manager.vibe_live = False
    assert read(bpy.context.scene) == before
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "a.blend"))
    assert read(bpy.context.scene) == before
