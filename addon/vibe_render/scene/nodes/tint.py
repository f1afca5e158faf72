# SPDX-License-Identifier: GPL-3.0-or-later
"""Vibe Tint: an owned group between a computed color and where it goes.

out = Tint · lerp(Color, luma(Color), Recolor), luma with the weights of Rec.709.
"""

from __future__ import annotations

from bpy.types import Node, NodeSocket, NodeTree

from ...core import locks
from ...core.color import LUMA
from ...core.journal import Journal
from ...core.value_slots import LazySlot, ValueSlot, socket_slot
from . import owned, shaders

NAME = "Vibe Tint"
_IDENTITY = {"Tint": (1.0, 1.0, 1.0), "Recolor": 0.0}


def slot(entry: NodeSocket, inside: tuple[Node, ...], name: str) -> ValueSlot | None:
    """An input of the tint on a shader's color input; None where the color is not computed.

    Args:
        entry: The shader's color input.
        inside: The group nodes that the shader is in.
        name: "Tint" or "Recolor".
    """
    socket, source = shaders.resolve(entry, inside)
    if source is None:
        return None

    def find() -> ValueSlot | None:
        links = shaders.active_links(socket)
        nodes = owned.group_nodes(socket.id_data, NAME)
        node = next((n for n in nodes if links and n == links[0].from_node), None)
        return socket_slot(node.inputs[name]) if node else None

    def make(journal: Journal) -> ValueSlot:
        node = owned.group_node(journal, socket.id_data, _group(journal), socket.node)
        owned.insert(journal, shaders.active_links(socket)[0].from_socket, node, "Color", socket, "Color")
        return socket_slot(node.inputs[name])

    return LazySlot(find, make, _IDENTITY[name], locks.of_socket(socket, None))


def _group(journal: Journal) -> NodeTree:
    tree, new = owned.group(journal, NAME, "ShaderNodeTree")
    if new:
        owned.socket(tree, "Color", "NodeSocketColor", (0.8, 0.8, 0.8, 1.0))
        owned.socket(tree, "Tint", "NodeSocketColor", (1.0, 1.0, 1.0, 1.0))
        owned.socket(tree, "Recolor", "NodeSocketFloat", 0.0, 0.0, 1.0)
        tree.interface.new_socket("Color", in_out="OUTPUT", socket_type="NodeSocketColor")
        _fill(tree)
    return tree


def _fill(tree: NodeTree) -> None:
    build = owned.Builder(tree)
    color, tint, recolor = build.inputs("Color", "Tint", "Recolor")
    luma = build.vector("DOT_PRODUCT", color, LUMA)
    gray = build.vector("SCALE", build.vector("SUBTRACT", luma, color), scale=recolor)
    build.output(build.vector("MULTIPLY", build.vector("ADD", color, gray), tint))
