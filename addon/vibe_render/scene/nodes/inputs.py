# SPDX-License-Identifier: GPL-3.0-or-later
"""Value slots of node inputs, which change nothing but what they mean: not other inputs, not other materials."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from bpy.types import Node, NodeTree

from ...core import locks
from ...core.journal import Journal
from ...core.value_slots import ValueSlot, same, socket_slot
from . import owned
from .trails import NodeEntry, ValueOrigin, resolve

FindEntry = Callable[[], NodeEntry | None]
"""Finds an input anew: copies of groups have other nodes than the groups."""

_VALUE = "Vibe Value"


@dataclass
class InputSlot:
    """Value slot: an input whose value others use too, so that it gets one of its own when it changes."""

    find: FindEntry
    locked: str

    def _origin(self) -> ValueOrigin:
        entry = self.find()
        assert entry
        return resolve(entry)

    def get(self) -> Any:
        """A number, or a tuple."""
        return socket_slot(self._origin().socket).get()

    def set(self, journal: Journal, raw: Any) -> None:
        """Sets it; copies node groups, and adds a node of ours, where others need the old value."""
        old = self.get()
        if same(raw, old[: len(raw)] if isinstance(raw, tuple) else old):
            return
        own_groups(journal, self._origin().inside)
        origin = self._origin()
        if origin.feeds_others:
            _separate(journal, origin)
            origin = self._origin()
        socket_slot(origin.socket).set(journal, raw)


def input_slot(find: FindEntry, tinted: bool = False) -> ValueSlot | None:
    """The slot of an input's value, where an artist would drag it; None if there is no such input.

    Args:
        tinted: Whether a computed value has a tint instead of a slot.
    """
    entry = find()
    if entry is None:
        return None
    origin = resolve(entry)
    if origin.source is not None and tinted:
        return None
    locked = locks.of_socket(origin.socket, origin.source, origin.inside)
    if locked or not (origin.feeds_others or any(map(_is_shared, origin.inside))):
        return socket_slot(origin.socket, locked)
    return InputSlot(find, locked)


def _is_shared(group: Node) -> bool:
    return bool(group.node_tree.library) or locks.uses(group.node_tree) > 1


def own_groups(journal: Journal, inside: tuple[Node, ...]) -> None:
    """Gives a material copies of the node groups on the way to a value that it shares with others.

    Args:
        inside: The group nodes from the material's tree inwards.
    """
    tree: NodeTree | None = None
    for group in inside:
        # In the copy, if the group around it has just been copied.
        node = tree.nodes[group.name] if tree else group
        if _is_shared(node):
            journal.set(node, "node_tree", journal.copy("node_groups", node.node_tree))
        tree = node.node_tree


def _separate(journal: Journal, origin: ValueOrigin) -> None:
    """Puts a node of our own between a Value or RGB node and the inputs that mean the same.

    An artist would drag the node itself only if all that it feeds were to change: the roughness of one shader must
    not change the bump of another.
    """
    tree, node = origin.socket.id_data, origin.socket.node
    twin = journal.node(tree, node.bl_idname, _VALUE)
    owned.dress(journal, tree, twin, origin.targets[0].node)
    twin.outputs[0].default_value = origin.socket.default_value
    for target in origin.targets:
        journal.link(twin.outputs[0], target)
