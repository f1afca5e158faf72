# SPDX-License-Identifier: GPL-3.0-or-later
"""Follows links through the artist's node trees: through reroutes, into node groups and out of them again."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import bpy
from bpy.types import Node, NodeLink, NodeSocket

FOREIGN = {
    "ShaderNodeShaderToRGB": "Cycles does not know",
    "ShaderNodeEeveeSpecular": "Cycles does not know",
    "ShaderNodeScript": "only Cycles with Open Shading Language knows",
}
"""Nodes that a render on a CPU takes for absent, and what to say of them."""


@dataclass(frozen=True)
class NodeEntry:
    """An input of a node.

    Attributes:
        socket: The input.
        inside: The group nodes that lead to its node, from the outermost tree inwards.
        alike: Inputs that mean the same for the picture: the colors of shaders that are mixed.
    """

    socket: NodeSocket
    inside: tuple[Node, ...] = ()
    alike: tuple[NodeSocket, ...] = ()


@dataclass(frozen=True)
class ValueOrigin:
    """Where the value of an input comes from.

    Attributes:
        socket: The socket that holds the value; of a computed one, the input where the trail ends.
        source: The output that computes the value; None where none does.
        inside: The group nodes that lead to `socket` and `source`.
        targets: Of a value that comes through a link: the inputs of that tree that it may come to another way,
            for they all mean the same.
        feeds_others: Whether inputs that mean something else get the value too.
    """

    socket: NodeSocket
    source: NodeSocket | None
    inside: tuple[Node, ...]
    targets: tuple[NodeSocket, ...] = ()
    feeds_others: bool = False


def active_links(socket: NodeSocket) -> list[NodeLink]:
    """The links into a socket that count in Cycles."""
    usable = (link for link in socket.links if link.is_valid and not link.is_muted)
    return [link for link in usable if not is_foreign(link.from_node)]


def is_foreign(node: Node) -> bool:
    """Whether a render takes a node for absent."""
    scripts = node.bl_idname == "ShaderNodeScript" and any(s.cycles.shading_system for s in bpy.data.scenes)
    return node.bl_idname in FOREIGN and not scripts


def resolve(entry: NodeEntry) -> ValueOrigin:
    """Follows an input to where its value is set: out of groups to the group node's own input, to a Value or RGB node."""
    socket, inside = entry.socket, entry.inside
    alike = entry.alike or (socket,)
    last = socket  # the input whose link we follow; `socket` stays before the reroutes of this tree
    while links := active_links(last):
        source = links[0].from_socket
        node = source.node
        if node.type == "REROUTE" and active_links(node.inputs[0]):
            last = node.inputs[0]
        elif node.type == "GROUP_INPUT" and inside and (outer := same_socket(inside[-1].inputs, source)):
            socket, last, inside = outer, outer, inside[:-1]
        else:
            targets = tuple(link.to_socket for link in source.links if _means(link.to_socket, inside, alike))
            others = len(targets) < len(source.links)
            if node.type in {"VALUE", "RGB"}:
                return ValueOrigin(source, None, inside, targets or (socket,), others)
            return ValueOrigin(socket, source, inside, targets or (socket,), others)
    return ValueOrigin(last, None, inside)


def _means(socket: NodeSocket, inside: tuple[Node, ...], alike: Sequence[NodeSocket]) -> bool:
    """Whether all that an input feeds is in `alike`."""
    return all(end in alike for end in _ends(socket, inside))


def _ends(socket: NodeSocket, inside: tuple[Node, ...]) -> Iterator[NodeSocket]:
    """The inputs that an input's value goes to: itself, or those behind a reroute or inside a group."""
    node = socket.node
    onward: list[tuple[NodeSocket, tuple[Node, ...]]] = []
    if node.type == "REROUTE":
        onward = [(node.outputs[0], inside)]
    elif node.type == "GROUP" and node.node_tree:
        inputs = [n for n in node.node_tree.nodes if n.type == "GROUP_INPUT"]
        onward = [(s, (*inside, node)) for n in inputs if (s := same_socket(n.outputs, socket))]
    elif node.type == "GROUP_OUTPUT" and inside and (outer := same_socket(inside[-1].outputs, socket)):
        onward = [(outer, inside[:-1])]
    else:
        yield socket
    for output, where in onward:
        for link in (each for each in output.links if each.is_valid):
            yield from _ends(link.to_socket, where)


def giver(socket: NodeSocket, inside: tuple[Node, ...]) -> tuple[NodeSocket, tuple[Node, ...]] | None:
    """The output that an input gets its value from, and the groups around it; reroutes and groups are seen through."""
    for link in active_links(socket)[:1]:
        source = link.from_socket
        node = source.node
        if node.type == "REROUTE":
            return giver(node.inputs[0], inside)
        if node.mute:
            through = [each.from_socket for each in node.internal_links if each.to_socket == source]
            return giver(through[0], inside) if through else None
        if node.type == "GROUP" and node.node_tree:
            entry = same_socket(group_output(node), source)
            return giver(entry, (*inside, node)) if entry else None
        if node.type == "GROUP_INPUT":
            outer = same_socket(inside[-1].inputs, source) if inside else None
            return giver(outer, inside[:-1]) if outer else None
        return source, inside
    return None


def group_output(group: Node) -> list[NodeSocket]:
    """The inputs of the Group Output node that counts."""
    outputs = [n for n in group.node_tree.nodes if n.type == "GROUP_OUTPUT"]
    outputs.sort(key=lambda n: not n.is_active_output)
    return list(outputs[0].inputs) if outputs else []


def same_socket(sockets: Sequence[NodeSocket], socket: NodeSocket) -> NodeSocket | None:
    """The socket of that identifier."""
    return next((s for s in sockets if s.identifier == socket.identifier), None)
