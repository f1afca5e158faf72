# SPDX-License-Identifier: GPL-3.0-or-later
"""The grade's formulas, written once more in numpy to compare others with."""

import colorsys

import numpy as np

IDENTITY = {
    "glare": 0.0, "grade_exposure": 0.0, "lift": (1.0, 1.0, 1.0), "midtone": (1.0, 1.0, 1.0), "gain": (1.0, 1.0, 1.0),
    "contrast": 1.0, "saturation": 1.0, "hue": 0.0, "grade_gamma": 1.0, "vignette": 0.0,
}  # fmt: skip


def reference(c, **given):
    """Linear (H, W, 3), row 0 at the bottom, through steps 2 to 8 of the grade."""
    v = {**IDENTITY, **given}
    c = c * 2.0 ** v["grade_exposure"]
    c = balance(c, *(np.array(v[name]) for name in ("lift", "midtone", "gain")))
    c = np.where(c > 0.0, 0.18 * (np.maximum(c, 1e-9) / 0.18) ** v["contrast"], c)
    luma = (c @ (0.2126, 0.7152, 0.0722))[..., None]
    c = np.maximum(luma + v["saturation"] * (c - luma), 0.0)
    c = np.apply_along_axis(lambda rgb: turned(rgb, v["hue"] / 360.0), -1, c)
    c = np.where(c > 0.0, np.maximum(c, 1e-9) ** v["grade_gamma"], c)
    height, width = c.shape[:2]
    across, up = (np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height
    radius = np.sqrt(((2.0 * across - 1.0) ** 2 + ((2.0 * up - 1.0) ** 2)[:, None]) / 2.0)
    t = np.clip((radius - 0.3) / 0.7, 0.0, 1.0)
    return c * (1.0 - v["vignette"] * t * t * (3.0 - 2.0 * t))[..., None]


def balance(c, lift, gamma, gain):
    return np.maximum(((c - 1.0) * (2.0 - lift) + 1.0) * gain, 0.0) ** (1.0 / gamma)


def turned(rgb, turns):
    hue, saturation, brightness = colorsys.rgb_to_hsv(*rgb)
    return colorsys.hsv_to_rgb((hue + turns) % 1.0, saturation, brightness)
