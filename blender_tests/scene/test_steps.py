# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of steps: what the values of a scene follow from, what sentences about steps come to, and what is refused."""

import bpy
import pytest
from vibe_render.scene import snapshot
from vibe_render.scene.steps import BY_HAND, KEY, Change, Steps

from proxy_renderer.schema import VibeError

POWER, COLOR, VIGNETTE = "light/Key/power", "material/Wall/base_color", "film/vignette"


def goals(*words, holds=True):
    rows = [
        {"word": word, "look": look, "target": {"thing": thing, "materials": materials}}
        for word, look, thing, materials in words
    ]
    return {"holds": holds, "words": rows}


@pytest.fixture
def steps():
    """A prompt, and two further sentences: one that compares, one that names."""
    made = Steps()
    first = goals(("warm light", "warm light", "", []), ("vignette", "vignette", "", []), holds=False)
    values = {POWER: [100.0], VIGNETTE: [0.5]}
    reasons = {POWER: "'warm light'", VIGNETTE: "'vignette' (dark corners)"}
    made.add(Change(made, title="warm light, vignette"), {POWER: [50.0], VIGNETTE: [0.0]}, values, reasons, first)
    made.add(
        Change(made, title="darker"), made.values(), {POWER: [50.0]}, {POWER: "'darker'"}, goals(("darker", "", "", []))
    )
    red = goals(("red", "red", "wall", ["Wall"]))
    made.add(
        Change(made, title="red wall"),
        {COLOR: [0.5, 0.5, 0.5]},
        {COLOR: [0.8, 0.1, 0.1]},
        {COLOR: "'red' on the wall"},
        red,
    )
    return made


def test_values_follow_the_steps_that_are_on(steps):
    assert steps.values() == {POWER: [50.0], VIGNETTE: [0.5], COLOR: [0.8, 0.1, 0.1]}
    assert steps.values(1) == {POWER: [100.0], VIGNETTE: [0.5], COLOR: [0.5, 0.5, 0.5]}
    assert steps.values(0) == {POWER: [50.0], VIGNETTE: [0.0], COLOR: [0.5, 0.5, 0.5]}
    steps.steps[0].on = False  # half as bright as what is there now
    assert steps.values()[POWER] == pytest.approx([25.0])
    steps.steps[1].on = False
    assert steps.values() == {POWER: [50.0], VIGNETTE: [0.0], COLOR: [0.8, 0.1, 0.1]}


def test_what_the_artist_changes_is_a_step_that_others_leave_alone(steps):
    current = steps.values() | {VIGNETTE: [0.2]}
    steps.take_hand_made(current)
    assert [step.sentence for step in steps.steps][-1] == BY_HAND
    assert steps.values() == current
    steps.take_hand_made(current)
    assert len(steps.steps) == 4
    assert steps.change("without the red").values.keys() == {COLOR}
    steps.steps[1].on = False
    assert steps.values()[VIGNETTE] == [0.2]


def test_a_light_that_was_turned_around_is_not_changed_by_hand():
    made = Steps()
    made.add(Change(made, title="rim light"), {"light/Rim/azimuth": [150.0]}, {"light/Rim/azimuth": [221.0]})
    made.take_hand_made({"light/Rim/azimuth": [-139.0]})
    assert len(made.steps) == 1
    made.take_hand_made({"light/Rim/azimuth": [-120.0]})
    assert len(made.steps) == 2


def test_a_word_is_taken_back_by_its_name(steps):
    change = steps.change("without the vignette")
    assert (change.values, change.sentence) == ({VIGNETTE: [0.0]}, "")
    steps.add(change, steps.values(), {})
    assert steps.values()[VIGNETTE] == [0.0]
    assert steps.values()[POWER] == [50.0]
    assert steps.change("without the smoke").sentence == "without the smoke"  # of the scene itself


def test_what_several_steps_have_changed_is_taken_back_to_before_the_first(steps):
    stronger = goals(("stronger", "", "vignette", []))
    steps.add(
        Change(steps, title="vignette stronger"), steps.values(), {VIGNETTE: [0.8]}, {VIGNETTE: "'stronger'"}, stronger
    )
    assert steps.change("without the vignette").values == {VIGNETTE: [0.0]}


def test_a_correction_takes_the_word_to_another_target(steps):
    change = steps.change("no, the floor, not the wall")
    assert change.values == {COLOR: [0.5, 0.5, 0.5]}
    assert change.sentence == "red floor"


def test_an_exception_searches_for_the_last_step_again(steps):
    change = steps.change("but leave the sky")
    assert (change.sentence, change.place, change.first) == ("red wall, but leave the sky", 2, False)
    assert change.values[COLOR] == [0.5, 0.5, 0.5]
    steps.add(change, change.values, {COLOR: [0.7, 0.2, 0.2]}, {}, steps.steps[2].goals)
    assert len(steps.steps) == 3
    assert steps.values()[COLOR] == [0.7, 0.2, 0.2]


def test_returning_shows_a_step_and_loses_none(steps):
    change = steps.change("back to the first")
    assert change.values == steps.values(1)
    steps.add(change, steps.values(), {})
    assert (steps.shown, len(steps.steps)) == (1, 3)
    assert steps.values()[POWER] == [100.0]
    half = steps.change("between this and step 3").values
    assert half[POWER] == pytest.approx([100.0 / 2**0.5])  # along the scale
    assert VIGNETTE not in half


def test_half_and_twice_as_strong_are_of_the_last_step(steps):
    steps.steps[2].on = False
    assert steps.change("half as strong").values[POWER] == pytest.approx([100.0 / 2**0.5])
    assert steps.change("twice as strong").values[POWER] == pytest.approx([25.0])


@pytest.mark.parametrize(("sentence", "problem"), [(" ", "empty"), ("back to step 9", "no step 9")])
def test_what_is_not_there_is_one_line_with_its_remedy(steps, sentence, problem):
    with pytest.raises(VibeError, match=problem) as caught:
        steps.change(sentence)
    assert caught.value.remedy
    assert "\n" not in str(caught.value)


def test_without_a_step_there_is_nothing_to_halve():
    with pytest.raises(VibeError, match="no step before"):
        Steps().change("half as strong")


def test_steps_are_saved_with_the_file(scene, steps, tmp_path):
    steps.store(scene)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "a.blend"))
    assert Steps.of(bpy.context.scene) == steps
    snapshot.forget(bpy.context.scene)
    assert Steps.of(bpy.context.scene) == Steps()


@pytest.mark.parametrize(
    "text", ["{", "[]", '{"version": 1}', '{"version": 1, "steps": [{"bad": 1}]}', '{"version": 99}']
)
def test_a_damaged_list_is_one_line(scene, text):
    scene[KEY] = text
    with pytest.raises(VibeError) as caught:
        Steps.of(scene)
    assert caught.value.remedy
