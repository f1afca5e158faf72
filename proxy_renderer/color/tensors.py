# SPDX-License-Identifier: Apache-2.0
"""Color spaces of torch tensors (..., 3): sRGB, linear Rec.709 and CIE Lab.

Every function is differentiable, and its gradient is finite everywhere.
"""

from __future__ import annotations

import torch
from jaxtyping import Float
from torch import Tensor

from . import constants as c


def luminance(linear: Float[Tensor, "*pixels 3"]) -> Float[Tensor, "*pixels 1"]:
    """Luminance (..., 1) of linear Rec.709 (..., 3)."""
    return (linear * linear.new_tensor(c.LUMINANCE_WEIGHTS)).sum(-1, keepdim=True)


def srgb_from_linear(linear: Float[Tensor, "*any"]) -> Float[Tensor, "*any"]:
    """Encodes linear light (any shape, ≥ 0) with the sRGB curve (IEC 61966-2-1); unbounded above."""
    curved = c.SRGB_SCALE * linear.clamp_min(c.SRGB_LINEAR_END) ** (1 / c.SRGB_EXPONENT) - c.SRGB_OFFSET
    return torch.where(linear <= c.SRGB_LINEAR_END, linear * c.SRGB_SLOPE, curved)


def linear_from_srgb(encoded: Float[Tensor, "*any"]) -> Float[Tensor, "*any"]:
    """Inverse of `srgb_from_linear`."""
    curved = ((encoded.clamp_min(c.SRGB_ENCODED_END) + c.SRGB_OFFSET) / c.SRGB_SCALE) ** c.SRGB_EXPONENT
    return torch.where(encoded <= c.SRGB_ENCODED_END, encoded / c.SRGB_SLOPE, curved)


def lab_from_linear(linear: Float[Tensor, "*pixels 3"]) -> Float[Tensor, "*pixels 3"]:
    """CIE Lab, white D65, of linear Rec.709 (..., 3) in [0, 1]: L in [0, 100], a and b about ±110."""
    matrix = linear.new_tensor(c.XYZ_FROM_REC709)
    white = matrix.sum(1)
    ratio = linear @ (matrix / white[:, None]).T
    cube_root = ratio.clamp_min(c.LAB_DELTA**3) ** (1 / 3)
    f = torch.where(ratio > c.LAB_DELTA**3, cube_root, ratio * (1 / c.LAB_DELTA) ** 2 / 3 + c.LAB_OFFSET)
    fx, fy, fz = f.unbind(-1)
    return torch.stack((116 * fy - 16, 500 * (fx - fy), 200 * (fy - fz)), -1)


def oklab_from_srgb(display: Float[Tensor, "*pixels 3"]) -> Float[Tensor, "*pixels 3"]:
    """OKLab (Ottosson 2020) of sRGB-encoded pictures (..., 3) in [0, 1]: L in [0, 1], a and b about ±0.4."""
    cones = linear_from_srgb(display) @ display.new_tensor(c.CONES_FROM_REC709).T
    return cones.clamp_min(1e-6) ** (1 / 3) @ display.new_tensor(c.OKLAB_FROM_CONES).T


def lab_from_srgb(display: Float[Tensor, "*pixels 3"]) -> Float[Tensor, "*pixels 3"]:
    """CIE Lab (D65) of sRGB-encoded pictures (..., 3) in [0, 1]."""
    return lab_from_linear(linear_from_srgb(display))
