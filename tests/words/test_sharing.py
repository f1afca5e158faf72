# SPDX-License-Identifier: Apache-2.0
"""Several colors of one noun that means several things, and the rest of a scene."""

import pytest

from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import SceneDescription

PARTS = {"Cylinder": "M1", "Cube": "M2", "Torus": "M3"}
SCENE = SceneDescription(
    objects=dict.fromkeys(PARTS, "subject") | {"Plane": "surroundings"},
    materials=dict.fromkeys(PARTS.values(), "subject") | {"M4": "surroundings"},
    object_materials={name: (worn,) for name, worn in PARTS.items()} | {"Plane": ("M4",)},
    places={"Cylinder": (0.0, 0.5, 0.1), "Cube": (0.0, 0.5, 0.6), "Torus": (0.0, 0.5, 0.3)},
)


def owners(prompt: str, scene: SceneDescription = SCENE) -> dict[str, tuple[str, ...]]:
    return {a.word: a.owners for a in parse(prompt, scene).attributes if a.kind == "subject" and not a.cause}


@pytest.mark.parametrize("part", ["doors", "handle", "windows"])
def test_a_look_of_a_part_is_not_shared_out(part):
    assert not any(owners(f"warm light, a green car with a chrome {part}").values())


def test_colors_of_one_noun_have_a_material_each():
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
