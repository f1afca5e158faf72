# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds its way through the artist's node trees: which node shades a surface, and where a value really is."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
from bpy.types import Material, Node, NodeSocket, World

from ...core import compat

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
FOREIGN = {
    "ShaderNodeShaderToRGB": "Cycles does not know",
    "ShaderNodeEeveeSpecular": "Cycles does not know",
    "ShaderNodeScript": "only Cycles with Open Shading Language knows",
}
"""Nodes that a render on a CPU takes for absent, and what to say of them."""


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


def surface(material: Material) -> NodeInGroups | None:
    """The shader of a material's surface: the Principled BSDF if there is one, else another known one."""
    return _from_output(compat.node_tree(material), "ShaderNodeOutputMaterial", "Surface", tuple(ALIASES))


def background(world: World) -> NodeInGroups | None:
    """The Background node of a world."""
    return _from_output(
        compat.node_tree(world), "ShaderNodeOutputWorld", "Surface", ("ShaderNodeBackground",)
    )


@dataclass(frozen=True)
class Cutout:
    """How a Mix Shader lets a Transparent BSDF through.

    Attributes:
        share: How much of the surface is left, where that is one number.
        source: The output that computes the mix, where one does.
        inverted: Whether that output is the share of the Transparent BSDF.
    """

    share: float | None
    source: NodeSocket | None
    inverted: bool


def cutout(material: Material) -> Cutout | None:
    """The mix with a plain Transparent BSDF that a material's surface ends in, if it does."""
    mix = last_mix(material)
    if mix is None:
        return None
    sides = [[link.from_node.bl_idname for link in active_links(s)] for s in mix.node.inputs[1:3]]
    clear = [side == ["ShaderNodeBsdfTransparent"] for side in sides]
    if sum(clear) != 1:
        return None
    inverted = clear[1]
    socket, source = resolve(mix.node.inputs[0], mix.inside)
    if source is not None:
        return Cutout(None, source, inverted)
    share = min(max(float(socket.default_value), 0.0), 1.0)
    return Cutout(1 - share if inverted else share, None, inverted)


def last_mix(material: Material) -> NodeInGroups | None:
    """The Mix Shader that a material's surface ends in, reroutes and groups aside."""
    kinds = ("ShaderNodeMixShader", "ShaderNodeAddShader", *ALIASES)
    mix = _from_output(compat.node_tree(material), "ShaderNodeOutputMaterial", "Surface", kinds, nearest=True)
    return mix if mix and mix.node.bl_idname == "ShaderNodeMixShader" else None


def bumps(material: Material) -> bool:
    """Whether a material's Displacement is rendered, at least partly, as a change of its normals."""
    tree = compat.node_tree(material)
    output = tree.get_output_node("CYCLES") if tree else None
    return bool(output and active_links(output.inputs["Displacement"]) and compat.displaces_normals(material))


def world_volume(world: World) -> NodeInGroups | None:
    """The node of the artist's own fog: on the World Output's Volume."""
    kinds = ("ShaderNodeVolumePrincipled", "ShaderNodeVolumeScatter")
    return _from_output(compat.node_tree(world), "ShaderNodeOutputWorld", "Volume", kinds)


def environment(color: NodeSocket) -> NodeInGroups | None:
    """The environment texture that a background's color comes from."""
    return _search(color, (), ("ShaderNodeTexEnvironment",))


def _from_output(
    tree: bpy.types.NodeTree | None, output: str, entry: str, kinds: tuple[str, ...], nearest: bool = False
) -> NodeInGroups | None:
    """The first of some kinds of nodes behind an output's input; `nearest` searches for all kinds at once."""
    if tree is None:
        return None
    target = "CYCLES" if output == "ShaderNodeOutputMaterial" else "ALL"
    node = tree.get_output_node(target) or next((n for n in tree.nodes if n.bl_idname == output), None)
    if node is None or entry not in node.inputs:
        return None
    if nearest:
        return _search(node.inputs[entry], (), kinds)
    matches = (_search(node.inputs[entry], (), (kind,)) for kind in kinds)
    return next(filter(None, matches), None)


def _search(socket: NodeSocket, inside: tuple[Node, ...], kinds: tuple[str, ...]) -> NodeInGroups | None:
    """Depth first from an input against the links, into groups and out of them again."""
    for link in active_links(socket):
        node, exit_ = link.from_node, link.from_socket
        if node.bl_idname in kinds:
            return NodeInGroups(node, inside)
        if node.type == "GROUP" and node.node_tree:
            entry = next((s for s in _group_output(node) if s.identifier == exit_.identifier), None)
            match = entry and _search(entry, (*inside, node), kinds)
        elif node.type == "GROUP_INPUT":
            outer = (
                next((s for s in inside[-1].inputs if s.identifier == exit_.identifier), None)
                if inside
                else None
            )
            match = outer and _search(outer, inside[:-1], kinds)
        else:
            match = next(filter(None, (_search(s, inside, kinds) for s in node.inputs)), None)
        if match:
            return match
    return None


def _group_output(group: Node) -> list[NodeSocket]:
    outputs = [n for n in group.node_tree.nodes if n.type == "GROUP_OUTPUT"]
    outputs.sort(key=lambda n: not n.is_active_output)
    return list(outputs[0].inputs) if outputs else []


def active_links(socket: NodeSocket) -> list[bpy.types.NodeLink]:
    """The links into a socket that count in Cycles."""
    usable = (link for link in socket.links if link.is_valid and not link.is_muted)
    return [link for link in usable if not _is_foreign(link.from_node)]


def _is_foreign(node: Node) -> bool:
    scripts = node.bl_idname == "ShaderNodeScript" and any(s.cycles.shading_system for s in bpy.data.scenes)
    return node.bl_idname in FOREIGN and not scripts


def foreign(material: Material) -> list[Node]:
    """The nodes of a material, its groups included, that Cycles takes for absent."""
    tree, nodes = compat.node_tree(material), []
    trees = [tree] if tree else []
    for tree in trees:
        nodes += [n for n in tree.nodes if _is_foreign(n) and any(s.is_linked for s in n.outputs)]
        inner = (n.node_tree for n in tree.nodes if n.type == "GROUP" and n.node_tree)
        trees += [t for t in inner if t not in trees]
    return nodes


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
