# SPDX-License-Identifier: Apache-2.0
"""Scenes, drawn at random: recipes as plain data, which Blender's side builds (lab/blender/sealed.py)."""

from __future__ import annotations

import random
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

Linear = tuple[float, float, float]

_GROUNDS = {"cove": "backdrop", "floor": "floor", "room": "floor", "none": ""}
"""Nouns of prompts for a stage."""
_PICTURES = ("city", "courtyard", "forest", "interior", "studio", "sunrise", "sunset")
_TEXTURES = ("", "", "", "", "", "wood", "checker", "speckles")
_TRANSFORMS = ("AgX", "AgX", "AgX", "AgX", "Filmic", "Standard")


@dataclass(frozen=True)
class DrawnThing:
    """A subject.

    Attributes:
        say: What prompts call it.
        shape: What Blender's side builds.
        stages: What it may stand on.
        parts: Start of objects' names -> name of the material that they have instead.
    """

    say: str
    shape: str
    stages: tuple[str, ...]
    parts: Mapping[str, str] = field(default_factory=dict)

    @property
    def material(self) -> str:
        """The name of its material."""
        return self.say.title()

    @property
    def is_place(self) -> bool:
        """True if it is one thing among others: in a room, in a street, in a park."""
        return self.shape in ("lounge", "bedroom", "kitchen", "street", "park")


@dataclass(frozen=True)
class DrawnScene:
    """A scene.

    Attributes:
        thing: Its subject.
        ground: What prompts call its stage, whose material is named so too; "" without a stage.
        recipe: For Blender's side: what `SceneRecipe` takes.
        finishes: Name of a material -> what `FinishRecipe` takes.
    """

    thing: DrawnThing
    ground: str
    recipe: Mapping[str, Any]
    finishes: Mapping[str, Mapping[str, Any]]

    @property
    def plain(self) -> dict[str, Any]:
        """For Blender's side, as JSON has it."""
        thing = {"material": self.thing.material, "parts": dict(self.thing.parts)}
        return {"thing": thing, "ground": self.ground, "recipe": self.recipe, "finishes": self.finishes}


@cache
def things() -> tuple[DrawnThing, ...]:
    """All subjects."""
    rows = tomllib.loads((Path(__file__).parent / "things.toml").read_text("utf-8"))["thing"]
    return tuple(DrawnThing(**{**row, "stages": tuple(row["stages"])}) for row in rows)


def draw_scene(luck: random.Random) -> DrawnScene:
    """Draws a subject, and its materials, stage, lamps, world, camera and view transform."""
    thing = luck.choice(things())
    stage = luck.choice(thing.stages)
    finishes = {name: _finish(luck) for name in dict.fromkeys([thing.material, *thing.parts.values()])}
    recipe = {
        "name": thing.shape,
        "shape": thing.shape,
        "stage": stage,
        "ground": _finish(luck, luck.choice(_TEXTURES)),
        "walls": [_color(luck), _color(luck)],
        "lamps": _lamps(luck, stage, thing),
        "world": _world(luck, stage),
        "view": _view(luck, thing),
        "transform": luck.choice(_TRANSFORMS),
    }
    return DrawnScene(thing, _GROUNDS[stage], recipe, finishes)


def _color(luck: random.Random) -> Linear:
    """Mostly a muted one, as most of a scene is."""
    gray, spread = luck.uniform(0.08, 0.6), luck.choice((0.1, 0.3, 0.7))
    r, g, b = (min(gray * (1 + spread * luck.uniform(-1, 1)), 0.9) for _ in range(3))
    return r, g, b


def _finish(luck: random.Random, texture: str = "") -> dict[str, Any]:
    metal = luck.random() < 0.15
    inputs = {"Metallic": 1.0} if metal else {}
    return {"color": _color(luck), "roughness": luck.uniform(0.15, 0.9), "texture": texture, "inputs": inputs}


def _lamps(luck: random.Random, stage: str, thing: DrawnThing) -> list[dict[str, Any]]:
    """A ceiling in a room, a sun outdoors, else softboxes and bulbs."""
    if stage == "room":
        ceiling = {"kind": "AREA", "azimuth": 0.0, "elevation": 85.0, "level": luck.uniform(0.4, 0.9)}
        return [ceiling | {"size": 1.4, "distance": 2.6}, *_bulbs(luck, 0.2)]
    if thing.is_place:
        sun = {"kind": "SUN", "azimuth": luck.uniform(-120, 120), "elevation": luck.uniform(20, 65)}
        return [sun | {"level": luck.uniform(0.4, 1.0), "size": luck.choice((0.5, 2.0, 10.0))}]
    key = {"kind": "AREA", "azimuth": luck.uniform(-70, 70), "elevation": luck.uniform(20, 60)}
    softbox = key | {"level": luck.uniform(0.4, 0.9), "size": luck.choice((0.3, 1.0, 2.0)), "color": _tint(luck)}
    return [softbox, *_bulbs(luck, 0.3)]


def _bulbs(luck: random.Random, level: float) -> list[dict[str, Any]]:
    count = luck.choice((0, 1, 1, 2))
    return [
        {
            "kind": "POINT",
            "azimuth": luck.uniform(-160, 160),
            "elevation": luck.uniform(10, 50),
            "level": level * luck.uniform(0.5, 1.5),
            "size": 0.15,
            "color": _tint(luck),
            "distance": 3.0,
        }
        for _ in range(count)
    ]


def _tint(luck: random.Random) -> Linear:
    """White, a warm white or a cold one."""
    return luck.choice(((1.0, 1.0, 1.0), (1.0, 0.8, 0.6), (0.75, 0.86, 1.0)))


def _world(luck: random.Random, stage: str) -> dict[str, Any]:
    if stage != "room" and luck.random() < 0.4:
        return {"strength": luck.uniform(0.4, 0.9), "picture": luck.choice(_PICTURES)}
    return {"strength": luck.uniform(0.1, 0.6), "color": luck.choice(((0.5, 0.5, 0.5), (0.35, 0.5, 0.75)))}


def _view(luck: random.Random, thing: DrawnThing) -> dict[str, float]:
    if thing.is_place:
        return {"azimuth": luck.uniform(-8, 12), "elevation": luck.uniform(7, 12), "fov": 46.0, "fill": 0.9}
    angles = {"azimuth": luck.uniform(-35, 35), "elevation": luck.uniform(6, 20)}
    return angles | {"fov": 38.0, "fill": luck.uniform(0.55, 0.75)}
