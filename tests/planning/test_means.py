# SPDX-License-Identifier: Apache-2.0
"""Moods, light, weather, places and grades change light, world, air and film; only words about surfaces change materials."""

from __future__ import annotations

import pytest
from plan_parts import make_instances, make_plan

from proxy_renderer.words.lexicon.vocabulary import shipped_vocabulary
from proxy_renderer.words.types import SceneDescription

SCENE = SceneDescription(
    objects={"Vase": "subject", "Lemons": "subject", "Table": "surroundings", "Wall": "surroundings"},
    materials={"Glaze": "subject", "Peel": "subject", "Wood": "surroundings", "Plaster": "surroundings"},
    object_materials={"Vase": ("Glaze",), "Lemons": ("Peel",), "Table": ("Wood",), "Wall": ("Plaster",)},
)
SURFACES = ("finish", "material", "color")
MOODS = [e.name for e in shipped_vocabulary().entries.values() if e.slot not in SURFACES]


def painted(prompt: str) -> set[str]:
    """The materials that a prompt changes."""
    instances = make_instances(materials=tuple(SCENE.materials.items()))
    plan = make_plan(prompt, instances, scene=SCENE)
    return {key.split("/")[1] for key, e in plan.items() if e.priority is not None and key[:8] == "material"}


@pytest.mark.parametrize("mood", MOODS)
def test_a_word_that_is_about_no_surface_changes_no_material(mood):
    assert painted(mood) == set()


@pytest.mark.parametrize(
    "prompt",
    [
        "old library by lamplight, cosy",
        "rainy neon night, wet weather",
        "sterile clinic, winter night",
        "silhouette against the sunset",
        "vivid colors, high key",
        "halloween, orange light, mist",
        "alien world, dark background",
    ],
)
def test_a_prompt_of_moods_changes_no_material(prompt):
    assert painted(prompt) == set()


@pytest.mark.parametrize(
    ("prompt", "materials"),
    [
        ("teal vase, ominous", {"Glaze"}),
        ("copper vase, yellow lemons, noir", {"Glaze", "Peel"}),
        ("glossy table, foggy morning", {"Wood"}),
        ("white background, cosy", {"Plaster"}),
    ],
)
def test_what_is_said_of_a_surface_changes_it_alone(prompt, materials):
    assert painted(prompt) == materials


def test_air_and_vignette_are_for_words_that_ask_for_them():
    """A mood brings neither, but for the few that are about the air."""
    for prompt in ("cosy, moody", "dreamy, epic", "gothic, lonely", "candlelight", "studio, noir"):
        plan = make_plan(prompt, scene=SCENE)
        assert plan["volume/density"].priority is plan["film/vignette"].priority is None, prompt
    assert make_plan("ghostly", scene=SCENE)["volume/density"].priority is not None
    assert make_plan("slight vignette, mist", scene=SCENE)["film/vignette"].priority is not None
