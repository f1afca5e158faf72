# SPDX-License-Identifier: GPL-3.0-or-later
"""Mixed shaders as one Principled BSDF: the sum of their inputs, weighted by the measured factors of the mixes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from bpy.types import Material, Node

from ..core.schema_import import schema
from ..scene.nodes import inputs, layers
from ..scene.nodes.layers import TRANSPARENT, Layer
from ..scene.nodes.trails import ValueOrigin, active_links, resolve
from .textures import ExportedTexture

_HEAD_ON = 0.04  # reflectance at normal incidence for the default IOR of 1.5 and Specular IOR Level 0.5
_USUAL_BLEND = 0.5  # assumed for a Layer Weight node's computed Blend; its IOR is 1 / (1 - blend)


@dataclass(frozen=True)
class MeasuredChannel:
    """A measured computed input: its mean, (1,) or (3,), and its texture if it varies."""

    mean: np.ndarray
    picture: ExportedTexture | None = None

    @property
    def values(self) -> np.ndarray:
        """The texture's image, (h, w, C); the mean, (1, 1, C), if there is none."""
        return self.picture.image if self.picture else self.mean[None, None].astype(np.float32)


@dataclass
class Mixture:
    """The shaders of a material, with the computed factors of their mixes."""

    layers: list[Layer]  # all shaders
    # the distinct origins of computed factors; their channels are "mix0", "mix1" …
    factors: list[ValueOrigin] = field(default_factory=list)
    # the origins of its base colors; if there are several, the channels of computed ones are "color0", "color1" …
    colors: list[ValueOrigin] = field(default_factory=list)

    @classmethod
    def of(cls, material: Material) -> Mixture:
        """The mixture of a material."""
        mixture = cls(layers.layers(material))
        for side in (side for layer in mixture.layers for side in layer.sides):
            origin = resolve(side.factor)
            if origin.source and origin.source not in (known.source for known in mixture.factors):
                mixture.factors.append(origin)
        mixture.colors = [inputs.artists_origin(color) for color in layers.colors(material)]
        return mixture

    def cutout(self) -> tuple[ValueOrigin, bool] | None:
        """The factor of a last mix with a Transparent BSDF, if computed, and whether it is that BSDF's weight; else None."""
        clear = [layer for layer in self.layers if layer.kind == TRANSPARENT]
        if len(clear) != 1 or len(clear[0].sides) != 1:
            return None
        origin = resolve(clear[0].sides[0].factor)
        return (origin, clear[0].sides[0].second) if origin.source else None

    def channels(self) -> dict[str, ValueOrigin]:
        """The origins of the factors and colors that have to be measured, by channel."""
        channels = {f"mix{number}": origin for number, origin in enumerate(self.factors)}
        if len(self.colors) > 1:
            computed = ((n, origin) for n, origin in enumerate(self.colors) if origin.source)
            channels |= {f"color{number}": origin for number, origin in computed}
        return channels

    def share(self, layer: Layer, measured: Mapping[str, MeasuredChannel], coats: bool = False) -> np.ndarray:
        """A shader's weight in the mix, in [0, 1], (h, w, 1) or (1, 1, 1), from the measured values of `channels`.

        With `coats`, shaders mixed in by a Fresnel or Layer Weight node have no weight: that below keeps all of it.
        """
        total: np.ndarray = np.ones((1, 1, 1), np.float32)
        for side in layer.sides:
            source = resolve(side.factor).source
            numbers = [n for n, origin in enumerate(self.factors) if origin.source == source]
            channel = measured.get(f"mix{numbers[0]}") if source and numbers else None
            if coats and side.grazing:
                factor: np.ndarray = np.zeros((1, 1, 1), np.float32)
            elif channel:
                factor = np.clip(channel.values[..., :1], 0.0, 1.0)
            else:
                factor = np.full((1, 1, 1), side.share if side.second else 1.0 - side.share, np.float32)
            total = total * (factor if side.second else 1.0 - factor)
        return total

    def opacity(self, measured: Mapping[str, MeasuredChannel]) -> np.ndarray:
        """1 minus the weights of transparent shaders times the means of their colors: (h, w, 1) or (1, 1, 1)."""
        total: np.ndarray = np.ones((1, 1, 1), np.float32)
        for layer in self.layers:
            if layer.kind == TRANSPARENT and (layer.sides or len(self.layers) == 1):
                clear = float(np.mean(layer.shader.node.inputs["Color"].default_value[:3]))
                total = total - self.share(layer, measured) * clear
        return np.clip(total, 0.0, 1.0)

    def color(self, material: Material, measured: Mapping[str, MeasuredChannel]) -> np.ndarray:
        """The weighted mean of the base colors of `layers.body`, before Vibe Render's tint: (h, w, 3) or (1, 1, 3)."""
        total, weight = np.zeros((1, 1, 3), np.float32), np.full((1, 1, 1), 1e-6, np.float32)
        places = [each.source or each.socket for each in self.colors]
        for layer in layers.body(material):
            entry = layer.shader.entry("Base Color")
            assert entry
            origin = inputs.artists_origin(entry)
            place = origin.source or origin.socket
            channel = measured.get(f"color{places.index(place)}") if place in places else None
            if channel:
                color = channel.values
            else:
                color = np.array(origin.socket.default_value[:3], np.float32)[None, None]
            share = self.share(layer, measured, coats=True)
            total, weight = total + share * color, weight + share
        return (total / weight).astype(np.float32)

    def glow(self, measured: Mapping[str, MeasuredChannel]) -> np.ndarray | None:
        """An Emission node's part of the opacity, (h, w, 1) or (1, 1, 1); None if it is 1, or without a mixed Emission."""
        lights = [layer for layer in self.layers if layer.matter == "light"]
        if not lights or not lights[0].sides:
            return None
        share = self.share(lights[0], measured) / np.maximum(self.opacity(measured), 1e-3)
        return None if (share > 0.99).all() else share

    def values(self, base: Layer, measured: Mapping[str, MeasuredChannel]) -> dict[str, schema.Values]:
        """Inputs of a Principled BSDF that stand for the shaders mixed with `base`, the one with the base color."""
        shares = {layer.matter: 0.0 for layer in self.layers}
        for layer in self.layers:
            if layer.kind != TRANSPARENT:
                shares[layer.matter] += float(self.share(layer, measured, coats=True).mean())
        whole = max(sum(s for matter, s in shares.items() if matter != "light"), 1e-6)
        values: dict[str, schema.Values] = {}
        if shares.get("glass", 0.0) > 0.0 and base.matter != "light":
            values["transmission"] = (shares["glass"] / whole,)
        gloss = layers.glossy_layer(self.layers, base)
        if base.matter == "metal":
            values["metallic"] = (shares["metal"] / whole,)
            coat = layers.lacquer_over(self.layers, base)
            if coat:  # a glossy shader that a Fresnel or Layer Weight node lays over this metal
                strongest, _, roughness = _gloss(coat)
                values |= {"coat": (min(strongest, 1.0),), "coat_roughness": (roughness,)}
        elif gloss and base.matter == "matte":
            # The dielectric layer that is most like the glossy shader: a weight f of a color c becomes the reflectance f·c
            # at normal incidence; a Fresnel or Layer Weight node gives an IOR.
            strongest, tinge, roughness = _gloss(gloss)
            values |= {"roughness": (roughness,), "specular_tint": tinge}
            if node := gloss.sides[-1].grazing:
                values |= {"specular": (0.5 * strongest,), "ior": (_ior(node),)}
            else:
                weight = min(max(float(self.share(gloss, measured).mean()), 0.0), 1.0)
                values["specular"] = (weight * strongest * 0.5 / _HEAD_ON,)
        return values

    def coat_ior(self, base: Layer) -> float | None:
        """The IOR of a lacquer: a glossy shader that a Fresnel or Layer Weight node lays over a metal; None without one."""
        coat = layers.lacquer_over(self.layers, base)
        node = coat.sides[-1].grazing if coat else None
        return _ior(node) if node else None


def _gloss(layer: Layer) -> tuple[float, schema.Values, float]:
    """The strongest component of a glossy shader's color, the color divided by it, and the roughness."""
    color, rough = layer.shader.input("Base Color"), layer.shader.input("Roughness")
    assert color
    tinge = (0.8, 0.8, 0.8) if active_links(color) else tuple(map(float, color.default_value[:3]))
    strongest = max(*tinge, 1e-6)
    known = rough is not None and not active_links(rough)
    roughness = float(rough.default_value) if rough is not None and known else 0.3
    return strongest, tuple(c / strongest for c in tinge), roughness


def _ior(node: Node) -> float:
    """The IOR of a Fresnel or Layer Weight node."""
    if node.bl_idname == "ShaderNodeFresnel":
        return float(node.inputs["IOR"].default_value)
    linked = active_links(node.inputs["Blend"])
    blend = _USUAL_BLEND if linked else float(node.inputs["Blend"].default_value)
    return 1.0 / max(1.0 - min(blend, 0.9), 0.1)
