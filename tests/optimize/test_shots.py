# SPDX-License-Identifier: Apache-2.0
"""Several shots that share a look, with the real renderer, planner and embedded encoder."""

from dataclasses import replace

import pytest
from loop_parts import Silent, search_for
from PIL import Image
from tiny_job import write_job

from proxy_renderer.engine.report import changed_values
from proxy_renderer.engine.session import EngineSession
from proxy_renderer.guidance.encoder import load_encoder
from proxy_renderer.optimize import pipeline
from proxy_renderer.optimize.shots import MOVES, ShotInput, shared_parameters
from proxy_renderer.scene import load_scene
from proxy_renderer.schema.messages import VARIANTS, Options, Shot

PROMPT = "glossy teal ball, white studio background, darker"
COLOR, LAMP = "material/Ball/base_color", "light/Key/power"


@pytest.fixture(scope="module")
def views(tmp_path_factory):
    """One scene from two sides; and another one, whose ball is red."""
    folder = tmp_path_factory.mktemp("jobs")
    turned, red = {"camera/azimuth": 50.0}, {COLOR: [0.8, 0.0, 0.0], "world/strength": 0.9}
    scenes = [load_scene(write_job(folder / str(i), **v)) for i, v in enumerate(({}, turned, red))]
    return [ShotInput(s, None, file) for s, file in zip(scenes, ("a", "a", "b"), strict=True)]


def vibe(views, **options):
    chosen = Options(**{"rounds": 2, "steps": 8, "size": 48, **options})
    encoder = load_encoder(None, "cpu")
    return pipeline.run(search_for(views, PROMPT, chosen, encoder, Silent()))


def changed(outcome):
    return [changed_values(outcome, shot) for shot in outcome.shots]


def test_a_look_holds_in_all_shots_and_each_is_judged(views):
    outcome = vibe(views, rounds=1, encoder="embedded")  # asked for all words
    first, second, other = changed(outcome)
    assert first == second
    assert {k: v for k, v in other.items() if k in first} == first
    red, green, blue = other[COLOR]
    assert red < min(green, blue)
    start, end = outcome.rounds[0]["loss"]
    assert end < start
    assert len({shot.guidance.start.sum().item() for shot in outcome.shots}) == 3


@pytest.mark.slow
def test_all_shots_get_the_same_look_again(views):
    assert changed(vibe(views)) == changed(vibe(views))


def test_what_no_word_names_stays_as_each_scene_has_it(views):
    only_color = Options(rounds=1, steps=4, size=48, groups=("material",))
    encoder = load_encoder(None, "cpu")
    outcome = pipeline.run(search_for([views[0], views[2]], "teal ball", only_color, encoder, Silent()))
    first, other = changed(outcome)
    assert COLOR in first
    assert first[COLOR] == other[COLOR]
    assert not any(key.startswith("world/") for key in other)


def test_a_scene_takes_a_named_value_that_the_first_has_already(views):
    """The first ball is teal before anything moves it, and the other one is to be that very teal."""
    scene = views[0].scene
    teal = replace(scene.instances[COLOR], value=(0.02, 0.3, 0.3))
    first = ShotInput(replace(scene, instances={**scene.instances, COLOR: teal}), None, "a")
    outcome = vibe([first, views[2]], steps=1, rounds=1, top_k=1)
    there, here = changed(outcome)
    assert here[COLOR] == there.get(COLOR, [0.02, 0.3, 0.3])


def test_a_grade_for_each(views):
    outcome = vibe(views[:2], rounds=1, grade_each=True)
    assert "film/shot 2/exposure" in outcome.vector.instances
    for shot in outcome.shots:
        assert "film/exposure" in shot.vector.instances
    first, second = changed(outcome)
    assert {k: v for k, v in first.items() if k[:4] != "film"} == {k: v for k, v in second.items() if k[:4] != "film"}
    assert {k for k in second if k[:4] == "film"}
    assert all(k in outcome.shots[1].scene.instances for k in second)


def test_what_is_locked_or_moves_in_one_is_locked_in_all(views):
    scene = views[1].scene
    lamp, color = scene.instances[LAMP], scene.instances[COLOR]
    moving = replace(lamp, value=(lamp.value[0] * 2,))
    keyed = replace(color, locked="it is animated")
    second = ShotInput(replace(scene, instances={**scene.instances, LAMP: moving, COLOR: keyed}), None, "a")
    shared, _ = shared_parameters([views[0], second])
    assert shared[LAMP].locked == MOVES
    assert shared[COLOR].locked == "it is animated"
    elsewhere = ShotInput(second.scene, None, "b")
    assert not shared_parameters([views[0], elsewhere])[0][LAMP].locked
    first, other = changed(vibe([views[0], second], rounds=1, steps=3))
    assert COLOR not in first
    assert LAMP not in {**first, **other}


@pytest.mark.slow
def test_every_variant_is_drawn_in_every_shot(tmp_path):
    """A column for each variant, a row for each shot; what they share is one set of values."""
    names, sides = ("Wide", "Close"), ({}, {"camera/azimuth": 50.0})
    jobs = [write_job(tmp_path / name, **values) for name, values in zip(names, sides, strict=True)]
    shots = [Shot(str(job), name, "a") for job, name in zip(jobs, names, strict=True)]
    chosen = Options(rounds=1, steps=2, size=48, variants=2, anchor=False, device="cpu")
    session = EngineSession(shots, PROMPT, chosen, Silent())
    found = session.run()
    session.draw()
    assert len(found.variants) == 2
    drawn = {(job / v.picture).read_bytes() for job in jobs for v in found.variants}
    assert len(drawn) == 4
    with Image.open(jobs[0] / VARIANTS) as sheet, Image.open(jobs[0] / found.variants[0].picture) as one:
        assert sheet.height > 2 * sheet.width * one.height / one.width / 2
    assert found.variants[0].values == found.values
