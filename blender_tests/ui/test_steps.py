# SPDX-License-Identifier: GPL-3.0-or-later
"""Further sentences in the panel by their operators: the list of steps, one undo step each, and a search from the result."""

import bpy
import pytest
from dump import contents, difference
from panel_layout import drawn
from results import FOUND, PIVOT, PROMPT, read
from small_scenes import studio
from vibe_render.run import result
from vibe_render.run.state import addon_state
from vibe_render.scene import bindings
from vibe_render.scene.steps import BY_HAND, Steps
from vibe_render.ui.result import ResultPanel

from proxy_renderer.schema import messages
from proxy_renderer.schema.light_links import LightLink

WORDS = {
    "light/Area/power": "thick fog",
    "light/Sun/color": "warm light",
    "material/Body/base_color": "red",
    "material/Body/roughness": "glossy",
    "volume/density": "thick fog",
    "film/contrast": "thick fog",
}


@pytest.fixture
def vibed(addon):
    """A studio with a result in it: the scene, and a dump of before."""
    subject = studio(addon)
    before = contents()
    addon.vibe.prompt = PROMPT
    parameters = {key: {"reason": f"'{word}'"} for key, word in WORDS.items()}
    words = [{"word": word, "look": word, "target": {}} for word in dict.fromkeys(WORDS.values())]
    report = {"parameters": parameters, "goals": {"words": words}}
    result.apply(addon, PROMPT, messages.Result(FOUND, report, "prediction.png"), subject, PIVOT)
    return addon, before


def say(scene, sentence):
    scene.vibe.further = sentence
    return bpy.ops.vibe.further()


def act(number, name):
    return bpy.ops.vibe.step(number=number, act=name)


def changed(scene):
    return {change.name: change.values()[1] for change in scene.vibe.changes}


def test_a_vibe_is_the_first_step(vibed):
    scene, _ = vibed
    steps = Steps.of(scene)
    assert [step.sentence for step in steps.steps] == [PROMPT]
    assert steps.values() == {key: pytest.approx(value) for key, value in FOUND.items()}


def test_a_word_is_taken_out_by_its_name_and_its_step_off_again(vibed):
    scene, _ = vibed
    original = {change.name: change.values()[0] for change in scene.vibe.changes}
    assert say(scene, "without the fog") == {"FINISHED"}
    assert scene.vibe.further == ""
    now = read(scene)
    for key, word in WORDS.items():
        wanted = original[key] if word == "thick fog" else FOUND[key]
        assert now[key] == pytest.approx(list(wanted), rel=1e-4, abs=1e-5), key
    assert set(changed(scene)) == {key for key, word in WORDS.items() if word != "thick fog"}
    assert act(2, "SWITCH") == {"FINISHED"}
    assert read(scene) == {key: pytest.approx(value, rel=1e-4) for key, value in FOUND.items()}
    assert act(2, "REMOVE") == {"FINISHED"}
    assert len(Steps.of(scene).steps) == 1


def test_steps_are_shown_and_none_is_lost(vibed):
    scene, before = vibed
    say(scene, "half as strong")
    half = read(scene)
    assert half["light/Area/power"] != pytest.approx(FOUND["light/Area/power"])
    assert act(1, "SHOW") == {"FINISHED"}
    assert read(scene) == {key: pytest.approx(value, rel=1e-4) for key, value in FOUND.items()}
    assert act(2, "SHOW") == {"FINISHED"}
    assert read(scene) == {key: pytest.approx(value, rel=1e-4) for key, value in half.items()}
    assert say(scene, "back to the original") == {"FINISHED"}
    assert not scene.vibe.changes
    assert len(Steps.of(scene).steps) == 2
    assert bpy.ops.vibe.revert() == {"FINISHED"}
    assert difference(before, contents()) == {}


def test_changes_by_hand_become_a_step_and_stay(vibed):
    scene, _ = vibed
    area = bpy.data.objects["Area"].data
    area.energy = 123.0
    assert say(scene, "without the fog") == {"FINISHED"}
    steps = Steps.of(scene)
    assert [step.sentence for step in steps.steps] == [PROMPT, BY_HAND, "without the fog"]
    act(3, "REMOVE")
    assert area.energy == pytest.approx(123.0)
    act(2, "SWITCH")
    assert read(scene)["light/Area/power"] == pytest.approx(FOUND["light/Area/power"])


@pytest.mark.parametrize(
    ("sentence", "problem"), [("back to step 7", "no step 7"), ("no, the floor, not the dog", "names a look")]
)
def test_a_step_about_nothing_is_one_line_and_changes_nothing(vibed, sentence, problem):
    scene, _ = vibed
    before = contents()
    scene.vibe.further = sentence
    with pytest.raises(RuntimeError, match=problem):
        bpy.ops.vibe.further()
    assert scene.vibe.further == sentence  # to be corrected
    scene.vibe.further = ""
    assert not {k for k in difference(before, contents()) if "further" not in k}
    assert not bpy.ops.vibe.further.poll()


def test_a_step_is_taken_into_the_field_to_be_edited(vibed):
    scene, _ = vibed
    assert act(1, "EDIT") == {"FINISHED"}
    assert (scene.vibe.further, scene.vibe.edited) == (PROMPT, 1)
    assert act(1, "EDIT") == {"FINISHED"}
    assert (scene.vibe.further, scene.vibe.edited) == ("", 0)


def test_keep_ends_the_list(vibed):
    scene, _ = vibed
    assert bpy.ops.vibe.keep() == {"FINISHED"}
    assert Steps.of(scene) == Steps()
    assert not bpy.ops.vibe.further.poll()


@pytest.mark.slow
def test_a_further_sentence_searches_from_the_result(addon):
    """On a real engine: a prompt, a sentence that compares, the same once more by editing; Revert is exact."""
    studio(addon)
    before = contents()
    settings = addon.vibe
    settings.prompt, settings.effort, settings.anchor = "glossy red cube, warm light", "CUSTOM", False
    settings.rounds, settings.steps, settings.size = 2, 4, 64
    assert bpy.ops.vibe.run() == {"FINISHED"}
    first = bindings.read(addon, (), PIVOT)
    assert say(addon, "darker") == {"FINISHED"}
    now = bindings.read(addon, (), PIVOT)
    moved = {key for key in first if now[key] != pytest.approx(first[key], rel=1e-3, abs=1e-4)}
    assert moved
    assert moved <= {"film/exposure", "world/strength", "light/Area/power", "light/Sun/strength"}
    assert now["film/exposure"] < first["film/exposure"]
    steps = Steps.of(addon)
    assert [step.sentence for step in steps.steps] == ["glossy red cube, warm light", "darker"]
    assert steps.steps[1].is_relative

    act(2, "EDIT")
    addon.vibe.further = "a bit darker"
    assert bpy.ops.vibe.further() == {"FINISHED"}
    less = bindings.read(addon, (), PIVOT)["film/exposure"]
    assert now["film/exposure"] < less < first["film/exposure"]
    assert len(Steps.of(addon).steps) == 2
    assert addon_state.session.report["goals"]["holds"] is True
    assert bpy.ops.vibe.revert() == {"FINISHED"}
    assert not {k for k in difference(before, contents()) if ".vibe." not in k}


def test_a_link_of_a_light_is_a_change_that_its_step_takes_back(addon):
    studio(addon)
    before = contents()
    target = LightLink("Area", False, (addon.objects[0].name,)).key
    report = {"parameters": {target: {"reason": "'not on the floor'"}}}
    result.apply(addon, PROMPT, messages.Result({target: [1.0]}, report, "prediction.png"), (), PIVOT)
    linking = addon.objects["Area"].light_linking
    assert changed(addon) == {target: (1.0,)}
    drawn(ResultPanel)
    assert act(1, "SWITCH") == {"FINISHED"}
    assert linking.receiver_collection is None
    assert act(1, "SWITCH") == {"FINISHED"}
    assert linking.receiver_collection
    addon.vibe.strength = 0.2
    assert linking.receiver_collection is None
    addon.vibe.strength = 1.0
    assert linking.receiver_collection
    assert bpy.ops.vibe.revert() == {"FINISHED"}
    assert difference(before, contents()) == {}
