# SPDX-License-Identifier: GPL-3.0-or-later
"""The Backgrounds that a world mixes: the camera may see one and get light from another."""

from __future__ import annotations

from bpy.types import NodeSocket, World

from ...core import compat
from .layers import Layer, behind
from .trails import NodeEntry, resolve


def mixed(world: World) -> list[Layer]:
    """The Backgrounds that a world's surface is mixed of; none where it is a single one."""
    tree = compat.node_tree(world)
    output = tree.get_output_node("ALL") if tree else None
    found = list(behind(output.inputs["Surface"])) if output else []
    return found if len(found) > 1 or any(layer.sides for layer in found) else []


def entries(world: World, name: str) -> list[NodeEntry]:
    """An input of each of the mixed Backgrounds; those whose value has one origin once."""
    layers = mixed(world)
    alike = tuple(s for layer in layers if (s := layer.shader.input(name)))
    found: list[NodeEntry] = []
    origins: list[NodeSocket] = []
    for layer in layers:
        entry = layer.shader.entry(name, alike)
        if entry is None:
            continue
        origin = resolve(entry)
        if (origin.source or origin.socket) not in origins:
            origins.append(origin.source or origin.socket)
            found.append(entry)
    return found
