# SPDX-License-Identifier: GPL-3.0-or-later
"""Additions to a scene: named, colored and marked, so that artists and Vibe Render recognize them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import bpy
import numpy as np
from bpy.types import ID, Node, NodeSocket, NodeTree, Object

from ...core import compat
from ...core.journal import Journal
from ...core.rendered import MARK
from ...core.schema_import import schema

FOG = "Vibe Fog"
CARD = schema.added_lights.CARD
COLOR = (0.32, 0.22, 0.46)
GroupInputs = Mapping[str, tuple]
"""Name of a group's input -> the value that changes nothing (a color as RGB), and for most numbers the two bounds."""


def is_unseen(obj: Object) -> bool:
    """True for Vibe Render's fog box and for the cards in front of lights, whose surfaces no image shows."""
    return obj.get(MARK) in (FOG, CARD)


def new(journal: Journal, collection: str, name: str, *kind: Any, role: str = "") -> Any:
    """Adds a data-block as `Journal.new` does, and marks it as Vibe Render's with a role, by default `name`."""
    block = journal.new(collection, name, *kind)
    block[MARK] = role or name
    return block


def find_owned(blocks: Iterable[ID], role: str) -> Any:
    """The data-block in `blocks` that Vibe Render has made for a role; None if there is none."""
    return next((b for b in blocks if b.get(MARK) == role and b.library is None), None)


def owned_group(journal: Journal, name: str, kind: str, fill: Callable[[NodeTree], None]) -> NodeTree:
    """Vibe Render's node group `name`; if the file lacks it, a new tree of the type `kind`, with nodes from `fill`."""
    tree = find_owned(bpy.data.node_groups, name)
    if tree is None:
        tree = new(journal, "node_groups", name, kind)
        fill(tree)
    return tree


def group_input(tree: NodeTree, name: str, default: Any, *bounds: float) -> None:
    """Declares a group's input; `default` (number, vector or RGBA) sets its type, `bounds` are a number's limits."""
    kind = {1: "NodeSocketFloat", 3: "NodeSocketVector", 4: "NodeSocketColor"}[np.size(default)]
    item = tree.interface.new_socket(name, in_out="INPUT", socket_type=kind)
    item.default_value = default
    if bounds:
        item.min_value, item.max_value = bounds


def declare(tree: NodeTree, inputs: GroupInputs, output: str, kind: str = "NodeSocketColor") -> None:
    """Declares a group's inputs, and one output with the socket type `kind`."""
    for name, (identity, *bounds) in inputs.items():
        group_input(tree, name, (*identity, 1.0) if isinstance(identity, tuple) else identity, *bounds)
    tree.interface.new_socket(output, in_out="OUTPUT", socket_type=kind)


def group_node(journal: Journal, tree: NodeTree, name: str, fill: Callable[[NodeTree], None], neighbor: Node) -> Node:
    """Adds a node with Vibe Render's group `name` (see `owned_group`) to the left of `neighbor`, in a frame."""
    kind = {"ShaderNodeTree": "ShaderNodeGroup", "CompositorNodeTree": "CompositorNodeGroup"}[tree.bl_idname]
    inner = owned_group(journal, name, tree.bl_idname, fill)
    node = journal.node(tree, kind, inner.name)
    node.node_tree = inner
    dress(journal, tree, node, neighbor)
    return node


def dress(journal: Journal, tree: NodeTree, node: Node, neighbor: Node) -> None:
    """Colors an added node, places it to the left of `neighbor`, and puts it into a frame."""
    node.label, node.use_custom_color, node.color = node.name, True, COLOR
    frame = journal.node(tree, "NodeFrame", "Vibe Render")
    frame.label, frame.use_custom_color, frame.color = "Vibe Render", True, COLOR
    node.parent = frame
    node.location = (neighbor.location.x - node.width - 60.0, neighbor.location.y)


def group_nodes(tree: NodeTree | None, name: str) -> list[Node]:
    """The nodes of a tree that use Vibe Render's group `name`; empty without a tree."""
    nodes = tree.nodes if tree else ()
    return [n for n in nodes if n.type == "GROUP" and n.node_tree and n.node_tree.get(MARK) == name]


class Builder:
    """Fills a node group with nodes, from left to right."""

    def __init__(self, tree: NodeTree) -> None:
        self.tree = tree
        self.entry = tree.nodes.new("NodeGroupInput")
        self._column = 0

    def inputs(self, *names: str) -> list[NodeSocket]:
        """The group's inputs of these names, as outputs of the Group Input node."""
        return [self.entry.outputs[name] for name in names]

    def add(self, node: Node) -> Node:
        """Places a node to the right of the ones before."""
        self._column += 1
        node.location = (200.0 * self._column, 0.0)
        return node

    def node(self, kind: str, *operands: Any, operation: str = "", **inputs: Any) -> Node:
        """Adds a node; links or sets (see `put`) its first inputs to `operands`, and the inputs named in `inputs`."""
        node = self.add(self.tree.nodes.new(kind))
        if operation:
            node.operation = operation
        named = [(node.inputs[name], given) for name, given in inputs.items()]
        for target, given in [*zip(node.inputs, operands, strict=False), *named]:
            self.put(target, given)
        return node

    def put(self, target: NodeSocket, given: Any) -> None:
        """Links `given` to an input if it is a socket, otherwise sets the input's value to it."""
        if isinstance(given, NodeSocket):
            self.tree.links.new(given, target)
        else:
            target.default_value = given

    def math(self, operation: str, *operands: Any, clamp: bool = False) -> NodeSocket:
        """Adds a Math node; returns its result."""
        node = self.node("ShaderNodeMath", *operands, operation=operation)
        node.use_clamp = clamp
        return node.outputs[0]

    def vector(self, operation: str, *operands: Any, **inputs: Any) -> NodeSocket:
        """Adds a Vector Math node, which takes colors as vectors; returns its result."""
        node = self.node("ShaderNodeVectorMath", *operands, operation=operation, **inputs)
        return node.outputs["Value" if operation in {"DOT_PRODUCT", "LENGTH"} else "Vector"]

    def output(self, source: NodeSocket) -> None:
        """Adds the group's only output and links a socket to it."""
        node = self.add(self.tree.nodes.new("NodeGroupOutput"))
        self.tree.links.new(source, node.inputs[0])

    def output_with_alpha(self, color: NodeSocket, image: NodeSocket) -> None:
        """Adds the group's only output: a color with the alpha of an image."""
        alpha = self.node("CompositorNodeSeparateColor", Image=image).outputs["Alpha"]
        node = self.node("CompositorNodeSetAlpha", Image=color, Alpha=alpha)
        compat.set_option(node, "mode", "Type", "REPLACE_ALPHA", "Replace Alpha")
        self.output(node.outputs[0])
