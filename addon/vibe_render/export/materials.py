# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials as the engine sees them: every surface as a Principled BSDF, exact or approximated."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import bpy
import numpy as np

from ..core import compat
from ..core.schema_import import schema
from ..scene.nodes import shaders
from . import mix_shader
from .textures import ExportedTexture, untinted, uv_mapping

NO_MATERIAL = "(no material)"
"""What faces without a material are called; a name that Blender would not give."""

# What the other shaders are in the words of the Principled BSDF.
_APPROXIMATE: dict[str, dict[str, tuple[float, ...]]] = {
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
_BLACK: dict[str, tuple[float, ...]] = {
    "base_color": (0.0, 0.0, 0.0),
    "specular": (0.0,),
    "roughness": (1.0,),
}
_DEFAULTS = {
    "base_color": (0.8, 0.8, 0.8),
    "emission": (0.0,),
    "emission_color": (1.0, 1.0, 1.0),
    "roughness": (0.5,),
}

_CONSTANTS = {
    "coat_ior": "Coat IOR",
    "coat_tint": "Coat Tint",
    "sheen_roughness": "Sheen Roughness",
    "sheen_tint": "Sheen Tint",
    "diffuse_roughness": "Diffuse Roughness",
    "anisotropic": "Anisotropic",
    "subsurface": "Subsurface Weight",
    "thin_film": "Thin Film Thickness",
}
_COMPUTED = {
    "base_color": "Base Color",
    "alpha": "Alpha",
    "normal": "Normal",
    "metallic": "Metallic",
    "roughness": "Roughness",
    "specular": "Specular IOR Level",
    "specular_tint": "Specular Tint",
    "coat": "Coat Weight",
    "coat_roughness": "Coat Roughness",
    "sheen": "Sheen Weight",
    "transmission": "Transmission Weight",
    "emission_color": "Emission Color",
    "emission": "Emission Strength",
}
"""Inputs that nodes may compute, and what the Principled BSDF calls them."""
_UNIFORM = {"specular", "specular_tint", "coat_roughness", "sheen"}
"""Those of them that the engine takes for the same everywhere."""

_COLORS = ("base_color", "emission_color", "specular_tint")


@dataclass(frozen=True)
class MeasuredChannel:
    """A computed input as it was measured: its mean (1,) or (3,), and its picture if it varies."""

    mean: np.ndarray
    picture: ExportedTexture | None = None


@dataclass
class ExportedMaterial:
    """One material.

    Attributes:
        row: Its entry in scene.json, but for the role and the pictures.
        pictures: Inputs that vary, by name: "base_color", "alpha", "normal", or a parameter's; "far" is the
            base color as mirrors may show it.
        values: Values that bindings cannot know: of other shaders, and means of computed inputs.
        reason: Why those values are locked.
    """

    row: dict[str, Any]
    pictures: dict[str, ExportedTexture] = field(default_factory=dict)
    values: dict[str, schema.Values] = field(default_factory=dict)
    reason: str = ""


def uv_of(material: bpy.types.Material) -> tuple[str, np.ndarray]:
    """The UV map that a material's textures are laid over, and the 3x3 matrix of its mapping."""
    sources = computed(material)
    return uv_mapping(sources.get("base_color") or sources.get("alpha"))


def computed(material: bpy.types.Material | None) -> dict[str, bpy.types.NodeSocket | None]:
    """The outputs that compute a material's inputs, before our tint; None for the normal that Displacement makes."""
    if material is None or shaders.surface(material) is None:
        return {}
    sources = {name: _input(material, socket)[1] for name, socket in _COMPUTED.items()}
    outputs = {name: untinted(source) for name, source in sources.items() if source}
    cut = shaders.cutout(material)
    if cut and cut.source:
        outputs["alpha"] = cut.source
    bumps = shaders.bumps(material)
    return {**outputs, "normal": None} if bumps and "normal" not in outputs else outputs


def export(material: bpy.types.Material | None, measured: Mapping[str, MeasuredChannel]) -> ExportedMaterial:
    """Describes a material; None stands for faces without one.

    Args:
        measured: What `computed` inputs give; those that could not be measured are missing.
    """
    if material is None:
        values = {**_DEFAULTS, **_APPROXIMATE["ShaderNodeBsdfDiffuse"]}
        return ExportedMaterial(_row(NO_MATERIAL, "approximate"), {}, values, "it has no material")
    tree, shader = compat.node_tree(material), shaders.surface(material)
    if tree is None:
        values = {"metallic": (material.metallic,), "roughness": (material.roughness,)}
        return ExportedMaterial(_row(material.name_full, "approximate"), {}, values, "its nodes are off")
    notes = _foreign(material)
    if shader is None:
        black = not _has_shader(tree)  # as Cycles shows what it has no shader for
        notes.append(f"its shader is not known; it is shown {'black' if black else 'gray'}")
        row = _row(material.name_full, "approximate", f"{material.name}: {'; '.join(notes)}.")
        values = {**_DEFAULTS, **(_BLACK if black else {})}
        return ExportedMaterial(row, {}, values, "its shader is not known")
    result = ExportedMaterial(_row(material.name_full, "principled"))
    kind = shader.node.bl_idname
    if kind != "ShaderNodeBsdfPrincipled":
        result.row["model"], result.reason = "approximate", f"its shader is a {shader.node.bl_label}"
        result.values.update(mix_shader.plastic(material) or _APPROXIMATE[kind])
        mixed = mix_shader.plastic(material) is not None
        notes.append(f"{'its mix of shaders' if mixed else shader.node.bl_label} is approximated")
    elif not _is_output(material, shader.node) and not shaders.cutout(material):
        notes.append("its mix of shaders is shown as its Principled BSDF alone")
    _constants(shader, result.row)
    notes += _rare(result.row["constants"])
    cut = shaders.cutout(material)
    if cut and cut.share is not None:
        result.row["alpha"] *= cut.share
    _varying(result, measured, cut is not None and cut.inverted, notes)
    result.row["warning"] = f"{material.name}: {'; '.join(notes)}." if notes else ""
    return result


def _has_shader(tree: bpy.types.NodeTree) -> bool:
    """Whether anything is linked to the surface of the output that Cycles takes."""
    output = tree.get_output_node("CYCLES")
    return bool(output and shaders.active_links(output.inputs["Surface"]))


def _foreign(material: bpy.types.Material) -> list[str]:
    """Warnings about nodes that a render leaves out."""
    labels = {node.bl_idname: node.bl_label for node in shaders.foreign(material)}
    return [f"{label}, which {shaders.FOREIGN[kind]}, is left out" for kind, label in labels.items()]


def _rare(constants: Mapping[str, Any]) -> list[str]:
    """Warnings about inputs that the engine approximates or ignores."""
    notes = []
    if constants.get("subsurface", 0.0) > 0:
        notes.append("Subsurface is shown as plain diffuse color")
    if constants.get("anisotropic", 0.0) > 0:
        notes.append("Anisotropic highlights are shown round")
    if constants.get("thin_film", 0.0) > 0:
        notes.append("Thin Film is left out")
    return notes


def _row(name: str, model: str, warning: str = "") -> dict[str, Any]:
    return {"name": name, "model": model, "warning": warning, "alpha": 1.0, "constants": {}, "texture": None}


def _input(material: bpy.types.Material, name: str) -> tuple[Any, bpy.types.NodeSocket | None]:
    """The socket that holds an input of the surface's shader, and the output that computes it."""
    shader = shaders.surface(material)
    entry = shader.input(name) if shader else None
    return shaders.resolve(entry, shader.inside) if shader and entry else (None, None)


def _is_output(material: bpy.types.Material, node: bpy.types.Node) -> bool:
    """Whether a shader goes straight to the output, or is inside a group."""
    if node.id_data != material.node_tree:
        return True
    output = material.node_tree.get_output_node("CYCLES")
    links = shaders.active_links(output.inputs["Surface"]) if output else []
    while links and links[0].from_node.type == "REROUTE":
        links = shaders.active_links(links[0].from_node.inputs[0])
    return bool(links) and links[0].from_node == node


def _constants(shader: shaders.NodeInGroups, row: dict[str, Any]) -> None:
    """Inputs that no vibe changes."""
    for name, socket in _CONSTANTS.items():
        entry = shader.input(socket)
        if entry is not None:
            value = entry.default_value
            row["constants"][name] = (
                [float(v) for v in value[:3]] if hasattr(value, "__len__") else float(value)
            )
    alpha = shader.node.inputs.get("Alpha")
    if alpha:
        row["alpha"] = float(alpha.default_value)


def _varying(
    result: ExportedMaterial, measured: Mapping[str, MeasuredChannel], inverted: bool, notes: list[str]
) -> None:
    """Takes over what nodes compute: pictures where the engine takes them, means of the others."""
    for name, channel in measured.items():
        picture, mean = channel.picture, channel.mean
        if name == "alpha" and inverted:
            mean = 1 - mean
            picture = replace(picture, image=1 - picture.image) if picture else None
        if picture and name not in _UNIFORM:
            result.pictures[name] = picture
            notes += [picture.warning] if picture.warning else []
        elif name != "normal":
            notes.append(f"{_COMPUTED[name]} is shown as its average")
        if name == "alpha":
            result.row["alpha"] = float(np.clip(mean.mean(), 0.0, 1.0))
        elif name in _COMPUTED and name not in ("normal", "base_color"):
            color = tuple(float(v) for v in mean)
            result.values[name] = color if name in _COLORS else (sum(color) / len(color),)
        if name == "base_color" and not picture:
            result.pictures[name] = ExportedTexture(mean[None, None].astype(np.float32))
    result.reason = result.reason or "it is computed by nodes"
