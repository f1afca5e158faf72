# SPDX-License-Identifier: GPL-3.0-or-later
"""Value slots of node inputs, and insets: added node groups in front of an input, which change the value that it gets."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from bpy.types import Node, NodeSocket, NodeTree

from ...core import locks
from ...core.color import LUMA
from ...core.journal import Journal
from ...core.value_slots import LazySlot, ValueSlot, same, socket_slot
from . import owned
from .trails import NodeEntry, ValueOrigin, active_links, resolve

FindEntry = Callable[[], NodeEntry | None]
"""Finds an input, or returns None; called anew each time, because after a group is copied, the input is in the copy."""

_WHITE = (1.0, 1.0, 1.0)


@dataclass
class _InputSlot:
    """Value slot: an input that shares its value with other inputs; writing first gives it a value of its own."""

    find: FindEntry
    locked: str

    def get(self) -> Any:
        return socket_slot(_origin(self.find).socket).get()

    def set(self, journal: Journal, raw: Any) -> None:
        old = self.get()
        if same(raw, old[: len(raw)] if isinstance(raw, tuple) else old):
            return
        own_groups(journal, _origin(self.find).inside)
        origin = _origin(self.find)
        # A Value or RGB node may feed inputs of other meanings: the roughness of one shader, the bump of another. So the
        # inputs with the same meaning get a Vibe Value node instead, which starts with the same value.
        if origin.feeds_others:
            tree, node = origin.socket.id_data, origin.socket.node
            twin = journal.node(tree, node.bl_idname, "Vibe Value")
            owned.dress(journal, tree, twin, origin.targets[0].node)
            twin.outputs[0].default_value = origin.socket.default_value
            for target in origin.targets:
                journal.link(twin.outputs[0], target)
            origin = _origin(self.find)
        socket_slot(origin.socket).set(journal, raw)


def input_slot(find: FindEntry, tinted: bool = False) -> ValueSlot | None:
    """The slot of an input's value, at the place that stores it; None without an input.

    If nodes compute the value, the slot is locked; with `tinted`, it is None, because a Vibe Tint changes such a value.
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
    return _InputSlot(find, locked)


def _origin(find: FindEntry) -> ValueOrigin:
    entry = find()
    assert entry
    return resolve(entry)


def _is_shared(group: Node) -> bool:
    return bool(group.node_tree.library) or locks.uses(group.node_tree) > 1


def own_groups(journal: Journal, inside: tuple[Node, ...]) -> None:
    """Replaces node groups with other users by copies; `inside` are the group nodes from the outermost tree inwards."""
    tree: NodeTree | None = None
    for group in inside:
        # If the group around it has been copied, take the node in the copy.
        node = tree.nodes[group.name] if tree else group
        if _is_shared(node):
            journal.set(node, "node_tree", journal.copy("node_groups", node.node_tree))
        tree = node.node_tree


@dataclass(frozen=True)
class Inset:
    """A kind of inset, a node group: its first input takes the original value, its only output is the changed one."""

    name: str  # of the group
    inputs: owned.GroupInputs
    result: Callable[..., NodeSocket]  # (builder, *group inputs) -> socket with the changed value

    def slot(
        self, find: FindEntry, name: str, plain: bool = False, settings: Mapping[str, float] | None = None
    ) -> ValueSlot | None:
        """The slot of input `name` of the inset in front of the node input that `find` returns; writing adds the inset.

        None if that node input has a constant value, unless `plain`: one of several mixed colors has an inset, too.
        `settings` are first values of the inset's other inputs.
        """
        entry = find()
        if entry is None:
            return None
        first = resolve(entry)
        if first.source is None and not plain:
            return None

        def own() -> NodeEntry | None:
            origin = _origin(find)
            node = self.of(origin.source)
            return NodeEntry(node.inputs[name], origin.inside) if node else None

        def make(journal: Journal) -> ValueSlot:
            own_groups(journal, first.inside)
            origin = _origin(find)
            node = self.of(origin.source) or self._insert(journal, origin, settings or {})
            return socket_slot(node.inputs[name])

        locked = locks.of_socket(first.socket, None, first.inside)
        return LazySlot(partial(input_slot, own), make, self.inputs[name][0], locked)

    def of(self, source: NodeSocket | None) -> Node | None:
        """The node that an output belongs to if it is an inset of this kind, else None."""
        return source.node if source and _inset_name(source.node) == self.name else None

    def _insert(self, journal: Journal, origin: ValueOrigin, settings: Mapping[str, float]) -> Node:
        """Adds and returns an inset in front of `origin.targets`; other inputs of the same source keep their value."""
        socket = origin.socket
        targets = origin.targets or (socket,)
        node = owned.group_node(journal, socket.id_data, self.name, self._fill, targets[0].node)
        feed = origin.source or (socket if socket.is_output else None)
        if feed:
            journal.link(feed, node.inputs[0])
        else:
            node.inputs[0].default_value = socket.default_value
        for name, value in settings.items():
            node.inputs[name].default_value = value
        for target in targets:
            journal.link(node.outputs[0], target)
        return node

    def _fill(self, tree: NodeTree) -> None:
        first, (identity, *_) = next(iter(self.inputs.items()))
        kind = "NodeSocketColor" if isinstance(identity, tuple) else "NodeSocketFloat"
        owned.declare(tree, self.inputs, first, kind)
        build = owned.Builder(tree)
        build.output(self.result(build, *build.inputs(*self.inputs)))


def _inset_name(node: Node) -> str:
    return node.node_tree.get(owned.MARK, "") if node.type == "GROUP" and node.node_tree else ""


def neutralize(tree: NodeTree) -> None:
    """Sets the Vibe Tints and Vibe Factors of a tree to the values that change nothing."""
    for node in tree.nodes:
        for kind in (kind for kind in (TINT, FACTOR) if _inset_name(node) == kind.name):
            for name, (identity, *_) in [*kind.inputs.items()][1:]:
                color = isinstance(identity, tuple)
                node.inputs[name].default_value = (*identity, 1.0) if color else identity


def artists_origin(entry: NodeEntry) -> ValueOrigin:
    """The origin of an input's value as the artist built it, before an inset changes the value."""
    origin = resolve(entry)
    if origin.source is None or not _inset_name(origin.source.node):
        return origin
    taken = origin.source.node.inputs[0]
    source = active_links(taken)[0].from_socket if active_links(taken) else None
    return ValueOrigin(taken, source, origin.inside)


def _tinted(build: owned.Builder, color: NodeSocket, tint: NodeSocket, recolor: NodeSocket) -> NodeSocket:
    """The result of a Vibe Tint: (color + Recolor · (luma − color)) · Tint."""
    luma = build.vector("DOT_PRODUCT", color, LUMA)
    gray = build.vector("SCALE", build.vector("SUBTRACT", luma, color), Scale=recolor)
    return build.vector("MULTIPLY", build.vector("ADD", color, gray), tint)


def _faded(build: owned.Builder, color: NodeSocket, horizon: NodeSocket, height: NodeSocket) -> NodeSocket:
    """The color, multiplied by a tint that is full at the horizon's height and fades toward the top of the image."""
    window = build.node("ShaderNodeTexCoord").outputs["Window"]
    place = build.node("ShaderNodeSeparateXYZ", Vector=window).outputs["Y"]
    rise = build.math("SUBTRACT", place, height), build.math("SUBTRACT", 1.0, height)
    share = build.math("DIVIDE", *rise, clamp=True)
    # smoothstep: s² (3 - 2 s)
    smooth = build.math("MULTIPLY", build.math("MULTIPLY", share, share), build.math("MULTIPLY_ADD", share, -2.0, 3.0))
    left = build.vector("SCALE", build.vector("SUBTRACT", _WHITE, horizon), Scale=smooth)
    return build.vector("MULTIPLY", color, build.vector("ADD", horizon, left))


TINT = Inset("Vibe Tint", {"Color": ((0.8, 0.8, 0.8),), "Tint": (_WHITE,), "Recolor": (0.0, 0.0, 1.0)}, _tinted)
HORIZON = Inset(
    "Vibe Horizon", {"Color": ((0.05, 0.05, 0.05),), "Horizon": (_WHITE,), "Height": (0.0, -1.0, 1.0)}, _faded
)
FACTOR = Inset(
    "Vibe Factor",
    {"Strength": (1.0,), "Factor": (1.0, 0.0, 1000.0)},
    lambda build, strength, factor: build.math("MULTIPLY", strength, factor),
)
