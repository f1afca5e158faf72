# SPDX-License-Identifier: Apache-2.0
"""Color conversions of numpy arrays (..., 3), without torch; `floats` has them for single colors."""

import numpy as np

from . import constants as c


def srgb_from_linear(linear: np.ndarray) -> np.ndarray:
    """sRGB-encoded values of linear light (any shape, ≥ 0), by IEC 61966-2-1; values above 1 are not clamped."""
    curved = c.SRGB_SCALE * np.maximum(linear, c.SRGB_LINEAR_END) ** (1 / c.SRGB_EXPONENT) - c.SRGB_OFFSET
    return np.where(linear <= c.SRGB_LINEAR_END, linear * c.SRGB_SLOPE, curved)


def luminance(linear: np.ndarray) -> np.ndarray:
    """Luminance (...) of linear Rec.709 (..., 3), in the dtype of the input."""
    return linear @ np.asarray(c.LUMINANCE_WEIGHTS, linear.dtype)


def sphere_luminance(environment: np.ndarray) -> float:
    """Mean luminance of an equirectangular image (H, W, 3), linear Rec.709; rows are weighted by their solid angle."""
    heights = (np.arange(len(environment)) + 0.5) / len(environment) * np.pi - np.pi / 2
    return float(np.average(luminance(environment).mean(1), weights=np.cos(heights)))
