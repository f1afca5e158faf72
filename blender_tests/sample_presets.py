# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets as artists save them."""

from proxy_renderer.schema import preset

NOIR = preset.Preset(
    "Noir",
    {
        "key": [{"power": [60.0], "color": [0.8, 0.9, 1.0]}],
        "rim": [{"power": [90.0]}],
        "film": [{"saturation": [0.0], "contrast": [1.4]}],
        "subject": [{"roughness": [0.15]}],
    },
    {"key": ["AREA"], "rim": ["AREA"]},
    "black and white noir, hard light",
)
DAY = preset.Preset("Day", {"film": [{"exposure": [1.0]}], "world": [{"strength": [2.0]}]}, {}, "bright day")
