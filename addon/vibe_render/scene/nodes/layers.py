# SPDX-License-Identifier: GPL-3.0-or-later
"""The shaders that a surface is mixed from: how visible each is, and which of them holds a value."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import prod

from bpy.types import Material, Node, NodeSocket

from ...core import compat
from .trails import SHADERS, NodeEntry, NodeInGroups, distinct, resolve, source_output

TRANSPARENT = "ShaderNodeBsdfTransparent"
BACKGROUND = "ShaderNodeBackground"
_MIX, _ADD, EMISSION = "ShaderNodeMixShader", "ShaderNodeAddShader", "ShaderNodeEmission"
_GRAZING = {"Fresnel": 0.1, "Facing": 0.3}
"""The mean share of a mix's second shader where the factor is a Fresnel or Layer Weight output, high only at edges."""
_COMPUTED_COLOR, _COMPUTED_STRENGTH = 0.5, 1.0  # assumed for emission that nodes compute


@dataclass(frozen=True)
class MixSide:
    """One side of a Mix Shader: the factor, and whether this is the second side, whose weight is the factor."""

    factor: NodeEntry
    second: bool

    @property
    def grazing(self) -> Node | None:
        """The Fresnel or Layer Weight node that gives the factor; None without one."""
        source = resolve(self.factor).source
        kinds = ("ShaderNodeFresnel", "ShaderNodeLayerWeight")
        return source.node if source and source.node.bl_idname in kinds else None

    @property
    def share(self) -> float:
        """The side's weight: exact if the factor is a constant number, otherwise a typical value."""
        origin = resolve(self.factor)
        if origin.source is None:
            factor = min(max(float(origin.socket.default_value), 0.0), 1.0)
        elif origin.source.node.bl_idname == "ShaderNodeLightPath":
            factor = float(origin.source.name == "Is Camera Ray")  # the camera decides what is seen
        elif self.grazing:
            factor = _GRAZING["Facing" if origin.source.name == "Facing" else "Fresnel"]
        else:
            factor = 0.5
        return factor if self.second else 1.0 - factor


@dataclass(frozen=True)
class Layer:
    """A shader of a surface, and the sides of the Mix Shaders that it comes through, from the output inwards."""

    shader: NodeInGroups
    sides: tuple[MixSide, ...] = ()

    @property
    def kind(self) -> str:
        """Blender's name of the shader's type."""
        return self.shader.node.bl_idname

    @property
    def share(self) -> float:
        """The approximate weight of the shader in the surface, in [0, 1]."""
        return prod(side.share for side in self.sides)

    @property
    def matter(self) -> str:
        """The kind of matter: "matte", "metal", "glass" or "light"."""
        return self.shader.shader.matter


def layers(material: Material) -> list[Layer]:
    """All shaders behind the Surface of the output node that Cycles uses, transparent ones included."""
    output = compat.output_node(material)
    return list(behind(output.inputs["Surface"])) if output else []


def behind(socket: NodeSocket, inside: tuple[Node, ...] = (), sides: tuple[MixSide, ...] = ()) -> Iterator[Layer]:
    """Yields the shaders behind an input, in groups too; `inside` and `sides`: groups and mixes around the input."""
    given = source_output(socket, inside)
    if given is None:
        return
    node, inside = given[0].node, given[1]
    if node.bl_idname == _MIX:
        for number, second in ((1, False), (2, True)):
            side = MixSide(NodeEntry(node.inputs[0], inside), second)
            yield from behind(node.inputs[number], inside, (*sides, side))
    elif node.bl_idname == _ADD:
        for entry in node.inputs:
            yield from behind(entry, inside, sides)
    elif node.bl_idname in SHADERS or node.bl_idname in (TRANSPARENT, BACKGROUND):
        yield Layer(NodeInGroups(node, inside), sides)


def by_prominence(material: Material) -> list[Layer]:
    """The visible shaders by decreasing weight in the visible color; a vibe's changes do not affect the order."""
    shown = [layer for layer in layers(material) if layer.kind != TRANSPARENT]
    visible = [layer for layer in shown if layer.share > 0.0]
    return sorted(visible or shown, key=lambda layer: -layer.share * layer.shader.shader.shows)


def entry(material: Material, name: str) -> NodeEntry | None:
    """The shader input that decides a value of a surface, by its name on the Principled BSDF; None without one."""
    # That of the most prominent shader that has it: the roughness of a Diffuse BSDF with a glossy coat is the coat's.
    shown = by_prominence(material)
    if name.startswith("Emission"):  # an Emission node comes first
        shown.sort(key=lambda layer: layer.kind != EMISSION)
    owners = [layer for layer in shown if layer.shader.input(name)]
    if not owners:
        return None
    alike = tuple(s for layer in owners if (s := layer.shader.input(name)))
    return owners[0].shader.entry(name, alike)


def body(material: Material) -> list[Layer]:
    """The shaders that make a material's color: the most prominent one, and others of its matter with enough weight."""
    shown = [layer for layer in by_prominence(material) if layer.shader.input("Base Color")]
    if not shown:
        return []
    least, matter = 0.3 * shown[0].share, shown[0].matter  # a shader with a smaller share is an accent
    return [layer for layer in shown if layer.matter == matter and layer.share >= least]


def colors(material: Material) -> list[NodeEntry]:
    """The inputs with a material's color, one for each source; several if colors are mixed, empty without a color."""
    first = entry(material, "Base Color")
    if first is None:
        return []
    return distinct(layer.shader.entry("Base Color", first.alike) for layer in body(material))


def glossy_layer(every: list[Layer], base: Layer) -> Layer | None:
    """The reflective shader among `every` that is mixed with `base`, the shader with the color; None without one."""
    return next((x for x in every if x.matter == "metal" and x != base and x.sides), None)


def lacquer_over(every: list[Layer], base: Layer) -> Layer | None:
    """The lacquer over a metal `base`: a reflective shader, mixed by Fresnel or Layer Weight; None without one."""
    over = glossy_layer(every, base) if base.matter == "metal" else None
    return over if over and over.sides[-1].grazing else None


def lacquer_entry(material: Material, name: str) -> NodeEntry | None:
    """The input `name` of the lacquer over a metal, by its name on the Principled BSDF; None without a lacquer."""
    shown = body(material)
    coat = lacquer_over(layers(material), shown[0]) if shown else None
    return coat.shader.entry(name) if coat else None


def emitted_radiance(material: Material) -> float:
    """The approximate radiance that a surface emits, in its strongest color component; 0 if it emits none."""
    total = 0.0
    for layer in layers(material):
        color, strength = layer.shader.entry("Emission Color"), layer.shader.entry("Emission Strength")
        if color and strength:
            hue, factor = resolve(color), resolve(strength)
            strongest = _COMPUTED_COLOR if hue.source else max(hue.socket.default_value[:3])
            power = _COMPUTED_STRENGTH if factor.source else factor.socket.default_value
            total += layer.share * max(strongest * power, 0.0)
    return total
