# SPDX-License-Identifier: Apache-2.0
"""Several looks of one thing that is made of several materials, and how they are shared out."""

import pytest

from proxy_renderer.prompt.parser import parse
from proxy_renderer.prompt.types import SceneDescription

PARTS = {"Cylinder": "M1", "Cube": "M2", "Torus": "M3"}
SCENE = SceneDescription(
    objects=dict.fromkeys(PARTS, "subject") | {"Plane": "surroundings"},
    materials=dict.fromkeys(PARTS.values(), "subject") | {"M4": "surroundings"},
    object_materials={name: (worn,) for name, worn in PARTS.items()} | {"Plane": ("M4",)},
    places={"Cylinder": (0.0, 0.5, 0.1), "Cube": (0.0, 0.5, 0.6), "Torus": (0.0, 0.5, 0.3)},
)


def owners(prompt: str, scene: SceneDescription = SCENE) -> dict[str, tuple[str, ...]]:
    return {a.word: a.owners for a in parse(prompt, scene).attributes if a.kind == "subject" and not a.cause}


@pytest.mark.parametrize(
    ("prompt", "meant"),
    [
        ("walnut, marble and gold", {"walnut": ("M2",), "marble": ("M3",), "gold": ("M1",)}),
        ("walnut and brushed steel", {"walnut": (), "brushed steel": ()}),
        ("glossy red leather", {"glossy": (), "red": (), "leather": ()}),
        ("worn, scratched, walnut", {"worn": (), "scratched": (), "walnut": ()}),
        (
            "walnut, marble, gold and brushed steel",
            {"walnut": (), "marble": (), "gold": (), "brushed steel": ()},
        ),
    ],
)
def test_each_look_has_a_material_of_its_own_where_there_are_as_many(prompt, meant):
    assert owners(prompt) == meant


def test_how_looks_are_shared_out_is_told():
    told = parse("walnut, marble and gold", SCENE).notes
    assert any("'walnut' is M2" in text for text in told)


@pytest.mark.parametrize("part", ["wheels", "handle", "windows"])
def test_a_look_of_a_part_is_not_shared_out(part):
    assert not any(owners(f"warm light, a green car with a chrome {part}").values())


def test_things_of_one_name_share_as_the_parts_of_the_subject_do():
    rings = ("Ring", "Ring.001", "Ring.002")
    scene = SceneDescription(
        objects=dict.fromkeys(rings, "subject"),
        materials=dict.fromkeys("ABC", "subject"),
        object_materials=dict(zip(rings, (("A",), ("B",), ("C",)), strict=True)),
        places={"Ring.001": (0.0, 0.5, 0.4)},
    )
    assert owners("gold and silver rings", scene) == {"gold": ("B", "C"), "silver": ("A",)}
    assert any("'gold' is B, C" in text for text in parse("gold and silver rings", scene).notes)


def test_the_rest_of_a_scene_is_the_sky_too():
    found = parse("a red machine, the rest is blue", SCENE).attributes
    (rest,) = [a for a in found if a.word == "blue"]
    assert (rest.kind, rest.owners) == ("surroundings", ())
