# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials as the engine sees them: every surface as a Principled BSDF, exact or approximated."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from bpy.types import Material

from ..core import compat, rendered
from ..core.schema_import import schema
from ..scene.nodes import inputs, layers, trails
from ..scene.nodes.trails import FOREIGN, ValueOrigin
from .mixture import MeasuredChannel, Mixture
from .textures import ExportedTexture, uv_mapping

APPROXIMATE: dict[str, dict[str, tuple[float, ...]]] = {
    "ShaderNodeBsdfDiffuse": {"roughness": (1.0,), "specular": (0.0,)},
    "ShaderNodeBsdfTranslucent": {"roughness": (1.0,), "specular": (0.0,)},
    "ShaderNodeSubsurfaceScattering": {"roughness": (1.0,), "specular": (0.0,)},
    "ShaderNodeBsdfToon": {"roughness": (1.0,), "specular": (0.0,)},
    "ShaderNodeBsdfSheen": {"base_color": (0.0, 0.0, 0.0), "specular": (0.0,), "sheen": (1.0,)},
    "ShaderNodeBsdfHair": {"roughness": (0.6,)},
    "ShaderNodeBsdfHairPrincipled": {"roughness": (0.6,)},
    "ShaderNodeBsdfRefraction": {"transmission": (1.0,)},
    "ShaderNodeBsdfGlossy": {"metallic": (1.0,), "specular_tint": (1.0, 1.0, 1.0)},
    "ShaderNodeBsdfAnisotropic": {"metallic": (1.0,), "specular_tint": (1.0, 1.0, 1.0)},
    "ShaderNodeBsdfMetallic": {"metallic": (1.0,)},
    "ShaderNodeBsdfGlass": {"transmission": (1.0,)},
    "ShaderNodeEmission": {"base_color": (0.0, 0.0, 0.0), "specular": (0.0,)},
}
"""Inputs of the Principled BSDF that stands for each other shader."""
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
_SOCKETS = {name: p.blender.removeprefix("Principled BSDF > ") for name, p in _PARAMETERS.items()}
COMPUTED = {"alpha": "Alpha", "normal": "Normal"} | {
    name: socket for name, socket in _SOCKETS.items() if name not in ("ior", "tint", "recolor")
}
"""Inputs that nodes may compute, and the names of their sockets on the Principled BSDF."""
UNIFORM = {"specular", "specular_tint", "coat_roughness", "sheen"}
"""Inputs of `COMPUTED` for which the engine takes no texture: the mean stands for them."""

PRINCIPLED = "ShaderNodeBsdfPrincipled"
COLORS = ("base_color", "emission_color", "specular_tint")
_TINTED = ("base_color", "emission_color", "emission")  # computed inputs that a parameter multiplies
NO_MATERIAL = "(no material)"  # name of the entry for faces without a material


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
    # approximations, each a sentence without its period
    notes: list[str] = field(default_factory=list)


def uv_of(material: Material) -> tuple[str, np.ndarray]:
    """The UV map of a material's base color or alpha texture ("" for the active one), and its 3x3 mapping matrix."""
    origins = computed_inputs(material)
    origin = origins.get("base_color") or origins.get("alpha")
    return uv_mapping(origin.source if origin else None)


def computed_inputs(material: Material | None) -> dict[str, ValueOrigin | None]:
    """Origins of a material's computed inputs, by input, before Vibe Render's tint.

    Inputs are those of `COMPUTED` and the channels of `Mixture`. The origin of "normal" is None if Displacement makes it.
    """
    if material is None or not layers.by_prominence(material):
        return {}
    mixture = Mixture.of(material)
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
        if output and trails.active_links(output.inputs["Displacement"]):
            outputs["normal"] = None
    return outputs


def export_material(material: Material | None, measured: Mapping[str, MeasuredChannel]) -> ExportedMaterial:
    """Describes a material (None: faces without one), given the measurements of its `computed_inputs`."""
    if material is None:
        values = {**DEFAULTS, **APPROXIMATE["ShaderNodeBsdfDiffuse"]}
        return ExportedMaterial(_row(NO_MATERIAL, "approximate"), {}, values, "it has no material")
    if compat.node_tree(material) is None:
        values = {"metallic": (material.metallic,), "roughness": (material.roughness,)}
        return ExportedMaterial(_row(material.name_full, "approximate"), {}, values, "its nodes are off")
    mixture, shown = Mixture.of(material), layers.by_prominence(material)
    labels = {node.bl_idname: node.bl_label for node in trails.foreign_nodes(material)}
    notes = [f"{label}, which {FOREIGN[kind]}, is left out" for kind, label in labels.items()]
    if not shown and mixture.layers:
        clear = ExportedMaterial(_row(material.name_full, "principled"), {}, {**DEFAULTS, **BLACK})
        clear.row["alpha"], clear.reason = float(mixture.opacity(measured).mean()), "it is transparent"
        return clear
    if not shown:
        output = material.node_tree.get_output_node("CYCLES")
        # Cycles shows a surface without a shader black.
        black = rendered.is_holdout(material) or not (output and trails.active_links(output.inputs["Surface"]))
        notes.append(f"A shader that is not known is shown {'black' if black else 'gray'}")
        values = {**DEFAULTS, **(BLACK if black else {})}
        row = _row(material.name_full, "approximate")
        return ExportedMaterial(row, {}, values, "its shader is not known", notes)
    base = next((layer for layer in shown if layer.shader.input("Base Color")), shown[0])
    result = ExportedMaterial(_row(material.name_full, "principled"), notes=notes)
    if base.kind != PRINCIPLED:
        result.row["model"], result.reason = "approximate", f"its shader is a {base.shader.node.bl_label}"
        result.values.update(APPROXIMATE[base.kind])
        result.values.update(mixture.values(base, measured))
    _constants(base, mixture, result.row)
    notes += _notes(base, shown, result.row["constants"])
    _mixed(result, material, mixture, measured)
    _varying(result, measured, mixture)
    return result


def _notes(base: layers.Layer, shown: list[layers.Layer], constants: Mapping[str, Any]) -> list[str]:
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


def _row(name: str, model: str) -> dict[str, Any]:
    return {"name": name, "model": model, "alpha": 1.0, "constants": {}, "texture": None}


def _constants(base: layers.Layer, mixture: Mixture, row: dict[str, Any]) -> None:
    """Adds the inputs that no vibe changes to a material's row."""
    for name, socket in CONSTANTS.items():
        entry = base.shader.input(socket)
        if entry is not None:
            value = entry.default_value
            row["constants"][name] = [float(v) for v in value[:3]] if hasattr(value, "__len__") else float(value)
    if ior := mixture.coat_ior(base):
        row["constants"]["coat_ior"] = ior
    alpha = base.shader.node.inputs.get("Alpha")
    if alpha:
        row["alpha"] = float(alpha.default_value)


def _mixed(
    result: ExportedMaterial, material: Material, mixture: Mixture, measured: Mapping[str, MeasuredChannel]
) -> None:
    """Adds the sums of mixed shaders: base color, opacity, and emission color times the share of the Emission node."""
    window = next((c.picture for name, c in measured.items() if name.startswith("mix")), None)
    frame = window or ExportedTexture(np.ones((1, 1, 1), np.float32))
    if len(mixture.colors) > 1:
        result.pictures["base_color"] = replace(frame, image=mixture.color(material, measured))
    if not mixture.cutout():
        opacity = mixture.opacity(measured)
        own = measured.get("alpha")
        result.row["alpha"] *= float(opacity.mean())
        if opacity.size > 1 and own is None:
            result.pictures["alpha"] = replace(frame, image=opacity)
    share = mixture.glow(measured)
    if share is not None:
        channel = measured.get("emission_color")
        color = channel.values if channel else np.ones((1, 1, 3), np.float32)  # plain: parameter
        result.pictures["emission_color"] = replace(frame, image=(share * color).astype(np.float32))


def _varying(result: ExportedMaterial, measured: Mapping[str, MeasuredChannel], mixture: Mixture) -> None:
    """Adds the computed inputs: as a texture if the engine takes one, otherwise as the mean."""
    cut = mixture.cutout()
    for name, channel in measured.items():
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
