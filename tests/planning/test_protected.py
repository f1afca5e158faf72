# SPDX-License-Identifier: Apache-2.0
"""What the prompt says should stay is protected."""

import pytest
from plan_parts import make_instances, make_plan

from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import LightDescription, SceneDescription

SCENE = SceneDescription(
    objects={"Vase": "subject", "Cup": "surroundings", "Table": "surroundings", "Wall": "surroundings"},
    materials={"Glaze": "subject", "Clay": "surroundings", "Wood": "surroundings", "Plaster": "surroundings"},
    object_materials={"Vase": ("Glaze",), "Cup": ("Clay",), "Table": ("Wood",), "Wall": ("Plaster",)},
    lights={"Key": LightDescription("AREA", "key"), "Fill": LightDescription("AREA", "fill")},
)


def plan_of(prompt):
    return make_plan(prompt, make_instances(materials=tuple(SCENE.materials.items())), scene=SCENE)


@pytest.mark.parametrize(
    ("stays", "material"),
    [
        ("keep the wall as it is", "Plaster"),
        ("the cup stays", "Clay"),
        ("leave the table untouched", "Wood"),
        ("don't touch the wall", "Plaster"),
        ("keep the table", "Wood"),
        ("the wall remains as it is", "Plaster"),
    ],
)
def test_what_stays_gets_no_value(stays, material):
    plan = plan_of(f"everything red, {stays}")
    assert all(plan[key].priority is None for key in plan if key.startswith(f"material/{material}/"))
    assert any(plan[key].priority is not None for key in plan if key.startswith("material/Glaze/"))
    (note,) = (note for note in parse(f"everything red, {stays}", SCENE).notes if stays in note)
    assert f"{material} stays as it is" in note


def test_several_things_stay():
    assert parse("cup and wall stay, warm light", SCENE).protected == ("material/Clay", "material/Plaster")


def test_a_light_stays():
    plan = plan_of("warm light, keep the key light")
    assert all(plan[key].priority is None for key in plan if key.startswith("light/Key/"))
    assert plan["light/Fill/temperature"].priority is not None


@pytest.mark.parametrize(
    "prompt", ["keep it warm", "keep the shadows soft", "the light stays soft", "keep the wall dark"]
)
def test_a_wish_is_no_protection(prompt):
    assert parse(prompt, SCENE).protected == ()


@pytest.mark.parametrize("prompt", ["red vase, everything else falls into black", "red vase, the rest black"])
def test_everything_else_is_a_target(prompt):
    (black,) = (a for a in parse(prompt, SCENE).attributes if a.word == "black")
    assert black.region == "surroundings"
