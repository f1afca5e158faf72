# SPDX-License-Identifier: Apache-2.0
"""What a scene lacks paints nothing else."""

from dataclasses import replace

import pytest

from proxy_renderer.schema import VibeError
from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import MaterialLook, SceneDescription

VASE = SceneDescription(
    objects={"Vase": "subject", "Lemons": "subject", "Table": "surroundings"},
    materials={"Glaze": "subject", "Peel": "subject", "Wood": "surroundings"},
    object_materials={"Vase": ("Glaze",), "Lemons": ("Peel",), "Table": ("Wood",)},
)
MESH = SceneDescription("Mesh", {"Mesh": "subject"}, {"Material": "subject"}, {"Mesh": ("Material",)})


def said(prompt, scene):
    return {a.word for a in parse(prompt, scene).attributes if not a.cause}


@pytest.mark.parametrize(
    ("prompt", "used", "absent"),
    [
        ("teal water, glossy vase", {"glossy"}, "water"),
        ("white vase, black tie", {"white"}, "tie"),
        ("red door, yellow lemons", {"yellow"}, "door"),
        ("warm light, copper kettle, glossy vase", {"warm light", "glossy"}, "kettle"),
    ],
)
def test_a_word_whose_object_is_not_in_the_scene_is_not_used(prompt, used, absent):
    parsed = parse(prompt, VASE)
    assert {a.word for a in parsed.attributes} == used
    assert any(f"there is no '{absent}' in the scene" in note for note in parsed.notes)


@pytest.mark.parametrize(
    ("prompt", "used"),
    [
        ("glossy red monkey", {"glossy", "red"}),
        ("glossy teal, warm light", {"glossy", "teal", "warm light"}),
        ("a gold statue, white background", {"gold", "white"}),
        ("a vase made of water", {"made of water"}),
    ],
)
def test_the_only_thing_there_may_be_called_anything(prompt, used):
    assert said(prompt, MESH) == used


@pytest.mark.parametrize("material", ["Material", "Material.001", "mat_01", "Material #25"])
@pytest.mark.parametrize("subject", ["Torus", "Cube.003", "Mesh"])
def test_names_that_blender_gives_do_not_tell_what_an_object_is(subject, material):
    """A torus with Blender's own material name may be called a mug, also beside a ground."""
    scene = SceneDescription(
        subject,
        {subject: "subject", "Plane": "surroundings"},
        {material: "subject", "Material.002": "surroundings"},
        {subject: (material,), "Plane": ("Material.002",)},
        looks={material: MaterialLook(share=0.2), "Material.002": MaterialLook(share=0.6)},
    )
    for noun in ("mug", "kettle", "sofa"):
        (copper,) = [
            a for a in parse(f"the {noun} is copper, warm light", scene).attributes if a.word == "copper"
        ]
        assert copper.region == "subject"
    named = replace(
        scene, objects={"Vase": "subject", "Plane": "surroundings"}, object_materials={"Vase": (material,)}
    )
    with pytest.raises(VibeError, match="no 'mug' in the scene"):
        parse("the mug is copper", replace(named, subject="Vase"))


def test_light_and_air_need_no_object():
    assert said("blue moonlight, pale fog, purple sky, red vase", VASE) >= {"blue", "pale", "purple", "red"}


def test_a_prompt_of_nothing_else_says_what_is_lacking():
    with pytest.raises(VibeError, match="there is no 'water' in the scene"):
        parse("teal water", VASE)
