# SPDX-License-Identifier: GPL-3.0-or-later
"""The inputs of the Principled BSDF that the engine knows, and what other shaders are in its words."""

from __future__ import annotations

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
"""What the other shaders are in its words."""
BLACK: dict[str, tuple[float, ...]] = {
    "base_color": (0.0, 0.0, 0.0),
    "specular": (0.0,),
    "roughness": (1.0,),
}
DEFAULTS = {
    "base_color": (0.8, 0.8, 0.8),
    "emission": (0.0,),
    "emission_color": (1.0, 1.0, 1.0),
    "roughness": (0.5,),
}

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
COMPUTED = {
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
UNIFORM = {"specular", "specular_tint", "coat_roughness", "sheen"}
"""Those of them that the engine takes for the same everywhere."""

PRINCIPLED = "ShaderNodeBsdfPrincipled"
EXACT = {PRINCIPLED, "ShaderNodeBsdfDiffuse", "ShaderNodeEmission"}
"""Shaders that the engine has as they are."""

COLORS = ("base_color", "emission_color", "specular_tint")
