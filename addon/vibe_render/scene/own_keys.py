# SPDX-License-Identifier: GPL-3.0-or-later
"""The artist's keyframes of values that a look may change: muted during the search, then shifted as the look asks."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

import bpy
from bpy.types import ID, FCurve, NodeSocket, Scene
from mathutils import Vector

from ..core import compat, locks
from ..core.journal import HELD, held_name, keys_of, mark_held, resolve, set_keys
from ..core.schema_import import labels
from ..core.value_slots import PropertySlot, same
from . import bindings, keyframes, scene_context, snapshot


def hold(scene: Scene) -> None:
    """Mutes the artist's curves of all values that only keyframes lock; each keeps its value at the current frame.

    Other values stay locked: those with drivers, NLA strips or curve modifiers, those whose action other data-blocks
    use, and those of node inputs that share a value.
    """
    context = scene_context.SceneContext(scene, (), Vector(), everything=True)
    with snapshot.transaction(scene) as journal:
        for row, owner, slot in list(bindings.slots(context)):
            if not (isinstance(slot, PropertySlot) and slot.locked.endswith(locks.ANIMATED)) or owner.locked:
                continue
            struct, block = slot.owner, slot.owner.id_data
            path = slot.name if isinstance(struct, ID) else f"{struct.path_from_id()}.{slot.name}"
            curves = [curve for curve in compat.curves(block) if curve.data_path == path]
            action = block.animation_data.action if block.animation_data else None
            mine = all(curve.id_data == action and not curve.mute for curve in curves)
            plain = all(c.keyframe_points and not (c.modifiers or c.sampled_points) for c in curves)
            shared = isinstance(struct, NodeSocket) and (
                len(struct.links) > 1 or (not block.is_embedded_data and locks.uses(block) > 1)
            )
            if shared or keyframes.obstacle(block) or not (mine and plain):
                continue
            journal.set(struct, slot.name, getattr(struct, slot.name))
            for curve in curves:
                compat.set_to_curve(block, curve, scene.frame_current)
            for curve in curves:
                journal.hold(block, curve, row.parameter.key(owner.name), _present(block, curve))


def are_held(scene: Scene) -> bool:
    """True if the scene has a snapshot and some action has keyframes that `hold` has muted."""
    return snapshot.exists(scene) and any(HELD in action for action in bpy.data.actions)


def release(scene: Scene) -> None:
    """Unmutes the curves that `hold` has muted; shifts or scales each curve's keys as the look changed its value."""
    if not are_held(scene):
        return
    held = [row for row in snapshot.load(scene).curves("held") if row[2].mute]
    newest = {(entry["id"], entry["path"], held_name(curve)): (entry, block, curve) for entry, block, curve in held}
    for entry, block, curve in newest.values():
        with suppress(ValueError, AttributeError):  # the artist has removed the animated property
            was, now = entry["was"], _present(block, curve)
            if not same(was, now):
                # A factor, or on a linear scale (or from 0) a difference: both keep the form of the curve.
                linear = was <= 0.0 or labels.parameter(entry["key"]).scale.name == "linear"
                keys = [[v + now - was if linear else v * now / was for v in key] for key in keys_of(curve)]
                set_keys(curve, keys)
        mark_held(curve, False)
    scene.frame_set(scene.frame_current)


def _present(block: Any, curve: FCurve) -> float:
    path, _, name = curve.data_path.rpartition(".")
    value = getattr(resolve(block, path), name)
    return float(value[curve.array_index] if hasattr(value, "__len__") else value)


@contextmanager
def as_before(scene: Scene) -> Iterator[None]:
    """Restores, for the duration of the block, the artist's curves as they were before a look shifted them."""
    moved = []
    for entry, _, curve in reversed(snapshot.load(scene).curves("held")):
        moved.append((curve, keys_of(curve)))
        set_keys(curve, entry["keys"])
    scene.frame_set(scene.frame_current)
    try:
        yield
    finally:
        for curve, keys in reversed(moved):
            set_keys(curve, keys)
        scene.frame_set(scene.frame_current)
