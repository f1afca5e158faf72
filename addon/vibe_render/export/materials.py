# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials as the engine sees them: every surface as a Principled BSDF, exact or approximated.

For mixed shaders, it is a mean of their inputs, weighted by the measured factors of the Mix Shaders.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from bpy.types import Material, Node

from ..core import compat, rendered
from ..core.schema_import import schema
from ..scene.nodes import inputs, layers, trails
from ..scene.nodes.layers import TRANSPARENT, Layer
from ..scene.nodes.trails import FOREIGN, ValueOrigin, active_links, resolve
from .textures import ExportedTexture, uv_mapping

BLACK: dict[str, tuple[float, ...]] = {"base_color": (0.0, 0.0, 0.0), "specular": (0.0,), "roughness": (1.0,)}
CONSTANTS = {
    "coat_ior": "Coat IOR",
    "coat_tint": "Coat Tint",
    "sheen_roughness": "Sheen Roughness",
    "sheen_tint": "Sheen Tint",
    "diffuse_roughness": "Diffuse Roughness",
    "anisotropic": "Anisotropic",
    "subsurface": "Subsurface Weight",
    "thin_film": "Thin Film Thickness",
}
_PARAMETERS = {p.name: p for p in schema.PARAMETERS if p.group == "material"}
DEFAULTS = {
    name: (_PARAMETERS[name].default,) * _PARAMETERS[name].components
    for name in ("base_color", "emission", "emission_color", "roughness")
}
COMPUTED = {"alpha": "Alpha", "normal": "Normal"} | {
    name: parameter.blender.removeprefix("Principled BSDF > ")
    for name, parameter in _PARAMETERS.items()
    if name not in ("ior", "tint", "recolor")
}
"""Inputs that nodes may compute -> names of their sockets on the Principled BSDF."""
UNIFORM = {"specular", "specular_tint", "coat_roughness", "sheen"}
"""Inputs of `COMPUTED` for which the engine takes only the mean, no texture."""

PRINCIPLED = "ShaderNodeBsdfPrincipled"
COLORS = ("base_color", "emission_color", "specular_tint")
_TINTED = ("base_color", "emission_color", "emission")  # computed inputs that a parameter multiplies
NO_MATERIAL = "(no material)"  # name of the entry for faces without a material


@dataclass(frozen=True)
class MeasuredChannel:
    """Measured values of an input that nodes compute: the mean, (1,) or (3,), and a texture if they vary."""

    mean: np.ndarray
    picture: ExportedTexture | None = None

    @property
    def values(self) -> np.ndarray:
        """The texture's image, (h, w, C); the mean, (1, 1, C), if there is none."""
        return self.picture.image if self.picture else self.mean[None, None].astype(np.float32)


@dataclass
class Mixture:
    """The shaders of a material, with the mix factors and base colors that nodes compute."""

    material: Material
    measured: Mapping[str, MeasuredChannel]  # the measured values of `channels`; empty before they are measured
    layers: list[Layer]  # all shaders
    # the distinct origins of computed factors; their channels are "mix0", "mix1" …
    factors: list[ValueOrigin] = field(default_factory=list)
    # the origins of its base colors; if there are several, the channels of computed ones are "color0", "color1" …
    colors: list[ValueOrigin] = field(default_factory=list)

    @classmethod
    def of(cls, material: Material, measured: Mapping[str, MeasuredChannel]) -> Mixture:
        """The mixture of a material."""
        mixture = cls(material, measured, layers.layers(material))
        for side in (side for layer in mixture.layers for side in layer.sides):
            origin = resolve(side.factor)
            if origin.source and origin.source not in (known.source for known in mixture.factors):
                mixture.factors.append(origin)
        mixture.colors = [inputs.artists_origin(color) for color in layers.colors(material)]
        return mixture

    def cutout(self) -> tuple[ValueOrigin, bool] | None:
        """The computed factor of the mix with the only Transparent BSDF, and True if the factor is that BSDF's weight.

        None without such a mix at the output, or if nodes do not compute its factor.
        """
        clear = [layer for layer in self.layers if layer.kind == TRANSPARENT]
        if len(clear) != 1 or len(clear[0].sides) != 1:
            return None
        origin = resolve(clear[0].sides[0].factor)
        return (origin, clear[0].sides[0].second) if origin.source else None

    def channels(self) -> dict[str, ValueOrigin]:
        """Channel ("mix0", "color0" …) -> origin of the factor or color that has to be measured."""
        channels = {f"mix{number}": origin for number, origin in enumerate(self.factors)}
        if len(self.colors) > 1:
            computed = ((n, origin) for n, origin in enumerate(self.colors) if origin.source)
            channels |= {f"color{number}": origin for number, origin in computed}
        return channels

    def share(self, layer: Layer, coats: bool = False) -> np.ndarray:
        """A shader's weight in the mix, in [0, 1]: (h, w, 1) or (1, 1, 1).

        With `coats`, a shader that a Fresnel or Layer Weight node mixes in counts as a coat: it has weight 0, and the
        shader below it keeps its full weight.
        """
        total: np.ndarray = np.ones((1, 1, 1), np.float32)
        for side in layer.sides:
            source = resolve(side.factor).source
            numbers = [n for n, origin in enumerate(self.factors) if origin.source == source]
            channel = self.measured.get(f"mix{numbers[0]}") if source and numbers else None
            if coats and side.grazing:
                factor: np.ndarray = np.zeros((1, 1, 1), np.float32)
            elif channel:
                factor = np.clip(channel.values[..., :1], 0.0, 1.0)
            else:
                factor = np.full((1, 1, 1), side.share if side.second else 1.0 - side.share, np.float32)
            total = total * (factor if side.second else 1.0 - factor)
        return total

    def opacity(self) -> np.ndarray:
        """Opacity, (h, w, 1) or (1, 1, 1): 1 minus each Transparent BSDF's weight times the mean of its color."""
        total: np.ndarray = np.ones((1, 1, 1), np.float32)
        for layer in self.layers:
            if layer.kind == TRANSPARENT and (layer.sides or len(self.layers) == 1):
                clear = float(np.mean(layer.shader.node.inputs["Color"].default_value[:3]))
                total = total - self.share(layer) * clear
        return np.clip(total, 0.0, 1.0)

    def color(self) -> np.ndarray:
        """Base color, (h, w, 3) or (1, 1, 3), before Vibe Render's tint: the weighted mean over `layers.body`."""
        total, weight = np.zeros((1, 1, 3), np.float32), np.full((1, 1, 1), 1e-6, np.float32)
        places = [each.source or each.socket for each in self.colors]
        for layer in layers.body(self.material):
            entry = layer.shader.entry("Base Color")
            assert entry
            origin = inputs.artists_origin(entry)
            place = origin.source or origin.socket
            channel = self.measured.get(f"color{places.index(place)}") if place in places else None
            if channel:
                color = channel.values
            else:
                color = np.array(origin.socket.default_value[:3], np.float32)[None, None]
            share = self.share(layer, coats=True)
            total, weight = total + share * color, weight + share
        return (total / weight).astype(np.float32)

    def glow(self) -> np.ndarray | None:
        """The Emission's share of the opacity, (h, w, 1) or (1, 1, 1); None if it is 1, or no Emission is mixed in."""
        lights = [layer for layer in self.layers if layer.matter == "light"]
        if not lights or not lights[0].sides:
            return None
        share = self.share(lights[0]) / np.maximum(self.opacity(), 1e-3)
        return None if (share > 0.99).all() else share

    def values(self, base: Layer) -> dict[str, schema.Values]:
        """Values of the Principled inputs that stand for shaders mixed with `base`, the shader with the base color."""
        shares = {layer.matter: 0.0 for layer in self.layers}
        for layer in self.layers:
            if layer.kind != TRANSPARENT:
                shares[layer.matter] += float(self.share(layer, coats=True).mean())
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
            # The dielectric layer most like the glossy shader: a weight f of a color c becomes the reflectance f·c at normal
            # incidence (0.04 for a Specular IOR Level of 0.5). A Fresnel or Layer Weight node gives an IOR.
            strongest, tinge, roughness = _gloss(gloss)
            values |= {"roughness": (roughness,), "specular_tint": tinge}
            if node := gloss.sides[-1].grazing:
                values |= {"specular": (0.5 * strongest,), "ior": (_ior(node),)}
            else:
                weight = min(max(float(self.share(gloss).mean()), 0.0), 1.0)
                values["specular"] = (weight * strongest * 0.5 / 0.04,)
        return values


def _gloss(layer: Layer) -> tuple[float, schema.Values, float]:
    """The greatest component of a glossy shader's color, the color divided by this component, and the roughness."""
    color, rough = layer.shader.input("Base Color"), layer.shader.input("Roughness")
    assert color
    tinge = (0.8, 0.8, 0.8) if active_links(color) else tuple(map(float, color.default_value[:3]))
    strongest = max(*tinge, 1e-6)
    roughness = 0.3 if rough is None or active_links(rough) else float(rough.default_value)
    return strongest, tuple(c / strongest for c in tinge), roughness


def _ior(node: Node) -> float:
    """The IOR of a Fresnel or Layer Weight node."""
    if node.bl_idname == "ShaderNodeFresnel":
        return float(node.inputs["IOR"].default_value)
    entry = node.inputs["Blend"]  # that of a Layer Weight; if it is computed, 0.5 is assumed
    blend = 0.5 if active_links(entry) else float(entry.default_value)
    return 1.0 / max(1.0 - min(blend, 0.9), 0.1)


@dataclass
class ExportedMaterial:
    """A material as the engine gets it: a Principled BSDF."""

    row: dict[str, Any]  # its entry in scene.json, without role and textures
    # textures by input: "base_color", "alpha", "normal" or the name of a parameter; "far" is the base color of a flat
    # surface also outside the camera's view, for mirrors
    pictures: dict[str, ExportedTexture] = field(default_factory=dict)
    # values that bindings cannot read: those that stand for other shaders, and means of computed inputs
    values: dict[str, schema.Values] = field(default_factory=dict)
    reason: str = ""  # the reason why those values are locked
    notes: list[str] = field(default_factory=list)  # approximations, each a sentence without its period


def uv_of(material: Material) -> tuple[str, np.ndarray]:
    """The UV map of a material's base color or alpha texture ("" for the active one), and its 3x3 mapping matrix."""
    origins = computed_inputs(material)
    origin = origins.get("base_color") or origins.get("alpha")
    return uv_mapping(origin.source if origin else None)


def computed_inputs(material: Material | None) -> dict[str, ValueOrigin | None]:
    """Input -> origin of its value before Vibe Render's tint, for the inputs of a material that nodes compute.

    Inputs are those of `COMPUTED` and the channels of `Mixture`. The origin of "normal" is None if Displacement makes it.
    """
    if material is None or not layers.by_prominence(material):
        return {}
    mixture = Mixture.of(material, {})
    entries = {name: layers.entry(material, socket) for name, socket in COMPUTED.items()}
    outputs: dict[str, ValueOrigin | None] = dict(mixture.channels())
    outputs |= {name: o for name, each in entries.items() if each and (o := inputs.artists_origin(each)).source}
    outputs.pop("base_color", None)
    if len(mixture.colors) == 1 and mixture.colors[0].source:
        outputs["base_color"] = mixture.colors[0]
    if cut := mixture.cutout():
        outputs["alpha"] = cut[0]
    if material.displacement_method != "DISPLACEMENT" and "normal" not in outputs:  # rendered as bump, at least partly
        output = compat.output_node(material)
        if output and active_links(output.inputs["Displacement"]):
            outputs["normal"] = None
    return outputs


def export_material(material: Material | None, measured: Mapping[str, MeasuredChannel]) -> ExportedMaterial:
    """A material for the engine (None: faces without one); `measured`: the values of its `computed_inputs`."""
    if material is None:
        values = {**DEFAULTS, **trails.SHADERS["ShaderNodeBsdfDiffuse"].stand_in}
        return ExportedMaterial(_row(NO_MATERIAL), {}, values, "it has no material")
    if compat.node_tree(material) is None:
        values = {"metallic": (material.metallic,), "roughness": (material.roughness,)}
        return ExportedMaterial(_row(material.name_full), {}, values, "its nodes are off")
    mixture, shown = Mixture.of(material, measured), layers.by_prominence(material)
    labels = {node.bl_idname: node.bl_label for node in trails.foreign_nodes(material)}
    notes = [f"{label}, which {FOREIGN[kind]}, is left out" for kind, label in labels.items()]
    if not shown and mixture.layers:
        clear = ExportedMaterial(_row(material.name_full), {}, {**DEFAULTS, **BLACK})
        clear.row["alpha"], clear.reason = float(mixture.opacity().mean()), "it is transparent"
        return clear
    if not shown:
        output = material.node_tree.get_output_node("CYCLES")
        # Cycles shows a surface without a shader black.
        black = rendered.is_holdout(material) or not (output and active_links(output.inputs["Surface"]))
        notes.append(f"A shader that is not known is shown {'black' if black else 'gray'}")
        values = {**DEFAULTS, **(BLACK if black else {})}
        row = _row(material.name_full)
        return ExportedMaterial(row, {}, values, "its shader is not known", notes)
    base = next((layer for layer in shown if layer.shader.input("Base Color")), shown[0])
    result = ExportedMaterial(_row(material.name_full), notes=notes)
    if base.kind != PRINCIPLED:
        result.reason = f"its shader is a {base.shader.node.bl_label}"
        result.values.update(base.shader.shader.stand_in)
        result.values.update(mixture.values(base))
    _constants(base, mixture, result.row)
    notes += _notes(base, shown, result.row["constants"])
    _mixed(result, mixture)
    _varying(result, mixture)
    return result


def _notes(base: Layer, shown: list[Layer], constants: Mapping[str, Any]) -> list[str]:
    """Notes about shaders and inputs that the engine approximates or ignores."""
    notes = []
    if any(layer is not base and layer.matter != "light" for layer in shown):
        notes.append("The mix of shaders is approximated")
    elif base.kind not in (PRINCIPLED, "ShaderNodeBsdfDiffuse", "ShaderNodeEmission"):
        notes.append(f"{base.shader.node.bl_label} is approximated")
    left_out = {
        "subsurface": "Subsurface is shown as plain diffuse color",
        "anisotropic": "Anisotropic highlights are shown round",
        "thin_film": "Thin Film is left out",
    }
    return notes + [note for name, note in left_out.items() if constants.get(name, 0.0) > 0]


def _row(name: str) -> dict[str, Any]:
    return {"name": name, "alpha": 1.0, "constants": {}, "texture": None}


def _constants(base: Layer, mixture: Mixture, row: dict[str, Any]) -> None:
    """Adds to a material's `row` the inputs that no vibe changes."""
    for name, socket in CONSTANTS.items():
        entry = base.shader.input(socket)
        if entry is not None:
            value = entry.default_value
            row["constants"][name] = [float(v) for v in value[:3]] if hasattr(value, "__len__") else float(value)
    coat = layers.lacquer_over(mixture.layers, base)
    if coat and (node := coat.sides[-1].grazing):
        row["constants"]["coat_ior"] = _ior(node)
    alpha = base.shader.node.inputs.get("Alpha")
    if alpha:
        row["alpha"] = float(alpha.default_value)


def _mixed(result: ExportedMaterial, mixture: Mixture) -> None:
    """Adds mixed shaders' base color, opacity and emission color (times the Emission's share) to `result`."""
    window = next((c.picture for name, c in mixture.measured.items() if name.startswith("mix")), None)
    frame = window or ExportedTexture(np.ones((1, 1, 1), np.float32))
    if len(mixture.colors) > 1:
        result.pictures["base_color"] = replace(frame, image=mixture.color())
    if not mixture.cutout():
        opacity = mixture.opacity()
        result.row["alpha"] *= float(opacity.mean())
        if opacity.size > 1 and "alpha" not in mixture.measured:
            result.pictures["alpha"] = replace(frame, image=opacity)
    share = mixture.glow()
    if share is not None:
        channel = mixture.measured.get("emission_color")
        color = channel.values if channel else np.ones((1, 1, 3), np.float32)  # plain: parameter
        result.pictures["emission_color"] = replace(frame, image=(share * color).astype(np.float32))


def _varying(result: ExportedMaterial, mixture: Mixture) -> None:
    """Adds to `result` the inputs that nodes compute: a texture if the engine takes one, otherwise the mean."""
    cut = mixture.cutout()
    for name, channel in mixture.measured.items():
        if name not in COMPUTED and name != "far":
            continue  # a channel of the mixture
        picture, mean = channel.picture, channel.mean
        if name == "alpha" and cut and cut[1]:
            mean = 1 - mean
            picture = replace(picture, image=1 - picture.image) if picture else None
        if picture and name not in UNIFORM:
            result.pictures.setdefault(name, picture)
            result.notes += [picture.warning] if picture.warning else []
        elif name != "normal":
            result.notes.append(f"{COMPUTED[name]} is shown as its average")
        if name == "alpha":
            result.row["alpha"] = float(np.clip(mean.mean(), 0.0, 1.0))
        elif name in COMPUTED and name not in ("normal", *_TINTED):
            color = tuple(float(v) for v in mean)
            result.values[name] = color if name in COLORS else (sum(color) / len(color),)
        if name in _TINTED and name not in result.pictures:
            result.pictures[name] = ExportedTexture(mean[None, None].astype(np.float32))
    result.reason = result.reason or "it is computed by nodes"
