# SPDX-License-Identifier: Apache-2.0
"""Ranges around shades of the artist's color: fading pales and grays it, and keeps its hue."""

import pytest

from proxy_renderer.color.floats import chroma, lab_from_srgb, luminance, srgb_from_linear
from proxy_renderer.goals.resolve import goals_of
from proxy_renderer.planning.light_levels import Sources
from proxy_renderer.planning.planner import plan
from proxy_renderer.planning.ranges import effect_range
from proxy_renderer.schema import FAMILIES, Instance
from proxy_renderer.words.lexicon.entries import parse_effect
from proxy_renderer.words.lexicon.vocabulary import shipped_vocabulary
from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import Attribute, SceneDescription

RED = (0.4, 0.02, 0.03)


def shown(effect, color=RED, strength=1.0):
    """Lab of the middle of a range."""
    instance = Instance(FAMILIES["material/base_color"], "Jacket", color, 1.0, "subject")
    attribute = Attribute("faded", "faded surface", "color", "subject", strength=strength)
    low, high = effect_range(parse_effect(effect), attribute, instance, Sources(SceneDescription()))
    return lab_from_srgb(srgb_from_linear(tuple((a + b) / 2 for a, b in zip(low, high, strict=True))))


OWN = lab_from_srgb(srgb_from_linear(RED))
FADED = "material/base_color shade 0.12,0.35..0.35,0.7"


def test_fading_makes_paler_and_grayer():
    faded = shown(FADED)
    assert faded[0] > OWN[0] + 5
    assert chroma(faded) < 0.85 * chroma(OWN)
    assert faded[1] > 10  # still red


def test_below_zero_is_darker():
    assert shown("material/base_color shade -0.35,1..-0.12,1.2")[0] < OWN[0] - 5


def test_slightly_changes_less():
    assert OWN[0] < shown(FADED, strength=0.5)[0] < shown(FADED)[0]


@pytest.mark.parametrize("chromas", ["0.25..0,0.6", "1.4..0,1.9"])
def test_gray_stays_gray(chromas):
    assert chroma(shown(f"material/base_color shade 0,{chromas}", (0.3, 0.3, 0.3))) < 1


def planned(prompt):
    """The middles of the ranges of a red jacket's color and roughness."""
    values = {"base_color": RED, "roughness": (0.2,)}
    rows = [Instance(FAMILIES[f"material/{n}"], "Jacket", v, 1.0, "subject") for n, v in values.items()]
    parsed = parse(prompt, SceneDescription(objects={"Jacket": "subject"}, materials={"Jacket": "subject"}))
    entries = plan(goals_of(parsed), {row.key: row for row in rows}, SceneDescription())
    return [
        tuple((a + b) / 2 for a, b in zip(entry.lower, entry.upper, strict=True))
        for entry in (entries[row.key] for row in rows)
    ]


def test_a_word_that_changes_a_color_changes_that_of_the_material_which_is_named():
    """Fresh asphalt is a smoother asphalt, not a fresh red."""
    color, (rough,) = planned("fresh asphalt jacket")
    assert chroma(lab_from_srgb(srgb_from_linear(color))) < 10
    own, (alone,) = planned("fresh jacket")
    assert chroma(lab_from_srgb(srgb_from_linear(own))) > 30
    assert alone < 0.2 < rough < planned("asphalt jacket")[1][0]


def test_no_light_lifts_the_shadows_of_one_color():
    """Lift is added to scene-linear light: .03 of it turned the dark sky of a sunset magenta."""
    vocabulary = shipped_vocabulary()
    lights = [entry for entry in vocabulary.entries.values() if entry.slot == "lighting"]
    lifts = [e for entry in lights for e in entry.effects if (e.owner, e.name) == ("film", "lift")]
    assert lifts
    assert all(len({*side}) == 1 for effect in lifts for side in (effect.lower, effect.upper))


@pytest.mark.parametrize("substance", ["walnut", "oak", "leather"])
@pytest.mark.parametrize("present", [(0.02, 0.015, 0.01), (0.12, 0.04, 0.01), (0.5, 0.4, 0.3)])
def test_a_darker_and_a_paler_substance_are_so_compared_with_the_present_color(substance, present):
    instance = Instance(FAMILIES["material/base_color"], "Jacket", present, 1.0, "subject")
    scene = SceneDescription(objects={"Jacket": "subject"}, materials={"Jacket": "subject"})
    for shade, sign in (("darker", -1), ("lighter", 1), ("paler", 1)):
        parsed = parse(f"the jacket in {shade} {substance}", scene)
        entries = plan(goals_of(parsed), {instance.key: instance}, SceneDescription())
        ends = (luminance(entries[instance.key].lower), luminance(entries[instance.key].upper))
        assert all(sign * end > sign * luminance(present) for end in ends), shade
