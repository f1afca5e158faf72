# SPDX-License-Identifier: Apache-2.0
"""A world is parted for a background whose light would spoil the picture, and for nothing else."""

import json

import pytest
from tiny_job import write_job

from proxy_renderer.goals.resolve import goals_of
from proxy_renderer.optimize.scene_facts import described
from proxy_renderer.optimize.stage import set_stage
from proxy_renderer.planning.planner import plan
from proxy_renderer.scene import load_scene
from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import SceneDescription

STRENGTH, COLOR = "world/backdrop_strength", "world/backdrop_color"


def shot(folder, offered=True):
    """The ball in front of a world that may get a backdrop, or may not."""
    write_job(folder)
    content = json.loads((folder / "scene.json").read_text())
    world = {key: content["parameters"][f"world/{key}"] for key in ("color", "strength")}
    if offered:
        content["standby"] = {"parameters": {f"world/backdrop_{key}": row for key, row in world.items()}}
    (folder / "scene.json").write_text(json.dumps(content))
    return load_scene(folder)


@pytest.mark.parametrize(
    ("prompt", "parted"),
    [
        ("green background", True),
        ("glossy red ball in warm light, dark blue background", True),
        ("chrome ball, dark background", True),
        ("moonlit night, white background", True),
        ("a garden at night", True),
        ("white cyclorama, night", True),
        ("black background", False),
        ("dark background", False),
        ("white background", False),
        ("pale grey background", False),
        ("warm evening light", True),
        ("foggy night", True),
        ("a red ball on a green floor", False),
        ("an orange sky", False),
        ("qwertyuiop", False),
    ],
)
def test_it_is_parted_for_words_that_color_what_is_behind(tmp_path, prompt, parted):
    scene = shot(tmp_path)
    (got,) = set_stage([scene], prompt).scenes
    assert (STRENGTH in got.instances) == parted
    if parted:
        assert got.value(COLOR) == scene.value("world/color")


def test_all_shots_get_it_or_none(tmp_path):
    seen, hidden = shot(tmp_path / "seen"), shot(tmp_path / "hidden", offered=False)
    assert all(STRENGTH in s.instances for s in set_stage([seen, seen], "green background").scenes)
    for scene in set_stage([seen, hidden], "green background").scenes:
        assert STRENGTH not in scene.instances


def test_green_is_seen_and_the_light_of_the_night_is_shed(tmp_path):
    prompt = "moonlit night, green background"
    (scene,) = set_stage([shot(tmp_path)], prompt).scenes
    parsed = parse(prompt, described(scene))
    entries = plan(goals_of(parsed), dict(scene.instances), SceneDescription())
    green, light = entries[COLOR], entries["world/color"]
    red, brightest, blue = green.upper
    assert brightest > 2 * max(red, blue)
    assert "green" in green.reason
    assert light.upper[1] < light.lower[2]  # the blue of nights
    assert "green" not in light.reason


@pytest.mark.parametrize("setup", ["product shot", "golden hour", "high key"])
def test_a_named_background_is_seen_whatever_sky_a_setup_has(tmp_path, setup):
    stage = set_stage([shot(tmp_path)], f"{setup}, teal background")
    (scene,) = stage.scenes
    assert stage.plan is not None
    entries = plan(stage.goals, dict(scene.instances), stage.understood.scene, light=stage.plan)
    red, green, blue = entries[COLOR].upper
    assert min(green, blue) > 3 * red
    assert "teal" in entries[COLOR].reason
    assert "teal" in entries[STRENGTH].reason


def test_chrome_has_light_to_mirror_before_a_dark_background(tmp_path):
    prompt = "chrome ball, dark background"
    (scene,) = set_stage([shot(tmp_path)], prompt).scenes
    parsed = parse(prompt, described(scene))
    entries = plan(goals_of(parsed), dict(scene.instances), SceneDescription())
    assert "dark background" in entries[STRENGTH].reason
    assert "chrome" in entries["world/strength"].reason
    assert entries[STRENGTH].upper < entries["world/strength"].lower


@pytest.mark.parametrize("prompt", ["a garden at night", "night, in a garden", "a foggy night"])
def test_the_sky_of_a_place_or_a_weather_at_night_is_the_nights(tmp_path, prompt):
    (scene,) = set_stage([shot(tmp_path)], prompt).scenes
    parsed = parse(prompt, described(scene))
    entries = plan(goals_of(parsed), dict(scene.instances), SceneDescription())
    assert "night" in entries["world/strength"].reason
    assert "night" in entries["world/color"].reason


def test_a_place_does_not_narrow_what_the_time_of_day_wants(tmp_path):
    scene = shot(tmp_path)

    def range_at(prompt):
        parsed = parse(prompt, described(scene))
        return plan(goals_of(parsed), dict(scene.instances), SceneDescription())["world/strength"]

    dusk, street = range_at("blue hour"), range_at("blue hour on a city street")
    assert (street.lower, street.upper) == (dusk.lower, dusk.upper)
