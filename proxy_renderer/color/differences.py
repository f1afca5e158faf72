# SPDX-License-Identifier: Apache-2.0
"""How different two colors look: CIEDE2000, differentiable, its gradient finite everywhere."""

from __future__ import annotations

import math

import torch
from jaxtyping import Float
from torch import Tensor

from .tensors import lab_from_srgb

_TINY = 1e-12


def _length(*components: Tensor) -> Tensor:
    """Euclidean length whose gradient at zero is zero, not NaN."""
    squared = sum((c * c for c in components), torch.zeros_like(components[0]))
    return torch.where(squared > _TINY, squared.clamp_min(_TINY).sqrt(), torch.zeros_like(squared))


def _hue(b: Tensor, a: Tensor) -> Tensor:
    """Hue angle in radians, [0, 2π); 0 for a neutral color, with a zero gradient there."""
    neutral = (a.abs() < _TINY) & (b.abs() < _TINY)
    angle = torch.atan2(
        torch.where(neutral, torch.zeros_like(b), b), torch.where(neutral, torch.ones_like(a), a)
    )
    return torch.where(angle < 0, angle + 2 * math.pi, angle)


def ciede2000(
    lab1: Float[Tensor, "*#pixels 3"], lab2: Float[Tensor, "*#pixels 3"]
) -> Float[Tensor, "*#pixels"]:
    """Perceived difference (...) of two colors in Lab (..., 3): 1 is just visible.

    Source: Sharma, Wu, Dalal, "The CIEDE2000 color-difference formula", 2005; kL = kC = kH = 1.

    Args:
        lab1: (..., 3) CIE Lab, L in [0, 100].
        lab2: (..., 3), broadcast against the first.
    """
    (l1, a1, b1), (l2, a2, b2) = lab1.unbind(-1), lab2.unbind(-1)
    c7 = ((_length(a1, b1) + _length(a2, b2)) / 2) ** 7
    stretch = 1.5 - 0.5 * (c7 / (c7 + 25.0**7)).clamp_min(_TINY).sqrt()
    a1, a2 = a1 * stretch, a2 * stretch
    c1, c2 = _length(a1, b1), _length(a2, b2)
    h1, h2 = _hue(b1, a1), _hue(b2, a2)

    # The shorter way round the hue circle; a neutral color has no hue, so it takes the other's.
    neutral = c1 * c2 < _TINY
    turn = h2 - h1
    dh = turn - 2 * math.pi * torch.round(turn / (2 * math.pi)).detach()
    mean_h = torch.where(neutral, h1 + h2, h1 + dh / 2)
    delta_l, delta_c = l2 - l1, c2 - c1
    half_turn = torch.where(neutral, torch.zeros_like(dh), dh) / 2
    delta_h = (
        2 * torch.where(neutral, torch.zeros_like(c1), (c1 * c2).clamp_min(_TINY).sqrt()) * half_turn.sin()
    )

    mean_l, mean_c = (l1 + l2) / 2, (c1 + c2) / 2
    t = 1 - 0.17 * torch.cos(mean_h - math.radians(30)) + 0.24 * torch.cos(2 * mean_h)
    t = t + 0.32 * torch.cos(3 * mean_h + math.radians(6)) - 0.20 * torch.cos(4 * mean_h - math.radians(63))
    degrees = torch.rad2deg(torch.remainder(mean_h, 2 * math.pi))
    rotation = torch.deg2rad(60 * torch.exp(-(((degrees - 275) / 25) ** 2)))
    c7 = mean_c**7
    twist = -2 * (c7 / (c7 + 25.0**7)).clamp_min(_TINY).sqrt() * rotation.sin()
    from_middle = (mean_l - 50) ** 2
    dl = delta_l / (1 + 0.015 * from_middle / (20 + from_middle).sqrt())
    dc = delta_c / (1 + 0.045 * mean_c)
    dh = delta_h / (1 + 0.015 * mean_c * t)
    squared = dl * dl + dc * dc + dh * dh + twist * dc * dh
    return torch.where(squared > _TINY, squared.clamp_min(_TINY).sqrt(), torch.zeros_like(squared))


def mean_difference(
    display1: Float[Tensor, "*pixels 3"], display2: Float[Tensor, "*pixels 3"]
) -> Float[Tensor, ""]:
    """Mean CIEDE2000 (a scalar) of two sRGB-encoded pictures (..., 3) in [0, 1]."""
    return ciede2000(lab_from_srgb(display1), lab_from_srgb(display2)).mean()
