# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's color mathematics: sRGB encoding and luma. No bpy here."""

from __future__ import annotations

import numpy as np

Color = tuple[float, float, float]

LUMA = (0.2126, 0.7152, 0.0722)
"""Weights of linear red, green and blue (Rec.709)."""


def to_linear(encoded: np.ndarray) -> np.ndarray:
    """sRGB's decoding (IEC 61966-2-1), of any shape; straight on below black and above white."""
    curve = ((np.maximum(encoded, 0.0) + 0.055) / 1.055) ** 2.4
    return np.where(encoded <= 0.04045, encoded / 12.92, curve)


def to_srgb(linear: np.ndarray) -> np.ndarray:
    """Inverse of `to_linear`."""
    curve = 1.055 * np.maximum(linear, 0.0) ** (1 / 2.4) - 0.055
    return np.where(linear <= 0.0031308, linear * 12.92, curve)
