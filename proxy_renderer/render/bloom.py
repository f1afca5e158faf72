# SPDX-License-Identifier: Apache-2.0
"""Blender's bloom (Glare node): a pyramid of highlights, blurred on the way down and added up on the way back."""

from __future__ import annotations

import math

from torch import Tensor
from torch.nn import functional

THRESHOLD = 1.0
SIZE = 0.5


def bloom(picture: Tensor, threshold: float = THRESHOLD, size: float = SIZE) -> Tensor:
    """What the Glare node would add at strength 1 to a linear picture (H, W, 3)."""
    brightest = picture.detach().amax(-1, keepdim=True).clamp_min(1e-6)
    highlights = picture.clamp_min(0) * ((brightest - threshold).clamp_min(0) / brightest)
    layer = highlights.permute(2, 0, 1)[None]
    length = int(math.log2(max(min(layer.shape[-2:]) * size, 1)))
    layers = [layer]
    for _ in range(length - 1):
        layers.append(
            functional.avg_pool2d(
                functional.avg_pool2d(layers[-1], 3, 1, 1, count_include_pad=False), 2, ceil_mode=True
            )
        )
    total = layers[-1]
    for finer in reversed(layers[:-1]):
        total = finer + functional.interpolate(
            total, size=finer.shape[-2:], mode="bilinear", align_corners=False
        )
    return total[0].permute(1, 2, 0)
