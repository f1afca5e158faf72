# SPDX-License-Identifier: Apache-2.0
"""What does not glow is not made to: files of Blender before 4 have an emission strength of 1 and a black emission color."""

from types import SimpleNamespace

import pytest

from proxy_renderer.goals.resolve import goals_of
from proxy_renderer.planning.glow import glowing
from proxy_renderer.planning.light_levels import Sources
from proxy_renderer.planning.planner import plan
from proxy_renderer.planning.ranges import effect_range
from proxy_renderer.schema import FAMILIES, Instance
from proxy_renderer.words.lexicon.entries import parse_effect
from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import SceneDescription

COLOR = "material/Body/emission_color"


def entry(prompt, emission_color, strength, key=COLOR):
    values = {"base_color": (0.5,) * 3, "emission_color": emission_color, "emission": (strength,)}
    rows = [Instance(FAMILIES[f"material/{n}"], "Body", v, 1.0, "subject") for n, v in values.items()]
    instances = {row.key: row for row in rows}
    scene = SceneDescription(objects={"Body": "subject"}, materials={"Body": "subject"})
    parsed = parse(prompt, scene)
    return plan(goals_of(parsed), instances, SceneDescription())[key]


@pytest.mark.parametrize(
    ("prompt", "emission_color", "strength", "changes"),
    [
        ("navy blue", (0.0, 0.0, 0.0), 1.0, False),
        ("navy blue", (1.0, 1.0, 1.0), 0.0, False),
        ("navy blue", (1.0, 0.4, 0.1), 1.0, True),
        ("glowing blue", (0.0, 0.0, 0.0), 1.0, True),
    ],
)
def test_a_color_reaches_the_emission_of_what_glows(prompt, emission_color, strength, changes):
    found = entry(prompt, emission_color, strength)
    assert (found.priority is not None) == changes, found.reason


@pytest.mark.parametrize(
    ("prompt", "strength", "kept"),
    [
        ("glowing", 50.0, True),
        ("neon glow", 50.0, True),
        ("faintly glowing", 50.0, False),
        ("not glowing", 50.0, False),
    ],
)
def test_what_glows_more_than_a_word_asks_for_is_not_dimmed(prompt, strength, kept):
    found = entry(prompt, (1.0, 0.4, 0.1), strength, "material/Body/emission")
    assert (found.upper[0] >= strength) == kept, found.reason


def test_what_does_not_glow_yet_glows_as_the_word_says():
    found = entry("glowing", (0.0, 0.0, 0.0), 50.0, "material/Body/emission")
    assert found.upper[0] < 5.0


@pytest.mark.parametrize("prompt", ["glowing", "softly glowing", "glowing amber", "glowing navy blue"])
def test_what_glows_is_not_made_dark(prompt):
    """How bright a glow is, its strength says; a dark color of it would be no glow."""
    found = entry(prompt, (0.0, 0.0, 0.0), 0.0)
    assert max(found.lower) > 0.3


def test_a_glow_stays_about_as_it_is_where_a_further_sentence_only_compares():
    """ "Warmer" moves a light's temperature by shares of its range, which are no kelvins of a glow."""
    color = Instance(FAMILIES["material/emission_color"], "Body", (1.0, 0.4, 0.1), 1.0, "subject")
    (attribute,) = parse("warm light", SceneDescription()).attributes
    given = parse_effect("lights/temperature near -0.07..0.07"), attribute, color
    lower, upper = effect_range(*given, Sources(SceneDescription()))
    assert all(0.0 < b - a < 0.3 and a <= v <= b for a, v, b in zip(lower, color.value, upper, strict=True))


def test_only_materials_that_some_face_has_are_lights():
    emitting = [Instance(FAMILIES["material/emission"], name, (5.0,), 1.0, "subject") for name in ("Lamp", "Unused")]
    scene = SimpleNamespace(
        instances={row.key: row for row in emitting},
        materials=[SimpleNamespace(name="Lamp"), SimpleNamespace(name="Wall")],
    )
    assert glowing(scene) == ["Lamp"]
