# SPDX-License-Identifier: Apache-2.0
"""Rigs that several words make together: each word leaves its trace, and none goes beyond what it stands for."""

from __future__ import annotations

import itertools

import pytest

from proxy_renderer.goals.resolve import goals_of
from proxy_renderer.rigs.chosen import chosen_rig
from proxy_renderer.rigs.combined import at_an_hour, in_a_mood, in_a_style, with_source
from proxy_renderer.words.lexicon.rigs import Rig, rig_table
from proxy_renderer.words.lexicon.vocabulary import default_vocabulary
from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import LightDescription, SceneDescription

_KINDS = {
    kind: [rig for rig in {r.name: r for r in rig_table().rigs.values()}.values() if rig.kind == kind]
    for kind in ("source", "time", "mood", "film")
}
_PAIRS = list(itertools.islice(itertools.product(_KINDS["time"][::3], _KINDS["mood"][::7]), 60))


def _between(value: float | None, one: float | None, other: float | None) -> bool:
    ends = [end for end in (one, other) if end is not None]
    return value is None if not ends else value is not None and min(ends) <= value <= max(ends)


def _names(pair: tuple[Rig, Rig]) -> str:
    return " + ".join(rig.name for rig in pair)


@pytest.mark.parametrize("pair", _PAIRS, ids=_names)
def test_a_mood_colors_an_hour_and_keeps_its_key(pair):
    hour, mood = pair
    both = in_a_mood(hour, mood, edges=True)
    assert both.lights[0] == hour.lights[0]
    assert both.own == hour.own
    for name in ("world", "sky", "exposure"):
        assert _between(getattr(both, name), getattr(hour, name), getattr(mood, name))
    assert set(hour.grade) <= set(both.grade)
    assert len({light.part for light in both.lights}) == len(both.lights)
    assert in_a_mood(hour, mood, edges=False).lights == hour.lights


@pytest.mark.parametrize("hour", _KINDS["time"], ids=lambda rig: rig.name)
def test_an_hour_gives_a_source_its_sky_and_no_light(hour):
    lamp = rig_table().rigs["lamplight"]
    both = at_an_hour(lamp, hour)
    assert both.lights == lamp.lights
    assert both.sky == (lamp.sky if hour.sky is None else hour.sky)
    assert both.exposure <= lamp.exposure


def test_a_sun_through_a_window_is_the_sun_of_the_hour():
    sun, hour = rig_table().rigs["sunlight"], rig_table().rigs["golden hour"]
    key = at_an_hour(sun, hour).lights[0]
    assert (key.kelvin, key.color) == (hour.lights[0].kelvin, hour.lights[0].color)


@pytest.mark.parametrize("words", ["sun through the window, cozy", "golden hour, sun through the window, noir"])
def test_a_dark_style_leaves_the_sky_of_a_sun(words):
    found = _chosen(words)
    assert found
    assert found.rig.sky > 0.0


@pytest.mark.parametrize("other", _KINDS["source"][::3], ids=lambda rig: rig.name)
def test_a_second_source_stands_on_the_other_side(other):
    first = rig_table().rigs["candlelight"]
    both = with_source(first, other)
    accents = [light for light in both.lights if light.part == "accent"]
    if both is not first and accents[0].azimuth:
        assert accents[0].azimuth * first.lights[0].azimuth < 0


@pytest.mark.parametrize(
    "words", ["snowy night by the fire", "by the fire, night, snow outside", "night, snowfall, lamplight"]
)
def test_of_several_skies_the_darkest_counts(words):
    vocabulary = default_vocabulary()
    found = chosen_rig(goals_of(parse(words, SceneDescription(), vocabulary)), rig_table(), vocabulary)
    assert found
    assert found.rig.sky < -2.5


@pytest.mark.parametrize("words", ["autumn, at night", "summery, dreamy, at night"])
def test_a_season_at_night_has_a_night_sky(words):
    vocabulary = default_vocabulary()
    found = chosen_rig(goals_of(parse(words, SceneDescription(), vocabulary)), rig_table(), vocabulary)
    assert found
    assert found.rig.sky < -1.0


@pytest.mark.parametrize("film", _KINDS["film"], ids=lambda rig: rig.name)
def test_an_hour_keeps_its_light_in_the_style_of_a_film(film):
    hour = rig_table().rigs["golden hour"]
    both = in_a_style(hour, film)
    assert both.lights == hour.lights
    assert both.sky_color == hour.sky_color
    assert set(both.grade) == {*hour.grade, *film.grade}
    assert both.sky <= hour.sky


def test_of_an_hour_and_a_film_the_hour_is_the_setup_in_whatever_order():
    vocabulary = default_vocabulary()
    for prompt in ("anime sunset", "sunset, anime"):
        goals = goals_of(parse(prompt, SceneDescription(), vocabulary))
        assert chosen_rig(goals, rig_table(), vocabulary).rig.name == "sunset"


@pytest.mark.parametrize("light", ["strip softboxes", "rembrandt lighting", "a spotlight"])
def test_a_light_in_a_black_studio_leaves_all_else_black(light):
    vocabulary = default_vocabulary()

    def rig(prompt):
        goals = goals_of(parse(prompt, SceneDescription(), vocabulary))
        return chosen_rig(goals, rig_table(), vocabulary).rig

    alone, dark = rig(light), rig(f"{light}, black studio")
    assert dark.lights == alone.lights
    assert dark.sky < -4.0
    assert dark.world < -4.0


def _chosen(words: str):
    """The rig of words about a lamp and a cup."""
    things = {"Table Lamp": "Shade", "Cup": "Glaze", "Lantern": "Paper"}
    scene = SceneDescription(
        objects=dict.fromkeys(things, "subject"),
        materials=dict.fromkeys(things.values(), "subject"),
        object_materials={thing: (material,) for thing, material in things.items()},
    )
    vocabulary = default_vocabulary()
    return chosen_rig(goals_of(parse(words, scene, vocabulary)), rig_table(), vocabulary)


@pytest.mark.parametrize(
    "words", ["the table lamp glows", "table lamp switched on", "night, the lamp on the table glows"]
)
def test_a_lamp_of_the_picture_that_burns_is_a_light(words):
    found = _chosen(words)
    assert found
    (lamp,) = (light for light in found.rig.lights if light.worn)
    assert lamp.worn == {"Shade"}
    assert lamp.is_warm


def test_each_lamp_is_a_light():
    found = _chosen("night, the table lamp glows red, the lantern glows blue")
    assert found
    assert {light.worn for light in found.rig.lights if light.worn} == {frozenset({"Shade"}), frozenset({"Paper"})}


def test_such_a_light_has_the_color_of_the_glow():
    found = _chosen("blue evening, the table lamp glows green")
    assert found
    (lamp,) = (light for light in found.rig.lights if light.worn)
    red, green, _ = (int(lamp.color[i : i + 2], 16) for i in (1, 3, 5))
    assert green > 2 * red


def test_what_glows_and_is_no_lamp_adds_no_light():
    found = _chosen("evening, the cup glows green")
    assert found
    assert not any(light.worn for light in found.rig.lights)
    assert _chosen("the table lamp is green") is None


@pytest.mark.parametrize("prompt", ["rainy midnight", "overcast night"])
def test_a_weather_by_night_is_lit_as_the_night(prompt):
    assert _chosen(prompt).rig.has_dark_sky


def test_a_blue_night_has_a_dark_blue_sky():
    assert _chosen("quiet blue night").rig.sky < -2.5
    assert _chosen("night, pale yellow sky").rig.sky > 0.0  # as the words say


def test_the_sun_through_a_window_is_not_the_light_that_is_called_after_it():
    scene = SceneDescription(lights={"Window Light": LightDescription("AREA")})
    said = parse("sun through the window", scene, default_vocabulary()).attributes
    assert not any(attribute.lights for attribute in said)


def test_an_hour_with_signs_of_its_own_keeps_them_beside_neon():
    lights = {light.part: light.color for light in _chosen("rainy night, neon").rig.lights}
    assert lights == {light.part: light.color for light in _chosen("rainy night").rig.lights}
