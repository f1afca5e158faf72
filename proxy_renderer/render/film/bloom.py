# SPDX-License-Identifier: Apache-2.0
"""Blender's bloom (Glare node, high quality): highlights, halved again and again, and added up on the way back.

The scheme is Jimenez's, "Next Generation Post Processing in Call of Duty: Advanced Warfare", 2014.
"""

from __future__ import annotations

import math

from torch import Tensor
from torch.nn import functional

THRESHOLD, SMOOTHNESS, SIZE = 1.0, 0.1, 0.5
"""What the add-on's grade sets the node to: brightness from which pixels glow, its softness, and the reach."""


def bloom(picture: Tensor) -> Tensor:
    """What the node would add at strength 1 to a linear picture (H, W, 3); an even glow is as bright as its source."""
    layers = [_highlights(picture).permute(2, 0, 1)[None]]
    length = int(math.log2(max(min(picture.shape[:2]) * SIZE, 1)))
    for level in range(length - 1):
        layers.append(_halve(layers[-1], calm=level == 0))
    total = layers[-1]
    for finer in reversed(layers[:-1]):
        total = finer + _tent(functional.interpolate(total, size=finer.shape[-2:], mode="bilinear"))
    return total[0].permute(1, 2, 0) / len(layers)


def _highlights(picture: Tensor) -> Tensor:
    """Colors with their HSV value lowered by the threshold, smoothly."""
    value = picture.amax(-1, keepdim=True)
    near = (SMOOTHNESS - (value - THRESHOLD).abs()).clamp_min(0) / SMOOTHNESS
    above = (value - THRESHOLD).clamp_min(0) + near * near * (SMOOTHNESS / 4)
    return picture.clamp_min(0) * (above / value.clamp_min(1e-6))


def _halve(layer: Tensor, calm: bool) -> Tensor:
    """Half the size, from five overlapping squares of four 2×2 blocks each, the middle one counting half.

    Args:
        layer: (1, 3, H, W).
        calm: Weight the blocks by 1 / (1 + brightness), so that fireflies stay small.
    """
    blocks = functional.avg_pool2d(functional.pad(layer, (3, 3, 3, 3), mode="replicate"), 2, 1)
    squares = _corners(blocks)
    if calm:
        weight = 1 / (1 + blocks.amax(1, keepdim=True).clamp_min(1))  # Blender counts the alpha of 1, too
        squares = _corners(blocks * weight) / _corners(weight)
    rows, columns = (n // 2 for n in layer.shape[-2:])
    sides = _corners(squares[..., 1:, 1:])[..., ::2, ::2]
    middle = squares[..., 2::2, 2::2]
    return (middle[..., :rows, :columns] + sides[..., :rows, :columns]) / 2


def _corners(field: Tensor) -> Tensor:
    """Mean of the corners of every 3×3 square."""
    wide = field[..., :-2] + field[..., 2:]
    return (wide[..., :-2, :] + wide[..., 2:, :]) / 4


def _tent(layer: Tensor) -> Tensor:
    """The 3×3 filter (1, 2, 1)² / 16."""
    around = functional.pad(layer, (1, 1, 1, 1), mode="replicate")
    return functional.avg_pool2d(functional.avg_pool2d(around, 2, 1), 2, 1)
