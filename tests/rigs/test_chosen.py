# SPDX-License-Identifier: Apache-2.0
"""Rigs that several words make together: each word leaves its trace, and none goes beyond what it stands for."""

from __future__ import annotations

import itertools

import pytest

from proxy_renderer.goals.resolve import goals_of
from proxy_renderer.rigs.chosen import at_an_hour, chosen_rig, in_a_mood, with_source
from proxy_renderer.words.lexicon.rigs import Rig, rig_table
from proxy_renderer.words.lexicon.user_words import default_vocabulary
from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import SceneDescription

_KINDS = {
    kind: [rig for rig in {r.name: r for r in rig_table().rigs.values()}.values() if rig.kind == kind]
    for kind in ("source", "time", "mood")
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
    both = in_a_mood(hour, mood)
    assert both.lights[0] == hour.lights[0]
    assert both.own == hour.own
    for name in ("world", "sky", "exposure"):
        assert _between(getattr(both, name), getattr(hour, name), getattr(mood, name))
    assert set(hour.grade) <= set(both.grade)
    assert len({light.part for light in both.lights}) == len(both.lights)


@pytest.mark.parametrize("hour", _KINDS["time"], ids=lambda rig: rig.name)
def test_an_hour_gives_a_source_its_sky_and_no_light(hour):
    lamp = rig_table().rigs["lamplight"]
    both = at_an_hour(lamp, hour)
    assert both.lights == lamp.lights
    assert both.sky == (lamp.sky if hour.sky is None else hour.sky)
    assert both.exposure <= lamp.exposure


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
