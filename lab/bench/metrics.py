# SPDX-License-Identifier: Apache-2.0
"""Distances of two pictures. All take sRGB-encoded pictures (H, W, 3) in [0, 1]."""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor
from torch.nn import functional

from proxy_renderer.color.tensors import ciede2000, lab_from_srgb, luminance

_WINDOW, _SIGMA = 11, 1.5
_C1, _C2 = 0.01**2, 0.03**2


@dataclass(frozen=True)
class Difference:
    """The difference of a picture from its reference.

    Attributes:
        delta_e: Mean CIEDE2000.
        p95: Its 95th percentile over the pixels.
        psnr: Decibels; infinite for equal pictures.
        ssim: Structural similarity of the luma, 1 for equal pictures.
        lighter: Mean difference of L*: above 0 the picture is lighter than the reference.
    """

    delta_e: float
    p95: float
    psnr: float
    ssim: float
    lighter: float


def difference(picture: Tensor, reference: Tensor) -> Difference:
    """All measures of two pictures of one size.

    Args:
        picture: (H, W, 3) sRGB-encoded, in [0, 1].
    """
    errors, light = delta_e_map(picture, reference)
    squared = float((picture - reference).square().mean())
    return Difference(
        delta_e=float(errors.mean()),
        p95=float(errors.flatten().quantile(0.95)),
        psnr=-10 * math.log10(squared) if squared > 0 else math.inf,
        ssim=ssim(picture, reference),
        lighter=float(light.mean()),
    )


def delta_e_map(picture: Tensor, reference: Tensor) -> tuple[Tensor, Tensor]:
    """CIEDE2000 (H, W), and by how much the picture's L* is above the reference's (H, W).

    Args:
        picture: (H, W, 3) sRGB-encoded, in [0, 1].
    """
    lab, target = lab_from_srgb(picture), lab_from_srgb(reference)
    return ciede2000(lab, target), lab[..., 0] - target[..., 0]


def ssim(picture: Tensor, reference: Tensor) -> float:
    """Mean structural similarity of the luma, which is the luminance of encoded values.

    Source: Wang et al., "Image quality assessment: from error visibility to structural similarity", 2004:
    Gaussian window of 11 pixels, sigma 1.5, K1 = 0.01, K2 = 0.03; borders without a whole window are left out.

    Args:
        picture: (H, W, 3), sRGB-encoded, 0 to 1.
        reference: Of the same shape.

    Returns:
        1 for equal pictures.
    """
    x, y = (luminance(p)[None, ..., 0][None].double() for p in (picture, reference))
    side = min(_WINDOW, *x.shape[2:])
    line = torch.arange(side, dtype=torch.float64) - (side - 1) / 2
    bell = torch.exp(-line.square() / (2 * _SIGMA**2))
    window = (bell[:, None] * bell / bell.sum() ** 2)[None, None]

    def mean(field: Tensor) -> Tensor:
        return functional.conv2d(field, window)

    mx, my = mean(x), mean(y)
    vx, vy, cov = mean(x * x) - mx * mx, mean(y * y) - my * my, mean(x * y) - mx * my
    top = (2 * mx * my + _C1) * (2 * cov + _C2)
    return float((top / ((mx * mx + my * my + _C1) * (vx + vy + _C2))).mean())
