# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials as the engine sees them: every surface as a Principled BSDF, exact or approximated."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import bpy
import numpy as np

from . import compat, shaders
from .contract import schema
from .export_texture import Picture, untinted, uv_mapping

NO_MATERIAL = "(no material)"
"""What faces without a material are called; a name that Blender would not give."""

Read = Callable[[bpy.types.NodeSocket], Picture]
Mean = Callable[[bpy.types.NodeSocket], np.ndarray]

# What the other shaders are in the words of the Principled BSDF.
_APPROXIMATE: dict[str, dict[str, tuple[float, ...]]] = {
    "ShaderNodeBsdfDiffuse": {"roughness": (1.0,), "specular": (0.0,)},
    "ShaderNodeBsdfTranslucent": {"roughness": (1.0,), "specular": (0.0,)},
    "ShaderNodeSubsurfaceScattering": {"roughness": (1.0,), "specular": (0.0,)},
    "ShaderNodeBsdfGlossy": {"metallic": (1.0,), "specular_tint": (1.0, 1.0, 1.0)},
    "ShaderNodeBsdfAnisotropic": {"metallic": (1.0,), "specular_tint": (1.0, 1.0, 1.0)},
    "ShaderNodeBsdfMetallic": {"metallic": (1.0,)},
    "ShaderNodeBsdfGlass": {"transmission": (1.0,)},
    "ShaderNodeEmission": {"base_color": (0.0, 0.0, 0.0), "specular": (0.0,)},
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
}
_MEASURED = {
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


@dataclass
class Exported:
    """One material.

    Attributes:
        row: Its entry in scene.json, but for the role and the texture.
        picture: The texture of its base color, if that is linked.
        values: Values that bindings cannot know: of other shaders, and means of computed inputs.
        reason: Why those values are locked.
    """

    row: dict[str, Any]
    picture: Picture | None = None
    values: dict[str, schema.Values] = field(default_factory=dict)
    reason: str = ""


def uv_of(material: bpy.types.Material) -> tuple[str, np.ndarray]:
    """The UV map that a material's base color is laid over, and the 3x3 matrix of its mapping."""
    _, source = _input(material, "Base Color")
    return uv_mapping(untinted(source) if source else None)


def export(material: bpy.types.Material | None, read: Read, mean: Mean) -> Exported:
    """Describes a material; None stands for faces without one.

    Args:
        read: Gives the texture behind an output that Base Color is linked to.
        mean: Gives the mean color of an output.
    """
    if material is None:
        values = {**_DEFAULTS, **_APPROXIMATE["ShaderNodeBsdfDiffuse"]}
        return Exported(_row(NO_MATERIAL, "approximate"), None, values, "it has no material")
    tree, found = compat.node_tree(material), shaders.surface(material)
    if tree is None:
        values = {"metallic": (material.metallic,), "roughness": (material.roughness,)}
        return Exported(_row(material.name_full, "approximate"), None, values, "its nodes are off")
    if found is None:
        row = _row(
            material.name_full, "approximate", f"{material.name}: its shader is not known; it is shown grey."
        )
        return Exported(row, None, dict(_DEFAULTS), "its shader is not known")
    result = Exported(_row(material.name_full, "principled"))
    kind = found.node.bl_idname
    notes = []
    if kind != "ShaderNodeBsdfPrincipled":
        result.row["model"], result.reason = "approximate", f"its shader is a {found.node.bl_label}"
        result.values.update(_APPROXIMATE[kind])
        notes.append(f"{found.node.bl_label} is approximated")
    elif not _is_output(material, found.node):
        notes.append("its mix of shaders is shown as its Principled BSDF alone")
    _constants(found, result.row)
    _computed(material, result, read, mean, notes)
    result.row["warning"] = f"{material.name}: {'; '.join(notes)}." if notes else ""
    return result


def _row(name: str, model: str, warning: str = "") -> dict[str, Any]:
    return {"name": name, "model": model, "warning": warning, "alpha": 1.0, "constants": {}, "texture": None}


def _input(material: bpy.types.Material, name: str) -> tuple[Any, bpy.types.NodeSocket | None]:
    """The socket that holds an input of the surface's shader, and the output that computes it."""
    found = shaders.surface(material)
    entry = found.input(name) if found else None
    return shaders.resolve(entry, found.inside) if found and entry else (None, None)


def _is_output(material: bpy.types.Material, node: bpy.types.Node) -> bool:
    """Whether a shader goes straight to the output, or is inside a group."""
    if node.id_data != material.node_tree:
        return True
    output = material.node_tree.get_output_node("CYCLES")
    links = shaders.active_links(output.inputs["Surface"]) if output else []
    while links and links[0].from_node.type == "REROUTE":
        links = shaders.active_links(links[0].from_node.inputs[0])
    return bool(links) and links[0].from_node == node


def _constants(found: shaders.Found, row: dict[str, Any]) -> None:
    """Inputs that no vibe changes."""
    for name, socket in _CONSTANTS.items():
        if socket in found.node.inputs:
            value = found.node.inputs[socket].default_value
            row["constants"][name] = (
                [float(v) for v in value[:3]] if hasattr(value, "__len__") else float(value)
            )
    alpha = found.node.inputs.get("Alpha")
    if alpha:
        row["alpha"] = float(alpha.default_value)


def _computed(
    material: bpy.types.Material, result: Exported, read: Read, mean: Mean, notes: list[str]
) -> None:
    """Reads the texture of the base color, and the means of the other computed inputs."""
    _, source = _input(material, "Base Color")
    if source:
        result.picture = read(untinted(source))
        notes += [result.picture.warning] if result.picture.warning else []
    for name, socket in _MEASURED.items():
        _, source = _input(material, socket)
        if source:
            color = tuple(float(v) for v in mean(source))
            result.values[name] = (
                color if schema.FAMILIES[f"material/{name}"].components == 3 else (sum(color) / 3,)
            )
            notes.append(f"{socket} is shown as its average")
    _, source = _input(material, "Alpha")
    if source:
        result.row["alpha"] = float(np.clip(mean(source).mean(), 0.0, 1.0))
        notes.append("Alpha is shown as its average")
    result.reason = result.reason or "it is computed by nodes"
