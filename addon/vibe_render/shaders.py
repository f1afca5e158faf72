# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds its way through the artist's node trees: which node shades a surface, and where a value really is."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
from bpy.types import Material, Node, NodeSocket, World

from . import compat

ALIASES: dict[str, dict[str, str]] = {
    "ShaderNodeBsdfPrincipled": {},
    "ShaderNodeBsdfDiffuse": {"Base Color": "Color"},
    "ShaderNodeBsdfGlossy": {"Base Color": "Color"},
    "ShaderNodeBsdfAnisotropic": {"Base Color": "Color"},
    "ShaderNodeBsdfMetallic": {"Base Color": "Base Color"},
    "ShaderNodeBsdfGlass": {"Base Color": "Color"},
    "ShaderNodeBsdfTranslucent": {"Base Color": "Color"},
    "ShaderNodeSubsurfaceScattering": {"Base Color": "Color"},
    "ShaderNodeEmission": {"Emission Color": "Color", "Emission Strength": "Strength"},
}
"""Surface shaders that can be worked with, and what they call the inputs of the Principled BSDF."""

_UNLIKE = {"ShaderNodeBsdfDiffuse": {"Roughness"}}  # Oren-Nayar's roughness is another thing


@dataclass(frozen=True)
class Found:
    """A node, and the group nodes that lead to it from the outermost tree inwards."""

    node: Node
    inside: tuple[Node, ...] = ()

    def input(self, name: str) -> NodeSocket | None:
        """The input that has the meaning of an input of the Principled BSDF."""
        kind = self.node.bl_idname
        if name in _UNLIKE.get(kind, ()):
            return None
        return self.node.inputs.get(ALIASES.get(kind, {}).get(name, name))


def surface(material: Material) -> Found | None:
    """The shader of a material's surface: the Principled BSDF if there is one, else another known one."""
    return _from_output(compat.node_tree(material), "ShaderNodeOutputMaterial", "Surface", tuple(ALIASES))


def background(world: World) -> Found | None:
    """The Background node of a world."""
    return _from_output(
        compat.node_tree(world), "ShaderNodeOutputWorld", "Surface", ("ShaderNodeBackground",)
    )


def world_volume(world: World) -> Found | None:
    """The node of the artist's own fog: on the World Output's Volume."""
    kinds = ("ShaderNodeVolumePrincipled", "ShaderNodeVolumeScatter")
    return _from_output(compat.node_tree(world), "ShaderNodeOutputWorld", "Volume", kinds)


def environment(color: NodeSocket) -> Found | None:
    """The environment texture that a background's color comes from."""
    return _search(color, (), ("ShaderNodeTexEnvironment",))


def _from_output(
    tree: bpy.types.NodeTree | None, output: str, entry: str, kinds: tuple[str, ...]
) -> Found | None:
    if tree is None:
        return None
    target = "CYCLES" if output == "ShaderNodeOutputMaterial" else "ALL"
    node = tree.get_output_node(target) or next((n for n in tree.nodes if n.bl_idname == output), None)
    if node is None or entry not in node.inputs:
        return None
    found = (_search(node.inputs[entry], (), (kind,)) for kind in kinds)
    return next(filter(None, found), None)


def _search(socket: NodeSocket, inside: tuple[Node, ...], kinds: tuple[str, ...]) -> Found | None:
    """Depth first from an input against the links, into groups and out of them again."""
    for link in active_links(socket):
        node, exit_ = link.from_node, link.from_socket
        if node.bl_idname in kinds:
            return Found(node, inside)
        if node.type == "GROUP" and node.node_tree:
            entry = next((s for s in _group_output(node) if s.identifier == exit_.identifier), None)
            found = entry and _search(entry, (*inside, node), kinds)
        elif node.type == "GROUP_INPUT":
            outer = (
                next((s for s in inside[-1].inputs if s.identifier == exit_.identifier), None)
                if inside
                else None
            )
            found = outer and _search(outer, inside[:-1], kinds)
        else:
            found = next(filter(None, (_search(s, inside, kinds) for s in node.inputs)), None)
        if found:
            return found
    return None


def _group_output(group: Node) -> list[NodeSocket]:
    outputs = [n for n in group.node_tree.nodes if n.type == "GROUP_OUTPUT"]
    outputs.sort(key=lambda n: not n.is_active_output)
    return list(outputs[0].inputs) if outputs else []


def active_links(socket: NodeSocket) -> list[bpy.types.NodeLink]:
    """The links into a socket that count."""
    return [link for link in socket.links if link.is_valid and not link.is_muted]


def resolve(socket: NodeSocket, inside: tuple[Node, ...]) -> tuple[NodeSocket, NodeSocket | None]:
    """Follows an input to where its value is set.

    Through reroutes, out of groups to the group node's own input, and to a Value or RGB node that
    nothing else uses.

    Returns:
        The socket that holds the value, and None; or, where the value is computed, the socket where
        the trail ends and the output that computes it.
    """
    links = active_links(socket)
    if not links:
        return socket, None
    source = links[0].from_socket
    node = source.node
    if node.type == "REROUTE" and active_links(node.inputs[0]):
        end, computed = resolve(node.inputs[0], inside)
        return (socket, computed) if computed else (end, None)
    if node.type == "GROUP_INPUT" and inside:
        outer = next((s for s in inside[-1].inputs if s.identifier == source.identifier), None)
        return resolve(outer, inside[:-1]) if outer else (socket, source)
    if node.type in {"VALUE", "RGB"} and len(source.links) == 1:
        return source, None
    return socket, source
