# SPDX-License-Identifier: Apache-2.0
"""Planar vectors (3, N), computed by component: ten times faster than torch's reductions over an axis of three."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Self

import torch
from torch import Tensor


@dataclass(frozen=True)
class PointSet:
    """Base of dataclasses about N points or rays: the last axis of each field counts them."""

    def pick(self, index: Tensor | slice) -> Self:
        """A copy with only the points at an index: numbers (n,), bool (N,), or a slice."""
        parts = (getattr(self, each.name) for each in fields(self) if each.init)
        return type(self)(*(p.pick(index) if isinstance(p, PointSet) else p[..., index] for p in parts))

    @classmethod
    def joined(cls, several: Sequence[Self]) -> Self:
        """The points of several sets, one after the other."""
        columns = ([getattr(one, each.name) for one in several] for each in fields(cls) if each.init)
        return cls(*(c[0].joined(c) if isinstance(c[0], PointSet) else torch.cat(c, -1) for c in columns))


def dot(a: Tensor, b: Tensor) -> Tensor:
    """Scalar products (N,) of vectors (3, N) or (3, 1)."""
    if torch.is_grad_enabled() and (a.requires_grad or b.requires_grad):
        return _Dot.apply(a, b)
    return _dot(a, b)


def _dot(a: Tensor, b: Tensor) -> Tensor:
    return torch.addcmul(torch.addcmul(a[0] * b[0], a[1], b[1]), a[2], b[2])


class _Dot(torch.autograd.Function):
    """Scalar product with its own gradient: autograd would allocate zeros for every component that is indexed."""

    @staticmethod
    def forward(ctx, a, b):
        ctx.save_for_backward(a, b)
        return _dot(a, b)

    @staticmethod
    def backward(ctx, gradient):
        a, b = ctx.saved_tensors
        of_a, of_b = ctx.needs_input_grad
        pairs = (of_a, a, b), (of_b, b, a)
        return tuple((gradient * two).sum_to_size(one.shape) if needed else None for needed, one, two in pairs)


def length(a: Tensor, least: float = 1e-6) -> Tensor:
    """Lengths (N,) of vectors (3, N), but at least `least`; shorter vectors have a zero gradient."""
    return dot(a, a).clamp_min(least * least).sqrt()


def unit(a: Tensor, least: float = 1e-6) -> Tensor:
    """Vectors (3, N) scaled to unit length; vectors shorter than `least` get a length below 1."""
    return a * dot(a, a).clamp_min(least * least).rsqrt()


def cross(a: Tensor, b: Tensor) -> Tensor:
    """Vector products (3, N) of vectors (3, N)."""
    (ax, ay, az), (bx, by, bz) = a.unbind(0), b.unbind(0)
    return torch.stack((ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx))


def within(value: Tensor, low: float, high: float) -> Tensor:
    """Values clamped to [low, high]; unlike `torch.clamp`, a value that lies on a bound keeps its gradient."""
    return torch.where(value < low, low, torch.where(value > high, high, value))


def tangents(normal: Tensor) -> tuple[Tensor, Tensor]:
    """Two unit tangents, (3, N) each, that form a right-handed frame with unit normals (3, N) (Duff et al. 2017)."""
    x, y, z = normal.unbind(0)
    sign = torch.where(z < 0, -1.0, 1.0).to(z.dtype)
    a = -1.0 / (sign + z)
    b = x * y * a
    return torch.stack((1 + sign * x * x * a, sign * b, -sign * x)), torch.stack((b, sign + y * y * a, -y))


def reflect(toward: Tensor, normal: Tensor) -> Tensor:
    """Mirror directions (3, N) of rays (3, N) at unit normals (3, N)."""
    return toward - normal * (2 * dot(toward, normal))


def above(toward: Tensor, facet: Tensor) -> Tensor:
    """Unit directions (3, N), lifted to just above the surface of unit normals `facet` if they would enter it."""
    return unit(toward + facet * (0.01 - dot(toward, facet)).clamp_min(0.0))


def cosine_directions(normal: Tensor, uv: Tensor) -> Tensor:
    """Cosine-distributed unit directions (3, N) around unit normals (3, N), from uniform points (2, N) in [0, 1)^2."""
    radius, angle = uv[0].sqrt(), 2 * math.pi * uv[1]
    across, up = tangents(normal)
    return across * (radius * angle.cos()) + up * (radius * angle.sin()) + normal * (1 - uv[0]).sqrt()


def overlap(shift: int, size: int) -> tuple[slice, slice]:
    """Slices of an axis of `size` pixels: the pixels that have a neighbor at an offset `shift`, and the neighbors."""
    return slice(max(0, -shift), size - max(0, shift)), slice(max(0, shift), size - max(0, -shift))


def texels(height: int, width: int, device: torch.device) -> tuple[Tensor, Tensor]:
    """Directions (3, T) and solid angles (T,) in steradians of an equirectangular image's texels, bottom row first."""
    v = (torch.arange(height, device=device) + 0.5) / height
    u = (torch.arange(width, device=device) + 0.5) / width
    elevation, angle = torch.meshgrid((v - 0.5) * math.pi, (0.5 - u) * 2 * math.pi, indexing="ij")
    flat = elevation.cos()
    toward = torch.stack((flat * angle.cos(), flat * angle.sin(), elevation.sin())).flatten(1)
    return toward, flat.flatten() * (math.pi / height) * (2 * math.pi / width)
