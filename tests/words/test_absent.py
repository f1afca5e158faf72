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
        ("strap darker, glossy vase", {"glossy"}, "strap"),
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
        (copper,) = [a for a in parse(f"the {noun} is copper, warm light", scene).attributes if a.word == "copper"]
        assert copper.region == "subject"
    named = replace(scene, objects={"Vase": "subject", "Plane": "surroundings"}, object_materials={"Vase": (material,)})
    with pytest.raises(VibeError, match="no 'mug' in the scene"):
        parse("the mug is copper", replace(named, subject="Vase"))


ROBOT = SceneDescription(
    objects={"Head": "subject", "Body": "subject", "gear": "subject", "arm.001": "subject", "Plane": "surroundings"},
    materials={"Gold": "subject", "Gear": "subject", "Coal": "subject", "Ground": "surroundings"},
    object_materials={
        "Head": ("Gold",), "Body": ("Gold",), "gear": ("Gear",), "arm.001": ("Coal",), "Plane": ("Ground",)
    },
    looks={
        "Gold": MaterialLook(share=0.2, worn={"Head": 0.08, "Body": 0.12}, structures=frozenset({"wall"})),
        "Gear": MaterialLook(share=0.03, worn={"gear": 0.03}),
        "Coal": MaterialLook(share=0.01, worn={"arm.001": 0.01}),
        "Ground": MaterialLook(share=0.5, worn={"Plane": 0.5}),
    },
)  # fmt: skip


@pytest.mark.parametrize("prompt", ["the robot in aged brass", "dim workshop at dusk, the robot in aged brass"])
def test_names_of_parts_and_substances_do_not_name_the_whole(prompt):
    (brass,) = [a for a in parse(prompt, ROBOT).attributes if a.word == "aged brass"]
    assert (brass.region, brass.thing) == ("subject", "robot")


def test_a_subject_most_of_which_is_called_what_it_is_has_no_other_name():
    looks = {**ROBOT.looks, "Gear": replace(ROBOT.looks["Gear"], share=0.3, worn={"gear": 0.3})}
    with pytest.raises(VibeError, match="no 'robot' in the scene"):
        parse("the robot in aged brass", replace(ROBOT, looks=looks))


def test_parts_of_one_color_are_one_thing_and_its_plural_parts_do_not_name_it():
    """Foreign names of parts tell nothing either."""
    names = {"tete": 0.02, "Cubo": 0.03, "Cubo.001": 0.03, "coude": 0.01}
    scene = SceneDescription(
        objects=dict.fromkeys(names, "subject"),
        materials={f"Vibe {name}": "subject" for name in names},
        object_materials={name: (f"Vibe {name}",) for name in names},
        looks={f"Vibe {n}": MaterialLook((0.9, 0.9, 0.9), share=s, worn={n: s}) for n, s in names.items()},
    )
    assert said("copper robot", scene) == {"copper"}
    assert said("a copper robot with blue eyes", scene) == {"copper"}
    with pytest.raises(VibeError, match="no 'wheels' in the scene"):
        parse("the wheels are gold", scene)
    looks = {n: replace(look, color=(i / 3, 1 - i / 3, 0.2)) for i, (n, look) in enumerate(scene.looks.items())}
    with pytest.raises(VibeError, match="no 'robot' in the scene"):
        parse("copper robot", replace(scene, looks=looks))


def test_light_and_air_need_no_object():
    assert said("blue moonlight, pale fog, purple sky, red vase", VASE) >= {"blue", "pale", "purple", "red"}


def test_a_prompt_of_nothing_else_says_what_is_lacking():
    with pytest.raises(VibeError, match="there is no 'water' in the scene"):
        parse("teal water", VASE)
