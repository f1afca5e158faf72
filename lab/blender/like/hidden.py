# SPDX-License-Identifier: GPL-3.0-or-later
"""A look drawn at random, whose values are then hidden: only its picture is shown. No bpy here.

What is drawn depends on the seed and on a value's role, so that one seed gives two scenes the same look.
"""

from __future__ import annotations

import colorsys
import random
from collections.abc import Callable, Collection, Mapping

from vibe_render.core.schema_import import schema

FOGGY = 0.5
"""Share of the looks that have fog."""
_PAIRS = {"tint": "color", "strength": "power"}
"""Values that are the same of a look, though scenes differ in which one they have."""

Draw = Callable[[random.Random, schema.Instance], tuple[float, ...]]


def _times(octaves: float) -> Draw:
    """The scene's own value, at most so many times doubled or halved."""
    return lambda luck, instance: tuple(v * 2 ** luck.uniform(-octaves, octaves) for v in instance.value)


def _within(low: float, high: float) -> Draw:
    return lambda luck, instance: tuple(luck.uniform(low, high) for _ in instance.value)


def _light_color(luck: random.Random, _: schema.Instance) -> tuple[float, ...]:
    """Any hue, from nearly white to as blue as dusk."""
    return colorsys.hsv_to_rgb(luck.random(), luck.uniform(0.0, 0.6), 1.0)


def _surface_color(luck: random.Random, _: schema.Instance) -> tuple[float, ...]:
    return colorsys.hsv_to_rgb(luck.random(), luck.uniform(0.1, 0.8), luck.uniform(0.1, 0.7))


def _temperature(luck: random.Random, _: schema.Instance) -> tuple[float, ...]:
    """From a candle-lit room to open shade, in steps that look alike: reciprocal kelvin."""
    return (1e6 / luck.uniform(105.0, 400.0),)


def _vignette(luck: random.Random, _: schema.Instance) -> tuple[float, ...]:
    return (luck.choice((0.0, luck.uniform(0.2, 0.7))),)


DRAWS: Mapping[str, Draw] = {
    "light/power": _times(1.2),
    "light/strength": _times(1.2),
    "light/temperature": _temperature,
    "light/elevation": _within(12.0, 65.0),
    "light/size": _times(1.5),
    "light/angle": _times(1.5),
    "world/strength": _times(1.5),
    "world/color": _light_color,
    "world/tint": _light_color,
    "volume/color": _light_color,
    "film/exposure": _within(-0.8, 0.8),
    "film/contrast": _within(0.85, 1.3),
    "film/saturation": _within(0.6, 1.3),
    "film/lift": _within(0.95, 1.05),
    "film/gain": _within(0.88, 1.12),
    "film/vignette": _vignette,
    "material/base_color": _surface_color,
    "material/roughness": _within(0.15, 0.85),
}
"""Drawn values, by family; directions and fog beside that."""


def hidden_values(
    instances: Mapping[str, schema.Instance], seed: str, groups: Collection[str]
) -> dict[str, schema.Values]:
    """Draws the values of a look.

    Args:
        instances: The scene's parameters by key.
        groups: Of the schema; what is in others stays.
    """
    front = instances["camera/azimuth"].value[0] if "camera/azimuth" in instances else 0.0
    fog = random.Random(f"{seed}/fog")
    depth = fog.uniform(0.2, 1.0) if fog.random() < FOGGY else 0.0
    values: dict[str, schema.Values] = {}
    for key, instance in sorted(instances.items()):
        family, group = instance.parameter.family, instance.parameter.group
        if group not in groups or instance.locked:
            continue
        luck = _luck(seed, instance)
        if family == "light/azimuth":
            behind = instance.role == "rim"
            values[key] = (front + (180.0 if behind else 0.0) + luck.uniform(-1, 1) * (40.0 if behind else 80.0),)
        elif family == "volume/density":
            values[key] = (depth * instance.reference,)
        elif draw := DRAWS.get(family):
            ends = zip(draw(luck, instance), instance.lower, instance.upper, strict=True)
            values[key] = tuple(min(max(v, low), high) for v, low, high in ends)
    return values


def _luck(seed: str, instance: schema.Instance) -> random.Random:
    """Random numbers of a value by its role; each material has its own."""
    group, owner, name = schema.split_key(instance.key)
    whose = owner if group == "material" else instance.role
    return random.Random(f"{seed}/{group}/{whose}/{_PAIRS.get(name, name)}")
