# SPDX-License-Identifier: Apache-2.0
"""Color spaces of numpy arrays (..., 3): `floats` for many colors at once, without torch."""

import numpy as np

from . import constants as c


def srgb_from_linear(linear: np.ndarray) -> np.ndarray:
    """Encodes linear light (any shape, ≥ 0) with the sRGB curve (IEC 61966-2-1); unbounded above."""
    curved = c.SRGB_SCALE * np.maximum(linear, c.SRGB_LINEAR_END) ** (1 / c.SRGB_EXPONENT) - c.SRGB_OFFSET
    return np.where(linear <= c.SRGB_LINEAR_END, linear * c.SRGB_SLOPE, curved)


def luminance(linear: np.ndarray) -> np.ndarray:
    """Luminance (...) of linear Rec.709 (..., 3), in its own precision."""
    return linear @ np.asarray(c.LUMINANCE_WEIGHTS, linear.dtype)


def sphere_luminance(environment: np.ndarray) -> float:
    """Mean luminance over the sphere of an equirectangular environment (H, W, 3), linear Rec.709: its rows at the poles are narrow."""
    heights = (np.arange(len(environment)) + 0.5) / len(environment) * np.pi - np.pi / 2
    return float(np.average(luminance(environment).mean(1), weights=np.cos(heights)))
