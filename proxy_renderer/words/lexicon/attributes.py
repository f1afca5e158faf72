# SPDX-License-Identifier: Apache-2.0
"""What can be read off a picture: the attributes that words name, heads predict and losses use."""

COLORS = (
    "black",
    "grey",
    "white",
    "brown",
    "red",
    "orange",
    "yellow",
    "green",
    "teal",
    "blue",
    "purple",
    "pink",
)

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
