# SPDX-License-Identifier: Apache-2.0
"""Plans of sentences for made-up scenes: no file, no picture, only parameters and their values."""

from __future__ import annotations

import random

from proxy_renderer.goals.resolve import goals_of
from proxy_renderer.planning.planner import plan
from proxy_renderer.planning.types import Plan
from proxy_renderer.schema import PARAMETERS, Instance
from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import LightDescription, SceneDescription

LIGHTS = (("Key", "AREA", "key", -40.0), ("Fill", "AREA", "fill", 60.0), ("Back", "POINT", "rim", 160.0))
REFERENCES = {
    "light_distance": 4.0,
    "light_distance_squared": 16.0,
    "view_distance": 6.0,
    "per_view_distance": 1 / 6,
    "subject_height": 2.0,
    "per_subject_height": 0.5,
}


def make_instances(
    seed: int | None = None,
    lights=LIGHTS,
    materials=(("Body", "subject"), ("Floor", "surroundings")),
    textured: tuple[str, ...] = (),
    environment: bool = False,
) -> dict[str, Instance]:
    """Instances of a scene; with a seed, with random legal values and lights that are anywhere."""
    draw = random.Random(seed)
    found: dict[str, Instance] = {}

    def add(parameter, owner="", role="", value=None):
        reference = REFERENCES.get(parameter.reference, 1.0)
        if seed is not None:
            low, high = parameter.lower, parameter.upper
            value = tuple(
                parameter.scale.from_unit(draw.random(), low, high) * reference for _ in range(parameter.components)
            )
        elif value is None:
            value = (parameter.default * reference,) * parameter.components
        instance = Instance(parameter, owner, value, reference, role)
        found[instance.key] = instance

    for parameter in PARAMETERS:
        if parameter.group == "light":
            for name, kind, role, azimuth in lights:
                if not parameter.only or kind in parameter.only:
                    add(parameter, name, role, (azimuth,) if parameter.name == "azimuth" else None)
        elif parameter.group == "material":
            for name, role in materials:
                linked = parameter.name in ("tint", "recolor")
                if (linked and name in textured) or (
                    not linked and not (parameter.name == "base_color" and name in textured)
                ):
                    add(parameter, name, role)
        elif parameter.group == "world":
            if parameter.name in (("tint", "strength", "rotation") if environment else ("color", "strength")):
                add(parameter)
        else:
            add(parameter)
    return found


SCENE = SceneDescription(lights={name: LightDescription(kind, role) for name, kind, role, _ in LIGHTS})


def make_plan(prompt: str, instances=None, scene: SceneDescription = SCENE) -> Plan:
    return plan(goals_of(parse(prompt, scene)), make_instances() if instances is None else instances, scene)
