# SPDX-License-Identifier: Apache-2.0
"""Highlights of lamps: a GGX lobe integrated over the lamp's outline, in closed form.

In the slope space of the half vector, s = (h_x, h_y) / h_z, GGX is the isotropic density
P(s) = 1 / (pi a^2 (1 + |s|^2 / a^2)^2) whatever the view. Its integral over a disc and over a
rectangle are the well-known view factors of a small patch to a parallel disc and rectangle.
A lamp's outline is carried to slope space and treated as one of the two there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor

from .albedo import basis
from .lights import Arrival, Lamp, half_axes, tangents
from .vectors import dot, unit

_LEAST_ALPHA = 2e-3


@dataclass(frozen=True)
class Highlight:
    """What a lamp's highlight at N points depends on, but for the material.

    Attributes:
        strength: (N,) frontal irradiance / (4 n.v cos^4 of the half vector), 0 below the horizon.
        curve: (7, N) albedo basis at the half vector, for Fresnel.
        slope_in, slope_out: (N,) squared tangents of the lamp's and the viewer's angle to the normal.
        outline: (2, N) squared slope and squared radius of a disc, or (4, N) left, right, bottom and top
            of a rectangle seen from the mirror direction, in slopes.
    """

    strength: Tensor
    curve: Tensor
    slope_in: Tensor
    slope_out: Tensor
    outline: Tensor

    def pick(self, index: slice) -> Highlight:
        """The points at an index."""
        parts = self.strength, self.curve, self.slope_in, self.slope_out, self.outline
        return Highlight(*(p[..., index] for p in parts))

    def times(self, visible: Tensor) -> Highlight:
        """The same, shadowed by visible shares (N,)."""
        strength = self.strength * visible
        return Highlight(strength, self.curve, self.slope_in, self.slope_out, self.outline)

    def lobe(self, roughness: Tensor) -> Tensor:
        """Reflected radiance (N,) per unit of the lamp's color, Fresnel aside, for one roughness ()."""
        alpha2 = (roughness * roughness).clamp_min(_LEAST_ALPHA) ** 2
        masked = (1 + alpha2 * self.slope_in).sqrt() + (1 + alpha2 * self.slope_out).sqrt()
        mean = _disc_mean(self.outline, alpha2) if len(self.outline) == 2 else _box_mean(self.outline, alpha2)
        return self.strength * mean * (2 / masked)


def highlight(lamp: Lamp, arriving: Arrival, points: Tensor, normal: Tensor, view: Tensor) -> Highlight:
    """The highlight of a lamp, unshadowed, at points (3, N) seen along `view` (3, N), towards the eye."""
    into = dot(normal, arriving.toward)
    out = dot(normal, view).clamp_min(1e-3)
    half = unit(arriving.toward + view, 1e-4)
    up = dot(half, normal).clamp_min(1e-2)
    aside = dot(half, view).clamp(1e-3, 1.0)
    lit = torch.where(into > 0, arriving.frontal, 0.0)
    if lamp.round:
        squared = (1 / (up * up) - 1).clamp_min(0.0)
        radius2 = arriving.solid_angle / (4 * math.pi * aside * up**3)
        outline = torch.stack((squared, radius2))
    else:
        outline = _box(lamp, points, normal, view, arriving)
    safe_into = into.clamp_min(1e-2)
    tan_in = (1 / (safe_into * safe_into) - 1).clamp_min(0.0)
    tan_out = (1 / (out * out) - 1).clamp_min(0.0)
    strength = lit / (4 * out * up**4)
    return Highlight(strength, basis(aside), tan_in, tan_out, outline)


def _box(lamp: Lamp, points: Tensor, normal: Tensor, view: Tensor, arriving: Arrival) -> Tensor:
    """A rectangular lamp in slope space, as an upright box around its center with the origin's offset."""
    across, up = tangents(normal)
    center = lamp.position[:, None] - points
    u, v = half_axes(lamp)

    def slope(offset: Tensor) -> Tensor:
        half = unit(offset) + view
        height = dot(half, normal).clamp_min(2e-2)
        return torch.stack((dot(half, across), dot(half, up))) / height

    middle = slope(center)
    e1 = (slope(center + u) - slope(center - u)) / 2
    e2 = (slope(center + v) - slope(center - v)) / 2
    area = (e1[0] * e2[1] - e1[1] * e2[0]).abs().clamp_min(1e-10)
    wide = (e1[0] * e1[0] + e1[1] * e1[1]).clamp_min(1e-10).sqrt()
    high = (area / wide).clamp_min(1e-5)
    sign = torch.where(e1[0] * e2[1] - e1[1] * e2[0] < 0, -1.0, 1.0)
    # The origin in coordinates along e1 and across it.
    x = -(middle[0] * e1[0] + middle[1] * e1[1]) / wide
    y = -(e1[0] * middle[1] - e1[1] * middle[0]) / wide * sign
    # Shear: the box leans with e2; follow it at the origin's height.
    x = x - y * (e1[0] * e2[0] + e1[1] * e2[1]) / wide / high
    return torch.stack((-wide - x, wide - x, -high - y, high - y))


def _disc_mean(outline: Tensor, alpha2: Tensor) -> Tensor:
    """Mean of the lobe over a disc: view factor of a parallel disc, over its area, without cancellation."""
    d, a = outline[0] / alpha2, outline[1] / alpha2
    sum_ = 1 + d + a
    q = (sum_ * sum_ - 4 * a * d).clamp_min(1e-12).sqrt()
    inside = a > 1 + d
    far = 2 / (q * torch.where(inside, 1.0, q + 1 + d - a))
    near = (1 + (a - 1 - d) / q) / (2 * a)
    return torch.where(inside, near, far) / (math.pi * alpha2)


def _box_mean(outline: Tensor, alpha2: Tensor) -> Tensor:
    """Mean of the lobe over a rectangle: view factor of a parallel rectangle, over its area."""
    left, right, bottom, top = (outline / alpha2.sqrt()).unbind(0)
    whole = _corner(right, top) - _corner(left, top) - _corner(right, bottom) + _corner(left, bottom)
    area = (right - left) * (top - bottom) * alpha2
    # Far off the lobe the corners cancel: there the density at the middle is as good.
    x, y = (left + right) / 2, (bottom + top) / 2
    middle = 1 / (math.pi * alpha2 * (1 + x * x + y * y) ** 2)
    small = (right - left) * (top - bottom) < 0.02 * (1 + x * x + y * y)
    return torch.where(small, middle, whole.clamp_min(0.0) / area.clamp_min(1e-20))


def _corner(x: Tensor, y: Tensor) -> Tensor:
    """Integral of the unit lobe from the origin to (x, y), over a quarter plane at most 1/4."""
    p, q = (1 + x * x).rsqrt(), (1 + y * y).rsqrt()
    return (x * p * torch.atan(y * p) + y * q * torch.atan(x * q)) / (2 * math.pi)
