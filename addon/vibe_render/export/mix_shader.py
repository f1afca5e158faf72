# SPDX-License-Identifier: GPL-3.0-or-later
"""A mix of a Diffuse and a Glossy BSDF, the oldest recipe for plastic, as inputs of a Principled BSDF."""

from __future__ import annotations

import bpy

from ..core.schema_import import schema
from ..scene.nodes import shaders

_GLOSSY = ("ShaderNodeBsdfGlossy", "ShaderNodeBsdfAnisotropic")
_HEAD_ON = 0.04  # what a dielectric with the default IOR of 1.5 reflects at Specular IOR Level 0.5


def plastic(material: bpy.types.Material) -> dict[str, schema.Values] | None:
    """Inputs of the nearest dielectric layer; None if the material is no such mix.

    A constant share f of a glossy color c becomes a reflectance of f·c seen head on, a Fresnel node its IOR.
    """
    mix = shaders.last_mix(material)
    if mix is None:
        return None
    sides = [[link.from_node for link in shaders.active_links(s)] for s in mix.node.inputs[1:3]]
    kinds = [side[0].bl_idname if side else "" for side in sides]
    if "ShaderNodeBsdfDiffuse" not in kinds or not set(_GLOSSY) & set(kinds):
        return None
    number = 0 if kinds[0] in _GLOSSY else 1
    glossy = sides[number][0]
    color, rough = glossy.inputs["Color"], glossy.inputs["Roughness"]
    tint = (0.8, 0.8, 0.8) if color.is_linked else tuple(color.default_value[:3])
    strongest = max(*tint, 1e-6)
    values: dict[str, schema.Values] = {
        "roughness": (0.3 if rough.is_linked else float(rough.default_value),),
        "specular_tint": tuple(float(c) / strongest for c in tint),
    }
    socket, source = shaders.resolve(mix.node.inputs[0], mix.inside)
    if source is not None and source.node.bl_idname == "ShaderNodeFresnel":
        return {
            **values,
            "specular": (0.5 * strongest,),
            "ior": (float(source.node.inputs["IOR"].default_value),),
        }
    if source is not None:
        return {**values, "specular": (0.5 * strongest,)}
    share = float(socket.default_value) if number == 1 else 1 - float(socket.default_value)
    return {**values, "specular": (min(max(share, 0.0), 1.0) * strongest * 0.5 / _HEAD_ON,)}
