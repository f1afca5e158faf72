# SPDX-License-Identifier: GPL-3.0-or-later
"""A backdrop of its own for a world that has none: offered with the world's values, made when values move it away."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from bpy.types import World

from ..core.journal import Journal
from ..core.schema_import import labels, schema
from .nodes import parting

WORLD_OF_BACKDROP = {f"world/backdrop_{name}": f"world/{name}" for name in ("color", "tint", "strength")}
"""The parameters of a backdrop, and those of the world that it starts from."""


def offered_backdrop(
    world: World | None, instances: Mapping[str, schema.Instance]
) -> dict[str, schema.Instance]:
    """The parameters that a backdrop would have; none where the world cannot be parted, or is partly locked.

    Args:
        instances: The scene's parameters by key.
    """
    if world is None or not parting.can_have_backdrop(world):
        return {}
    own = {key: instances[its] for key, its in WORLD_OF_BACKDROP.items() if its in instances}
    if any(instance.locked for instance in own.values()):
        return {}
    return {key: replace(i, parameter=schema.FAMILIES[key]) for key, i in own.items()}


def with_backdrop(
    journal: Journal,
    world: World | None,
    instances: Mapping[str, schema.Instance],
    values: Mapping[str, Sequence[float]],
) -> dict[str, Sequence[float]]:
    """Parts a world if values move its backdrop away from it.

    Args:
        instances: The scene's parameters of the world, by key.
        values: What is going to be written, by key; of anything.

    Returns:
        The values to write: without those of a backdrop that is to look as the world; of a new one, all.
    """
    offer = offered_backdrop(world, instances)
    named = [key for key in values if key in offer]
    if world is None or not named:
        return dict(values)
    future = {key: tuple(values.get(key, instance.value)) for key, instance in {**instances, **offer}.items()}
    if all(labels.same(key, future[WORLD_OF_BACKDROP[key]], future[key]) for key in named):
        return {key: value for key, value in values.items() if key not in offer}
    parting.add_backdrop(journal, world)
    return {**{key: instance.value for key, instance in offer.items()}, **values}
