# SPDX-License-Identifier: GPL-3.0-or-later
"""The nodes that shade surfaces and worlds, by what they call their inputs."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
from bpy.types import Material, Node, NodeSocket, World

from ...core import compat
from .trails import NodeEntry, active_links, group_output, is_foreign, same_socket

ALIASES: dict[str, dict[str, str]] = {
    "ShaderNodeBsdfPrincipled": {},
    "ShaderNodeBsdfDiffuse": {"Base Color": "Color"},
    "ShaderNodeBsdfGlossy": {"Base Color": "Color"},
    "ShaderNodeBsdfAnisotropic": {"Base Color": "Color"},
    "ShaderNodeBsdfMetallic": {"Base Color": "Base Color"},
    "ShaderNodeBsdfGlass": {"Base Color": "Color"},
    "ShaderNodeBsdfTranslucent": {"Base Color": "Color"},
    "ShaderNodeSubsurfaceScattering": {"Base Color": "Color"},
    "ShaderNodeBsdfToon": {"Base Color": "Color"},
    "ShaderNodeBsdfSheen": {"Sheen Tint": "Color", "Sheen Roughness": "Roughness"},
    "ShaderNodeBsdfHair": {"Base Color": "Color"},
    "ShaderNodeBsdfHairPrincipled": {"Base Color": "Color"},
    "ShaderNodeBsdfRefraction": {"Base Color": "Color"},
    "ShaderNodeEmission": {"Emission Color": "Color", "Emission Strength": "Strength"},
}
"""Surface shaders that can be worked with, and what they call the inputs of the Principled BSDF."""

# Oren-Nayar's roughness is another thing, and so are those of fabric, hair and cartoons.
_UNLIKE = {
    "ShaderNodeBsdfDiffuse": {"Roughness"},
    "ShaderNodeBsdfSheen": {"Roughness"},
    "ShaderNodeBsdfHairPrincipled": {"Roughness", "IOR", "Coat Weight", "Coat Roughness"},
}


@dataclass(frozen=True)
class NodeInGroups:
    """A node, and the group nodes that lead to it from the outermost tree inwards."""

    node: Node
    inside: tuple[Node, ...] = ()

    def input(self, name: str) -> NodeSocket | None:
        """The input that has the meaning of an input of the Principled BSDF."""
        kind = self.node.bl_idname
        if name in _UNLIKE.get(kind, ()):
            return None
        return self.node.inputs.get(ALIASES.get(kind, {}).get(name, name))

    def entry(self, name: str, alike: tuple[NodeSocket, ...] = ()) -> NodeEntry | None:
        """The same input, with the way to it and inputs that mean the same."""
        socket = self.input(name)
        return NodeEntry(socket, self.inside, alike) if socket else None


def first_background(world: World) -> NodeInGroups | None:
    """The Background node of a world."""
    return _from_output(compat.node_tree(world), "Surface", ("ShaderNodeBackground",))


def bumps_normals(material: Material) -> bool:
    """Whether a material's Displacement is rendered, at least partly, as a change of its normals."""
    tree = compat.node_tree(material)
    output = tree.get_output_node("CYCLES") if tree else None
    return bool(output and active_links(output.inputs["Displacement"]) and compat.displaces_normals(material))


def world_volume(world: World) -> NodeInGroups | None:
    """The node of the artist's own fog: on the World Output's Volume."""
    kinds = ("ShaderNodeVolumePrincipled", "ShaderNodeVolumeScatter")
    return _from_output(compat.node_tree(world), "Volume", kinds)


def environment(color: NodeSocket) -> NodeInGroups | None:
    """The environment texture that a background's color comes from."""
    return _search(color, (), ("ShaderNodeTexEnvironment",))


def asks_for_rays(color: NodeEntry) -> bool:
    """Whether a color is another for the camera than for other rays."""
    return _search(color.socket, color.inside, ("ShaderNodeLightPath",)) is not None


def _from_output(tree: bpy.types.NodeTree | None, entry: str, kinds: tuple[str, ...]) -> NodeInGroups | None:
    """The first of some kinds of nodes behind an input of a world's output."""
    if tree is None:
        return None
    output = "ShaderNodeOutputWorld"
    node = tree.get_output_node("ALL") or next((n for n in tree.nodes if n.bl_idname == output), None)
    if node is None or entry not in node.inputs:
        return None
    matches = (_search(node.inputs[entry], (), (kind,)) for kind in kinds)
    return next(filter(None, matches), None)


def _search(socket: NodeSocket, inside: tuple[Node, ...], kinds: tuple[str, ...]) -> NodeInGroups | None:
    """Depth first from an input against the links, into groups and out of them again."""
    for link in active_links(socket):
        node, exit_ = link.from_node, link.from_socket
        if node.bl_idname in kinds:
            return NodeInGroups(node, inside)
        if node.type == "GROUP" and node.node_tree:
            entry = same_socket(group_output(node), exit_)
            match = entry and _search(entry, (*inside, node), kinds)
        elif node.type == "GROUP_INPUT":
            outer = same_socket(inside[-1].inputs, exit_) if inside else None
            match = outer and _search(outer, inside[:-1], kinds)
        else:
            match = next(filter(None, (_search(s, inside, kinds) for s in node.inputs)), None)
        if match:
            return match
    return None


def foreign_nodes(material: Material) -> list[Node]:
    """The nodes of a material, its groups included, that Cycles takes for absent."""
    tree, nodes = compat.node_tree(material), []
    trees = [tree] if tree else []
    for tree in trees:
        nodes += [n for n in tree.nodes if is_foreign(n) and any(s.is_linked for s in n.outputs)]
        inner = (n.node_tree for n in tree.nodes if n.type == "GROUP" and n.node_tree)
        trees += [t for t in inner if t not in trees]
    return nodes
