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
from . import inputs, owned
from .inputs import FindEntry
from .trails import NodeEntry, ValueOrigin, active_links, resolve

NAME = "Vibe Tint"
_IDENTITY = {"Tint": (1.0, 1.0, 1.0), "Recolor": 0.0}


def slot(find: FindEntry, name: str, plain: bool = False) -> ValueSlot | None:
    """An input of the tint on a color input; None where there is no such input, or its color is not computed.

    Args:
        find: Finds the color input.
        name: "Tint" or "Recolor".
        plain: Whether a color that is not computed gets a tint too: one of several colors that are mixed.
    """
    entry = find()
    if entry is None:
        return None
    first = resolve(entry)
    if first.source is None and not plain:
        return None

    def origin() -> ValueOrigin:
        entry = find()
        assert entry
        return resolve(entry)

    def own() -> NodeEntry | None:
        node = of(origin().source)
        return NodeEntry(node.inputs[name], origin().inside) if node else None

    def tinted() -> ValueSlot | None:
        return inputs.slot(own) if of(origin().source) else None

    def make(journal: Journal) -> ValueSlot:
        inputs.own_groups(journal, first.inside)
        node = of(origin().source) or _insert(journal, origin())
        return socket_slot(node.inputs[name])

    return LazySlot(tinted, make, _IDENTITY[name], locks.of_socket(first.socket, None, first.inside))


def of(source: NodeSocket | None) -> Node | None:
    """The tint that an output belongs to, if it is one's."""
    if source is None or source.node.type != "GROUP" or source.node.node_tree is None:
        return None
    return source.node if source.node.node_tree.get(owned.MARK) == NAME else None


def untinted(entry: NodeEntry) -> ValueOrigin:
    """Where the color of an input comes from before its tint."""
    origin = resolve(entry)
    node = of(origin.source)
    if node is None:
        return origin
    color = node.inputs["Color"]
    source = active_links(color)[0].from_socket if active_links(color) else None
    return ValueOrigin(color, source, origin.inside)


def _insert(journal: Journal, origin: ValueOrigin) -> Node:
    """Puts a tint before all inputs that mean the same; what else gets the color keeps it as it is."""
    socket = origin.socket
    targets = origin.targets or (socket,)
    node = owned.group_node(journal, socket.id_data, _group(journal), targets[0].node)
    feed = origin.source or (socket if socket.is_output else None)
    if feed:
        journal.link(feed, node.inputs["Color"])
    else:
        node.inputs["Color"].default_value = socket.default_value
    for target in targets:
        journal.link(node.outputs["Color"], target)
    return node


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
