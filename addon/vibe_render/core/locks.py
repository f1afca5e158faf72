# SPDX-License-Identifier: GPL-3.0-or-later
"""Locks: the reason, in words for the artist, why a value must be left alone; "" where it may change."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
from bpy.types import Node, NodeSocket, NodeTree, Object, bpy_struct

from . import compat
from .journal import HELD, KEYFRAMES, address, held_name

ANIMATED = "is animated or driven here"


def of_property(owner: bpy_struct, name: str) -> str:
    """Lock reason of a property of a data-block, or of a struct in it such as a node socket; "" if it may change."""
    block, _ = address(owner)
    if block.library:
        return f'"{block.name}" is linked from {bpy.path.basename(block.library.filepath)}'
    if block.override_library and not owner.is_property_overridable_library(name):
        return f'"{block.name}" is a library override that keeps this value'
    return _animated(owner, name)


def _animated(owner: bpy_struct, name: str) -> str:
    block, path = address(owner)
    full = f"{path}.{name}" if path else name
    # The curves of a node tree inside a material belong to the tree, and their paths start there.
    tree = owner.id_data
    paths = [c.data_path for c in compat.curves(block) if not _is_set_aside(c)]
    if tree != block:
        paths += [f"node_tree.{c.data_path}" for c in compat.curves(tree) if not _is_set_aside(c)]
    return f'"{block.name}" {ANIMATED}' if full in paths else ""


def _is_set_aside(curve: bpy.types.FCurve) -> bool:
    """True if Vibe Render has muted a curve: one that it added, or one of the artist that is listed in `HELD`."""
    ours = curve.group is not None and curve.group.name == KEYFRAMES
    return curve.mute and (ours or held_name(curve) in curve.id_data.get(HELD, ()))


def of_pose(obj: Object) -> str:
    """Lock reason of an object's location and rotation; "" if they may change."""
    if obj.parent:
        return f'"{obj.name}" follows its parent "{obj.parent.name}"'
    if any(not c.mute and c.influence > 0.0 for c in obj.constraints):
        return f'"{obj.name}" is constrained'
    if any(obj.delta_location) or any(obj.delta_rotation_euler):
        return f'"{obj.name}" has delta transforms'
    if any(any(getattr(obj, f"lock_{part}")) for part in ("location", "rotation")):
        return f'"{obj.name}" has locked transforms'
    rotation = {"QUATERNION": "rotation_quaternion", "AXIS_ANGLE": "rotation_axis_angle"}
    return of_property(obj, "location") or of_property(obj, rotation.get(obj.rotation_mode, "rotation_euler"))


def of_socket(socket: NodeSocket, source: NodeSocket | None, inside: Sequence[Node] = ()) -> str:
    """Lock reason of a node input; "" if it may change.

    `source`: the output that computes its value, or None. `inside`: the group nodes around it, the outermost first.
    """
    if source is not None:
        return f'{socket.name} comes from "{source.node.label or source.node.name}"'
    if inside:
        # Only the outermost tree must be editable: a shared or linked group is copied before it is changed.
        return of_property(inside[0], "node_tree") or _animated(socket, "default_value")
    return of_property(socket, "default_value")


def uses(tree: NodeTree) -> int:
    """The number of nodes in the file that use a node group."""
    blocks = (*bpy.data.materials, *bpy.data.worlds, *bpy.data.lights, *bpy.data.scenes)
    trees = [t for t in (getattr(b, "node_tree", None) for b in blocks) if t]
    nodes = (node for t in (*trees, *bpy.data.node_groups) for node in t.nodes)
    return sum(node.type == "GROUP" and node.node_tree == tree for node in nodes)
