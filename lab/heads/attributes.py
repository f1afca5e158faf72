# SPDX-License-Identifier: Apache-2.0
"""The attributes that the trained heads read off pictures, with their classes."""

from proxy_renderer.words.lexicon.quantities import COLORS

ATTRIBUTES: dict[str, tuple[str, ...]] = {
    "subject_color": COLORS,
    "surroundings_color": COLORS,
    "subject_finish": ("matte", "satin", "glossy"),
    "subject_metal": ("dielectric", "metal"),
    "light_side": ("left", "front", "right", "back", "top"),
    "light_softness": ("hard", "soft"),
    "light_temperature": ("warm", "neutral", "cool"),
    "fog": ("none", "light", "thick"),
    "brightness": ("dark", "medium", "bright"),
    "contrast": ("low", "medium", "high"),
    "saturation": ("muted", "natural", "vivid"),
    "vignette": ("none", "vignette"),
}
"""Attribute name -> its classes; an ordered scale where there is one. The trained heads have this order."""
