# SPDX-License-Identifier: Apache-2.0
"""Planar vectors (3, N), written out: torch reduces a leading axis of three an order slower than this.

Also two ways of limiting that keep gradients alive where `torch.clamp` would lose them.
"""

from __future__ import annotations

import torch
from torch import Tensor


def dot(a: Tensor, b: Tensor) -> Tensor:
    """Scalar products (N,) of vectors (3, N) or (3, 1)."""
    return torch.addcmul(torch.addcmul(a[0] * b[0], a[1], b[1]), a[2], b[2])


def length(a: Tensor, least: float = 1e-6) -> Tensor:
    """Lengths (N,), at least `least`, below which the gradient is zero."""
    return dot(a, a).clamp_min(least * least).sqrt()


def unit(a: Tensor, least: float = 1e-6) -> Tensor:
    """Vectors of length 1; what is shorter than `least` stays shorter than 1."""
    return a * dot(a, a).clamp_min(least * least).rsqrt()


def cross(a: Tensor, b: Tensor) -> Tensor:
    """Vector products (3, N) of vectors (3, N)."""
    x = a[1] * b[2] - a[2] * b[1]
    y = a[2] * b[0] - a[0] * b[2]
    return torch.stack((x, y, a[0] * b[1] - a[1] * b[0]))


def damped(value: Tensor, share: Tensor) -> Tensor:
    """The value itself, with its gradient multiplied by a share."""
    return torch.lerp(value.detach(), value, share.detach()) if value.requires_grad else value


def within(value: Tensor, low: float, high: float) -> Tensor:
    """Clamps; unlike `torch.clamp`, a value that lies on a bound keeps its gradient."""
    return torch.where(value < low, low, torch.where(value > high, high, value))
