# SPDX-License-Identifier: GPL-3.0-or-later
"""Effects of a light's nodes on its power and color: Emission, Blackbody, Light Falloff."""

from __future__ import annotations

from bpy.types import Light, Node, NodeSocket

from ...core import compat
from .trails import NodeEntry, ValueOrigin, resolve, source_output


def kelvin(light: Light) -> NodeEntry | None:
    """The Temperature input of the Blackbody node that colors a light; None without one, or if it is computed."""
    color = _origin(light, "Color")
    if color is None or color.source is None or color.source.node.bl_idname != "ShaderNodeBlackbody":
        return None
    entry = NodeEntry(color.source.node.inputs["Temperature"], color.inside)
    return None if resolve(entry).source else entry


def factor(light: Light) -> tuple[float, float, float] | None:
    """(red, green, blue) by which a light's nodes multiply its light, without a Blackbody; None if they do more."""
    if compat.node_tree(light) is None:
        return 1.0, 1.0, 1.0
    color, strength = _origin(light, "Color"), _origin(light, "Strength")
    if color is None or strength is None:
        return None
    if color.source and not kelvin(light):
        return None
    if strength.source:
        # The quadratic output of a Light Falloff without smoothing passes its strength on unchanged.
        node = strength.source.node
        if node.bl_idname != "ShaderNodeLightFalloff" or strength.source.name != "Quadratic":
            return None
        smooth = node.inputs["Smooth"]
        strength = resolve(NodeEntry(node.inputs["Strength"], strength.inside))
        if strength.source or smooth.is_linked or smooth.default_value != 0.0:
            return None
    level = float(strength.socket.default_value)
    red, green, blue = (1.0, 1.0, 1.0) if color.source else color.socket.default_value[:3]
    return red * level, green * level, blue * level


def whiten(light: Light) -> None:
    """Replaces the color from a Blackbody node by white, in place: `light` has to be a copy of the artist's light."""
    given = _emission(light)
    if given and not given[1] and kelvin(light):  # not in a group, which others may use
        socket = given[0].node.inputs["Color"]
        light.node_tree.links.remove(socket.links[0])
        socket.default_value = (1.0, 1.0, 1.0, 1.0)


def flatten(light: Light) -> None:
    """Makes a light with nodes shine as if it had none, in place: `light` has to be a copy of the artist's light."""
    tree = compat.node_tree(light)
    assert tree
    plain = tree.nodes.new("ShaderNodeEmission")
    plain.inputs["Strength"].default_value = 1.0
    plain.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    output = tree.get_output_node("CYCLES") or tree.nodes.new("ShaderNodeOutputLight")
    tree.links.new(plain.outputs[0], output.inputs["Surface"])


def _origin(light: Light, name: str) -> ValueOrigin | None:
    given = _emission(light)
    return resolve(NodeEntry(given[0].node.inputs[name], given[1])) if given else None


def _emission(light: Light) -> tuple[NodeSocket, tuple[Node, ...]] | None:
    """(output of the Emission node behind a light's output, group nodes around the Emission node); None without one."""
    output = compat.output_node(light)
    given = source_output(output.inputs["Surface"], ()) if output else None
    return given if given and given[0].node.bl_idname == "ShaderNodeEmission" else None
