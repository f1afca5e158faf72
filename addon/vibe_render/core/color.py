# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's color mathematics: sRGB encoding, luma and OKLab. No bpy here."""

from __future__ import annotations

import numpy as np

Color = tuple[float, float, float]

LUMA = (0.2126, 0.7152, 0.0722)  # weights of linear red, green and blue (Rec.709)
# OKLab (Ottosson 2020): matrices from linear Rec.709 to cone responses, and from their cube roots to (L, a, b).
_CONES = np.array(
    ((0.4122215, 0.5363325, 0.0514460), (0.2119035, 0.6806995, 0.1073970), (0.0883025, 0.2817188, 0.6299787))
)
_OKLAB = np.array(
    ((0.2104543, 0.7936178, -0.0040720), (1.9779985, -2.4285922, 0.4505937), (0.0259040, 0.7827718, -0.8086758))
)


def to_linear(encoded: np.ndarray) -> np.ndarray:
    """Linear values of sRGB-encoded ones (IEC 61966-2-1), of any shape; values outside [0, 1] are not clipped."""
    curve = ((np.maximum(encoded, 0.0) + 0.055) / 1.055) ** 2.4
    return np.where(encoded <= 0.04045, encoded / 12.92, curve)


def to_srgb(linear: np.ndarray) -> np.ndarray:
    """Inverse of `to_linear`."""
    curve = 1.055 * np.maximum(linear, 0.0) ** (1 / 2.4) - 0.055
    return np.where(linear <= 0.0031308, linear * 12.92, curve)


def to_oklab(linear: np.ndarray) -> np.ndarray:
    """OKLab (L, a, b) of linear Rec.709 colors (Ottosson 2020), (3,) or (3, N); equal distances look about equal."""
    return _OKLAB @ np.cbrt(_CONES @ linear)


def from_oklab(lab: np.ndarray) -> np.ndarray:
    """Inverse of `to_oklab`; negative linear components become 0."""
    return np.maximum(np.linalg.solve(_CONES, np.linalg.solve(_OKLAB, lab) ** 3), 0.0)
