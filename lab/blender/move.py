# SPDX-License-Identifier: GPL-3.0-or-later
"""A small step away from a scene's values, such as a round of a vibe makes. No bpy here."""

from __future__ import annotations

import random
from collections.abc import Mapping

from vibe_render.core.schema_import import schema

STEP, MOST = 0.1, 6
_MOVED = {
    "material": ("base_color", "tint", "roughness", "metallic", "emission", "coat"),
    "light": ("power", "strength", "color", "size"),
    "world": ("color", "tint", "strength"),
    "volume": ("density", "color"),
    "film": ("exposure", "contrast", "saturation"),
}
_OFF = ("density", "emission", "coat")
"""Values that stay where they are 0: what a scene does not have is not moved."""


def move(instances: Mapping[str, schema.Instance], chance: random.Random) -> dict[str, schema.Values]:
    """Values of at most six parameters, each about a tenth of its perceptual scale from where it is.

    The groups take turns, so that lights, surfaces, world, fog and film move together. What moves
    anything in space is left out.

    Args:
        instances: The scene's parameters by key.
    """
    queues = [_candidates(instances, group, chance) for group in _MOVED]
    chosen: list[schema.Instance] = []
    while any(queues) and len(chosen) < MOST:
        chosen += [queue.pop() for queue in queues if queue][: MOST - len(chosen)]
    return {instance.key: _moved(instance, chance) for instance in chosen}


def _candidates(instances: Mapping[str, schema.Instance], group: str, chance: random.Random) -> list[schema.Instance]:
    candidates = []
    for _, instance in sorted(instances.items()):
        name, value = instance.parameter.name, max(instance.value)
        if instance.parameter.group != group or name not in _MOVED[group] or instance.locked:
            continue
        if not (name in _OFF and value == 0.0):
            candidates.append(instance)
    chance.shuffle(candidates)
    return candidates


def _moved(instance: schema.Instance, chance: random.Random) -> schema.Values:
    """All components go the same way, the farther from the end of the range; each by half a step to a whole one."""
    scale = instance.parameter.scale
    ends = list(zip(instance.value, instance.lower, instance.upper, strict=True))
    units = [scale.to_unit(*row) for row in ends]
    mean = sum(units) / len(units)
    sign = chance.choice((-1.0, 1.0)) if STEP < mean < 1.0 - STEP else 1.0 if mean < 0.5 else -1.0
    steps = [sign * STEP * chance.uniform(0.5, 1.0) for _ in units]
    moved = (min(max(u + step, 0.0), 1.0) for u, step in zip(units, steps, strict=True))
    return tuple(scale.from_unit(u, low, high) for u, (_, low, high) in zip(moved, ends, strict=True))
