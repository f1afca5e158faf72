# SPDX-License-Identifier: Apache-2.0
"""What a picture file holds, whatever its format, and how all of them are made smaller."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from PIL import Image

LONGEST = 1024
"""Longer side in pixels beyond which a picture tells nothing more of a look."""


@dataclass(frozen=True)
class FileContents:
    """The pixels of a file, at most `LONGEST` long.

    Attributes:
        color: (H, W, 3) float32: sRGB in [0, 1], or linear Rec.709, finite and at least 0.
        alpha: (H, W) in [0, 1]; None if every pixel counts wholly.
        linear: Whether the colors are linear light.
        panorama: Whether the file itself says that it shows all directions.
        notes: What was done to it, a sentence each.
    """

    color: np.ndarray
    alpha: np.ndarray | None
    linear: bool
    panorama: bool
    notes: tuple[str, ...]


def small_size(width: int, height: int) -> tuple[int, int]:
    """Width and height with the longer one at most `LONGEST`, and none below 1."""
    factor = min(1.0, LONGEST / max(width, height))
    return max(1, round(width * factor)), max(1, round(height * factor))


def shrunk_linear(color: np.ndarray, alpha: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Means of areas, each pixel as much as its alpha.

    Args:
        color: (H, W, 3) linear.
        alpha: (H, W) in [0, 1].

    Returns:
        Both at `small_size`; the color is 0 where the alpha is.
    """
    size = small_size(color.shape[1], color.shape[0])
    weight = _mean(alpha, size)
    sums = np.stack([_mean(color[..., c] * alpha, size) for c in range(3)], -1)
    return sums / np.maximum(weight, 1e-6)[..., None], weight


def counted(alpha: np.ndarray) -> np.ndarray | None:
    """The alpha as it is kept: None where all pixels count."""
    return None if alpha.min() >= 1.0 - 0.5 / 255 else alpha.astype(np.float32).clip(0.0, 1.0)


def _mean(channel: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    picture = Image.fromarray(np.ascontiguousarray(channel, np.float32))
    return np.asarray(picture.resize(size, Image.Resampling.BOX))
