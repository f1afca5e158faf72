# SPDX-License-Identifier: GPL-3.0-or-later
"""The artist's node trees: follows links through reroutes and groups, and finds nodes."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import bpy
from bpy.types import Material, Node, NodeLink, NodeSocket, World

from ...core import compat

FOREIGN = {
    "ShaderNodeShaderToRGB": "Cycles does not know",
    "ShaderNodeEeveeSpecular": "Cycles does not know",
    "ShaderNodeScript": "only Cycles with Open Shading Language knows",
}
"""Type of a node that a Cycles render on the CPU ignores -> the reason, for messages."""


@dataclass(frozen=True)
class SurfaceShader:
    """A surface shader, compared with the Principled BSDF, whose values are the defaults."""

    names: Mapping[str, str] = field(default_factory=dict)  # input of the Principled BSDF -> this shader's name for it
    stand_in: Mapping[str, tuple[float, ...]] = field(default_factory=dict)  # values of parameters that it lacks
    matter: str = "matte"  # layers of the same matter can together make the color of a body
    shows: float = 1.0  # share of its own color in what is seen; coats and glass show their surroundings
    unlike: Collection[str] = ()  # this shader's inputs with a Principled name and another meaning


_COLOR = {"Base Color": "Color"}
_EMISSION = {"Emission Color": "Color", "Emission Strength": "Strength"}
_SHEEN = {"Sheen Tint": "Color", "Sheen Roughness": "Roughness"}
_MATTE = {"roughness": (1.0,), "specular": (0.0,)}
_BLACK = {"base_color": (0.0, 0.0, 0.0), "specular": (0.0,)}
_MIRROR = {"metallic": (1.0,), "specular_tint": (1.0, 1.0, 1.0)}
_GLASS, _HAIR = {"transmission": (1.0,)}, {"roughness": (0.6,)}
_OF_HAIR = ("Roughness", "IOR", "Coat Weight", "Coat Roughness")
SHADERS = {
    "ShaderNodeBsdfPrincipled": SurfaceShader(),
    "ShaderNodeBsdfDiffuse": SurfaceShader(_COLOR, _MATTE, unlike=("Roughness",)),  # that of Oren-Nayar
    "ShaderNodeBsdfGlossy": SurfaceShader(_COLOR, _MIRROR, "metal", 0.5),
    "ShaderNodeBsdfAnisotropic": SurfaceShader(_COLOR, _MIRROR, "metal", 0.5),
    "ShaderNodeBsdfMetallic": SurfaceShader({}, {"metallic": (1.0,)}, "metal", 0.5),
    "ShaderNodeBsdfGlass": SurfaceShader(_COLOR, _GLASS, "glass", 0.6),
    "ShaderNodeBsdfTranslucent": SurfaceShader(_COLOR, _MATTE, shows=0.9),
    "ShaderNodeSubsurfaceScattering": SurfaceShader(_COLOR, _MATTE),
    "ShaderNodeBsdfToon": SurfaceShader(_COLOR, _MATTE),
    "ShaderNodeBsdfSheen": SurfaceShader(_SHEEN, _BLACK | {"sheen": (1.0,)}, shows=0.3, unlike=("Roughness",)),
    "ShaderNodeBsdfHair": SurfaceShader(_COLOR, _HAIR),
    "ShaderNodeBsdfHairPrincipled": SurfaceShader(_COLOR, _HAIR, unlike=_OF_HAIR),
    "ShaderNodeBsdfRefraction": SurfaceShader(_COLOR, _GLASS, "glass", 0.6),
    "ShaderNodeEmission": SurfaceShader(_EMISSION, _BLACK, "light", 0.5),
}
"""The supported surface shaders."""


@dataclass(frozen=True)
class NodeEntry:
    """An input of a node."""

    socket: NodeSocket
    inside: tuple[Node, ...] = ()  # the group nodes that lead to its node, from the outermost tree inwards
    alike: tuple[NodeSocket, ...] = ()  # inputs that have the same meaning, such as the colors of mixed shaders


@dataclass(frozen=True)
class ValueOrigin:
    """The place where the value of an input is stored or computed."""

    socket: NodeSocket  # the socket that stores the value; if nodes compute it, the last input that passes it on
    source: NodeSocket | None  # the output that computes the value; None for a stored value
    inside: tuple[Node, ...]  # the group nodes that lead to `socket` and `source`
    targets: tuple[NodeSocket, ...] = ()  # of a linked value: the inputs with the same meaning that get it
    feeds_others: bool = False  # whether inputs of another meaning get the value too


def active_links(socket: NodeSocket) -> list[NodeLink]:
    """The links into a socket that count in Cycles: valid, not muted, and not from a foreign node."""
    usable = (link for link in socket.links if link.is_valid and not link.is_muted)
    return [link for link in usable if not is_foreign(link.from_node)]


def is_foreign(node: Node) -> bool:
    """True if a Cycles render ignores a node, see `FOREIGN`."""
    scripts = node.bl_idname == "ShaderNodeScript" and any(s.cycles.shading_system for s in bpy.data.scenes)
    return node.bl_idname in FOREIGN and not scripts


def resolve(entry: NodeEntry) -> ValueOrigin:
    """The origin of an input's value: a group node's own input, a Value or RGB node, or an output that computes it."""
    socket, inside = entry.socket, entry.inside
    alike = entry.alike or (socket,)
    last = socket  # the input whose link is followed; `socket` does not go past the reroutes of this tree
    while links := active_links(last):
        source = links[0].from_socket
        node = source.node
        if node.type == "REROUTE" and active_links(node.inputs[0]):
            last = node.inputs[0]
        elif node.type == "GROUP_INPUT" and inside and (outer := same_socket(inside[-1].inputs, source)):
            socket, last, inside = outer, outer, inside[:-1]
        else:
            fed = [link.to_socket for link in source.links]
            targets = tuple(target for target in fed if all(end in alike for end in _ends(target, inside)))
            others = len(targets) < len(fed)
            if node.type in {"VALUE", "RGB"}:
                return ValueOrigin(source, None, inside, targets or (socket,), others)
            return ValueOrigin(socket, source, inside, targets or (socket,), others)
    return ValueOrigin(last, None, inside)


def distinct(entries: Iterable[NodeEntry | None]) -> list[NodeEntry]:
    """The inputs, without None; of several inputs whose values have the same origin, only the first."""
    found: dict[NodeSocket, NodeEntry] = {}
    for entry in filter(None, entries):
        origin = resolve(entry)
        found.setdefault(origin.source or origin.socket, entry)
    return list(found.values())


def _ends(socket: NodeSocket, inside: tuple[Node, ...]) -> Iterator[NodeSocket]:
    """Yields the inputs that use a socket's value: the socket itself, or inputs behind a reroute or inside a group."""
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


def source_output(socket: NodeSocket, inside: tuple[Node, ...]) -> tuple[NodeSocket, tuple[Node, ...]] | None:
    """(output that feeds an input, group nodes around the output), through reroutes and groups; None if not linked."""
    for link in active_links(socket)[:1]:
        source = link.from_socket
        node = source.node
        if node.type == "REROUTE":
            return source_output(node.inputs[0], inside)
        if node.mute:
            through = [each.from_socket for each in node.internal_links if each.to_socket == source]
            return source_output(through[0], inside) if through else None
        if node.type == "GROUP" and node.node_tree:
            entry = same_socket(group_output(node), source)
            return source_output(entry, (*inside, node)) if entry else None
        if node.type == "GROUP_INPUT":
            outer = same_socket(inside[-1].inputs, source) if inside else None
            return source_output(outer, inside[:-1]) if outer else None
        return source, inside
    return None


def group_output(group: Node) -> list[NodeSocket]:
    """The inputs of the active Group Output node of a group; empty without such a node."""
    outputs = [n for n in group.node_tree.nodes if n.type == "GROUP_OUTPUT"]
    outputs.sort(key=lambda n: not n.is_active_output)
    return list(outputs[0].inputs) if outputs else []


def same_socket(sockets: Sequence[NodeSocket], socket: NodeSocket) -> NodeSocket | None:
    """The socket in `sockets` that has the identifier of `socket`; None if there is none."""
    return next((s for s in sockets if s.identifier == socket.identifier), None)


@dataclass(frozen=True)
class NodeInGroups:
    """A node, and the group nodes that lead to it from the outermost tree inwards."""

    node: Node
    inside: tuple[Node, ...] = ()

    @property
    def shader(self) -> SurfaceShader:
        """The row of `SHADERS` for the node; a default one if it is not a supported shader."""
        return SHADERS.get(self.node.bl_idname, SurfaceShader())

    def input(self, name: str) -> NodeSocket | None:
        """The input with the meaning of the Principled BSDF's input `name`; None without one."""
        return None if name in self.shader.unlike else self.node.inputs.get(self.shader.names.get(name, name))

    def entry(self, name: str, alike: tuple[NodeSocket, ...] = ()) -> NodeEntry | None:
        """The result of `input` as an entry, with the groups around it; `alike`: inputs with the same meaning."""
        socket = self.input(name)
        return NodeEntry(socket, self.inside, alike) if socket else None


def world_volume(world: World | None) -> NodeInGroups | None:
    """The volume node of the artist's own fog, behind the World Output's Volume; None without one, or without a world."""
    output = compat.output_node(world)
    if output is None:
        return None
    entry = NodeEntry(output.inputs["Volume"])
    return search(entry, "ShaderNodeVolumePrincipled") or search(entry, "ShaderNodeVolumeScatter")


def search(entry: NodeEntry, kind: str) -> NodeInGroups | None:
    """The first node of the type `kind` behind an input, depth first, also inside groups; None without one."""
    given = source_output(entry.socket, entry.inside)
    if given is None:
        return None
    node, inside = given[0].node, given[1]
    if node.bl_idname == kind:
        return NodeInGroups(node, inside)
    return next(filter(None, (search(NodeEntry(s, inside), kind) for s in node.inputs)), None)


def foreign_nodes(material: Material) -> list[Node]:
    """The linked nodes of a material, its groups included, that Cycles ignores."""
    tree, nodes = compat.node_tree(material), []
    trees = [tree] if tree else []
    for tree in trees:
        nodes += [n for n in tree.nodes if is_foreign(n) and any(s.is_linked for s in n.outputs)]
        inner = (n.node_tree for n in tree.nodes if n.type == "GROUP" and n.node_tree)
        trees += [t for t in inner if t not in trees]
    return nodes
