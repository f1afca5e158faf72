# SPDX-License-Identifier: GPL-3.0-or-later
"""Insets: owned node groups between what an input gets and the input, which change it on its way."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from bpy.types import Node, NodeSocket, NodeTree

from ...core import locks
from ...core.color import LUMA
from ...core.journal import Journal
from ...core.value_slots import LazySlot, ValueSlot, socket_slot
from . import inputs, owned
from .inputs import FindEntry
from .trails import NodeEntry, ValueOrigin, active_links, resolve


@dataclass(frozen=True)
class Inset:
    """A kind of inset. Its group's first input takes what comes in, its only output gives what goes on.

    Attributes:
        name: Of the group.
        identities: Its other inputs, with the values that change nothing.
        fill: Declares the sockets of a new group and fills it.
    """

    name: str
    identities: Mapping[str, Any]
    fill: Callable[[NodeTree], None]

    def slot(self, find: FindEntry, name: str, plain: bool = False) -> ValueSlot | None:
        """An input of the inset of an input; None where there is no such input, or its value is not computed.

        Args:
            plain: Whether a value that is not computed gets an inset too: one of several that are mixed.
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
            node = self.of(origin().source)
            return NodeEntry(node.inputs[name], origin().inside) if node else None

        def there() -> ValueSlot | None:
            return inputs.input_slot(own) if self.of(origin().source) else None

        def make(journal: Journal) -> ValueSlot:
            inputs.own_groups(journal, first.inside)
            node = self.of(origin().source) or self._insert(journal, origin())
            return socket_slot(node.inputs[name])

        return LazySlot(there, make, self.identities[name], locks.of_socket(first.socket, None, first.inside))

    def of(self, source: NodeSocket | None) -> Node | None:
        """The inset that an output belongs to, if it is one of this kind."""
        return source.node if source and _inset_name(source.node) == self.name else None

    def _insert(self, journal: Journal, origin: ValueOrigin) -> Node:
        """Puts it before all inputs that mean the same; what else gets the value keeps it as it is."""
        socket = origin.socket
        targets = origin.targets or (socket,)
        tree, new = owned.group(journal, self.name, "ShaderNodeTree")
        if new:
            self.fill(tree)
        node = owned.group_node(journal, socket.id_data, tree, targets[0].node)
        feed = origin.source or (socket if socket.is_output else None)
        if feed:
            journal.link(feed, node.inputs[0])
        else:
            node.inputs[0].default_value = socket.default_value
        for target in targets:
            journal.link(node.outputs[0], target)
        return node


def _inset_name(node: Node) -> str:
    return node.node_tree.get(owned.MARK, "") if node.type == "GROUP" and node.node_tree else ""


def neutralize(tree: NodeTree, kinds: Sequence[Inset]) -> None:
    """Sets the insets of a tree to the values that change nothing."""
    for node in tree.nodes:
        for kind in (kind for kind in kinds if _inset_name(node) == kind.name):
            for name, identity in kind.identities.items():
                color = isinstance(identity, tuple)
                node.inputs[name].default_value = (*identity, 1.0) if color else identity


def artists_origin(entry: NodeEntry) -> ValueOrigin:
    """Where an input has its value from as the artist built it, before any inset of ours."""
    origin = resolve(entry)
    if origin.source is None or not _inset_name(origin.source.node):
        return origin
    taken = origin.source.node.inputs[0]
    source = active_links(taken)[0].from_socket if active_links(taken) else None
    return ValueOrigin(taken, source, origin.inside)


def _fill_tint(tree: NodeTree) -> None:
    owned.socket(tree, "Color", "NodeSocketColor", (0.8, 0.8, 0.8, 1.0))
    owned.socket(tree, "Tint", "NodeSocketColor", (1.0, 1.0, 1.0, 1.0))
    owned.socket(tree, "Recolor", "NodeSocketFloat", 0.0, 0.0, 1.0)
    tree.interface.new_socket("Color", in_out="OUTPUT", socket_type="NodeSocketColor")
    build = owned.Builder(tree)
    color, tint, recolor = build.inputs("Color", "Tint", "Recolor")
    luma = build.vector("DOT_PRODUCT", color, LUMA)
    gray = build.vector("SCALE", build.vector("SUBTRACT", luma, color), scale=recolor)
    build.output(build.vector("MULTIPLY", build.vector("ADD", color, gray), tint))


TINT = Inset("Vibe Tint", {"Tint": (1.0, 1.0, 1.0), "Recolor": 0.0}, _fill_tint)


def _fill_factor(tree: NodeTree) -> None:
    owned.socket(tree, "Strength", "NodeSocketFloat", 1.0)
    owned.socket(tree, "Factor", "NodeSocketFloat", 1.0, 0.0, 1000.0)
    tree.interface.new_socket("Strength", in_out="OUTPUT", socket_type="NodeSocketFloat")
    build = owned.Builder(tree)
    build.output(build.math("MULTIPLY", *build.inputs("Strength", "Factor")))


FACTOR = Inset("Vibe Factor", {"Factor": 1.0}, _fill_factor)
