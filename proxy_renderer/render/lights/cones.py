# SPDX-License-Identifier: Apache-2.0
"""Lamps that shine into a cone: spots, and area lights with a narrow spread."""

from __future__ import annotations

import math

import torch
from torch import Tensor

from ..geometry.vectors import dot
from .lamps import Lamp, half_axes

_SOFT_RIM = 0.01
"""Radius of a spot, seen from a point, above which the rim of its cone is averaged over the lamp."""
_RIM_POINTS = 9


def spot_cone(lamp: Lamp, toward: Tensor, radius: Tensor | None = None) -> Tensor:
    """Blender's smoothstep between the cone's rim and its blend (kernel/light/spot.h).

    Cycles evaluates it at the point of the lamp that it has sampled: a large lamp has a soft rim. The mean over
    the disc that faces a point needs only the offsets across the rim, which Gauss and Chebyshev's rule of the
    second kind weighs as a disc does.

    Args:
        lamp: The lamp.
        toward: (3, N) unit vectors to its center.
        radius: (N,) its radius as seen from the points, as a tangent; None for a small one.
    """
    edge = math.cos(lamp.light.spot_size / 2)
    slope = 1.0 / max((1.0 - edge) * lamp.light.spot_blend, 1e-5)
    cosine = dot(toward, lamp.axes[:, 2:3])
    if radius is None or not bool((radius > _SOFT_RIM).any()):
        return _smoothstep((cosine - edge) * slope)
    reach = radius * (1 - cosine * cosine).clamp_min(1e-6).sqrt()
    shrink = (1 + radius * radius / 2).rsqrt()
    result = torch.zeros_like(cosine)
    for k in range(1, _RIM_POINTS + 1):
        angle = k * math.pi / (_RIM_POINTS + 1)
        step = _smoothstep(((cosine + reach * math.cos(angle)) * shrink - edge) * slope)
        result = result + step * (2 / (_RIM_POINTS + 1) * math.sin(angle) ** 2)
    return result


def _smoothstep(t: Tensor) -> Tensor:
    t = t.clamp(0.0, 1.0)
    return t * t * (3 - 2 * t)


def spread(lamp: Lamp, facing: Tensor) -> Tensor:
    """Cycles' attenuation of a focused area light, by the cosine to a point of it (kernel/light/area.h)."""
    if not lamp.focused:
        return torch.ones_like(facing)
    half = max(lamp.light.spread / 2, 1e-2)
    tangent = math.tan(half)
    angle = (1 / (facing * facing).clamp_min(1e-6) - 1).clamp_min(1e-12).sqrt()
    return ((tangent - angle) / (tangent - half)).clamp_min(0.0)


def mean_spread(lamp: Lamp, points: Tensor) -> Tensor:
    """The same (N,), averaged over a lamp by Gauss and Legendre's rule as points (3, N) see its parts."""
    u, v = half_axes(lamp)
    total, weight = torch.zeros_like(points[0]), torch.full_like(points[0], 1e-12)
    for x, share_x in _GAUSS:
        for y, share_y in _GAUSS:
            offset = lamp.position[:, None] + u * x + v * y - points
            squared = dot(offset, offset).clamp_min(1e-8)
            facing = (dot(offset, lamp.axes[:, 2:3]) * squared.rsqrt()).clamp_min(0.0)
            seen = facing / squared * (share_x * share_y)
            total, weight = total + seen * spread(lamp, facing), weight + seen
    return total / weight


_GAUSS = ((-0.861136, 0.173927), (-0.339981, 0.326073), (0.339981, 0.326073), (0.861136, 0.173927))
