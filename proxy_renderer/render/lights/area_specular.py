# SPDX-License-Identifier: Apache-2.0
"""Highlights of lights: a GGX lobe integrated over the light's outline, in closed form.

In the slope space of the half vector, s = (h_x, h_y) / h_z, GGX is the isotropic density P(s) = 1 / (pi a^2 (1 + |s|^2 / a^2)^2)
for any view. Its integral over a disc and over a rectangle are the well-known view factors of a small patch to a parallel disc
and rectangle. A light's outline is mapped to slope space, where it is approximated by an ellipse or a rectangle. The mirror
direction is the origin there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import torch
from jaxtyping import Float
from torch import Tensor

from ...scene.values import Recent, needs_gradient
from ..geometry.vectors import PointSet, dot, tangents, unit
from ..material.albedo import basis
from .light_source import DirectIrradiance, LightSource, Vectors

_LEAST_ALPHA = 2e-3  # least alpha, which is the roughness squared
_PAIRS = ((0, 0), (1, 1), (0, 1))
_LEAST_UP = 0.08  # least cosine between half vector and normal: at 0, slopes are infinite


@dataclass(frozen=True)
class AreaSpecular(PointSet):
    """A light's highlight at N points, before roughness and Fresnel of the material."""

    strength: Float[Tensor, " n"]  # (N,) the light's radiance times (h.v) / (n.v n.h), 0 below the horizon
    curve: Float[Tensor, "7 n"]  # (7, N) albedo basis at the half vector, for Fresnel
    slope_in: Float[Tensor, " n"]  # (N,) squared tangent of the angle between light and normal
    slope_out: Float[Tensor, " n"]  # (N,) squared tangent of the angle between viewer and normal
    # in slopes from the mirror direction: (4, N) left, right, bottom and top of a rectangle, or (5, N) an
    # ellipse, see `_round_place`
    outline: Float[Tensor, "outline n"]
    _lobes: Recent = field(default_factory=Recent, init=False, repr=False, compare=False)

    def times(self, visible: Float[Tensor, " n"]) -> AreaSpecular:
        """A copy whose strength is multiplied by `visible` (N,), the share of the light that each point sees."""
        return replace(self, strength=self.strength * visible)

    def lobe(self, roughness: Float[Tensor, "*varying"]) -> Float[Tensor, " n"]:
        """Reflected radiance (N,) per unit of color, without Fresnel, for a roughness () or (N,); cached."""
        if needs_gradient(roughness, self.strength, self.outline):
            return self._lobe(roughness)
        key = id(roughness) if roughness.dim() else float(roughness)
        return self._lobes.of("", key, lambda: self._lobe(roughness))  # `Recent` keeps two: base and coat

    def _lobe(self, roughness: Tensor) -> Tensor:
        alpha2 = (roughness * roughness).clamp_min(_LEAST_ALPHA) ** 2
        masked = (1 + alpha2 * self.slope_in).sqrt() + (1 + alpha2 * self.slope_out).sqrt()
        covered = _box(self.outline, alpha2) if len(self.outline) == 4 else _ellipse(self.outline, alpha2)
        return self.strength * covered * (2 / masked)


def area_specular(
    lamp: LightSource, direct: DirectIrradiance, points: Vectors, normal: Vectors, view: Vectors
) -> AreaSpecular:
    """The unshadowed highlight of a light at points (3, N); `view` (3, N) are unit directions from there to the eye.

    Terms of the half vector are taken for the point of the light that is nearest to the mirror direction.
    """
    out = dot(normal, view).clamp_min(2e-2)
    sides = lamp.half_sides()
    if sides is None:
        outline, slope2, aside = _round_place(direct, normal, view, out)
    else:
        outline, slope2, aside = _box_place(lamp.position[:, None] - points, sides, normal, view, out)
    up = (1 + slope2).rsqrt()
    at_half = (aside * up).clamp(1e-3, 1.0)
    into = (2 * at_half * up - out).clamp_min(1e-2)
    front = (dot(normal, direct.toward) > 0) | (2 * at_half * up > out)
    radiance = torch.where(front, direct.frontal / direct.solid_angle, 0.0)
    tan_in, tan_out = (1 / (c * c) - 1 for c in (into, out))
    return AreaSpecular(radiance * at_half / (out * up), basis(at_half), tan_in, tan_out, outline)


def _round_place(direct: DirectIrradiance, normal: Tensor, view: Tensor, out: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """A round light in slope space: outline (5, N), squared slope (N,) of its nearest point, and h.v / h.n (N,) there.

    Nearest means nearest to the mirror direction. In slope space the light is an ellipse. The flatter the surface is
    seen, the longer the ellipse is across the plane of reflection. The rows of the outline are: the squared slope of
    the ellipse's middle; its squared radius from the middle towards the mirror direction; the squared slope of its
    nearest point; its squared area relative to a disc of that radius; the sum of its squared half axes.
    """
    half = unit(direct.toward + view, 1e-4)
    up = dot(half, normal).clamp_min(_LEAST_UP)
    aside = dot(half, view).clamp(1e-3, 1.0)
    squared = (1 / (up * up) - 1).clamp_min(0.0)
    slope = squared.clamp_min(1e-8).sqrt()
    across, upwards = tangents(normal)
    x, y = dot(half, across) / up, dot(half, upwards) / up
    # Derivatives of the half vector's slope along two axes of the light's disc.
    sides = [
        ((dot(e, across) - x * dot(e, normal)), (dot(e, upwards) - y * dot(e, normal))) for e in tangents(direct.toward)
    ]
    scale = direct.solid_angle / (4 * math.pi * (aside * up) ** 2)
    xx, yy, xy = (scale * (sides[0][i] * sides[0][k] + sides[1][i] * sides[1][k]) for i, k in _PAIRS)
    product = direct.solid_angle / (4 * math.pi * aside * up**3)  # of the ellipse's half axes
    head_on = x * x + y * y < 1e-8
    x, y = torch.where(head_on, slope, x), torch.where(head_on, 0.0, y)
    radius = product * slope * (yy * x * x - 2 * xy * x * y + xx * y * y).clamp_min(1e-20).rsqrt()
    # Slopes are tangents, so that the radius is smaller on the side of the normal.
    radius = radius / (1 + radius * slope / (1 + squared))
    radius2 = radius * radius
    nearest = (slope - radius).clamp_min(0.0)
    along = (aside / up - out) / slope  # the view's component along the light's slope
    outline = torch.stack((squared, radius2, nearest * nearest, (product / radius2) ** 2, xx + yy))
    return outline, nearest * nearest, out + nearest * along


def _box_place(
    center: Tensor, sides: tuple[Tensor, Tensor], normal: Tensor, view: Tensor, out: Tensor
) -> tuple[Tensor, Tensor, Tensor]:
    """As `_round_place` for a rectangular light: the outline (4, N) is a rectangle through the middles of the light's sides."""
    across, up = tangents(normal)
    u, v = sides

    def slope(offset: Tensor) -> Tensor:
        half = unit(unit(offset) + view, 1e-4)
        return torch.stack((dot(half, across), dot(half, up))) / dot(half, normal).clamp_min(_LEAST_UP)

    left, right, bottom, top = (slope(center + o) for o in (-u, u, -v, v))
    e = right - left
    e = e / (e[0] * e[0] + e[1] * e[1]).clamp_min(1e-12).sqrt()
    # Coordinates along the first axis and across it, on whichever side the second axis lies.
    side = torch.where(e[0] * (top - bottom)[1] < e[1] * (top - bottom)[0], -1.0, 1.0)
    x0, x1 = (e[0] * p[0] + e[1] * p[1] for p in (left, right))
    y0, y1 = (side * (e[0] * p[1] - e[1] * p[0]) for p in (bottom, top))
    # If the axes are not perpendicular, the box is shifted to fit at the height of the mirror direction.
    lean = (e[0] * (top - bottom)[0] + e[1] * (top - bottom)[1]) / (y1 - y0).clamp_min(1e-6)
    shift = lean.clamp(-2.0, 2.0) * ((y0 + y1) / 2).clamp(-1.0, 1.0)
    x0, x1 = x0 - shift, x1 - shift
    outline = torch.stack((x0, torch.maximum(x1, x0 + 1e-5), y0, torch.maximum(y1, y0 + 1e-5)))
    x, y = x0.clamp_min(0.0) + x1.clamp_max(0.0), y0.clamp_min(0.0) + y1.clamp_max(0.0)
    sideways, upwards = dot(view, across), dot(view, up)
    along = x * (e[0] * sideways + e[1] * upwards) + y * side * (e[0] * upwards - e[1] * sideways)
    return outline, x * x + y * y, out + along


def _ellipse(outline: Tensor, alpha2: Tensor) -> Tensor:
    """Integral (N,) of the lobe over an ellipse, `outline` (5, N): exact around the mirror direction and far from it.

    In between, it is the integral over a disc that reaches as far towards the mirror direction, times the share of the lobe's
    width that the ellipse fills.
    """
    near = 1 + outline[2] / alpha2
    radius2, axes2 = outline[1] / alpha2, outline[4] / alpha2
    share = outline[3] * (radius2 + near) ** 2 / (outline[3] * radius2 * radius2 + near * (axes2 + near))
    return _disc(outline[0] / alpha2, radius2) * share.sqrt()


def _disc(d: Tensor, a: Tensor) -> Tensor:
    """Integral of the lobe over a disc: the view factor of a parallel disc, written without cancellation.

    `d` (N,) is the squared distance of its middle from the mirror direction, `a` (N,) its squared radius, both over alpha².
    """
    total = 1 + d + a
    q = (total * total - 4 * a * d).clamp_min(1e-12).sqrt()
    inside = a > 1 + d
    far = 2 * a / (q * torch.where(inside, 1.0, q + 1 + d - a))
    return torch.where(inside, (1 + (a - 1 - d) / q) / 2, far)


def _box(outline: Tensor, alpha2: Tensor) -> Tensor:
    """Integral (N,) of the lobe over a rectangle, `outline` (4, N): the view factor of a parallel rectangle."""
    left, right, bottom, top = (outline * alpha2.rsqrt()).unbind(0)
    whole = _corner(right, top) - _corner(left, top) - _corner(right, bottom) + _corner(left, bottom)
    # Far from the lobe the corners' terms cancel: there, area times density at the middle is used.
    area = (right - left) * (top - bottom)
    x, y = (left + right) / 2, (bottom + top) / 2
    far = 1 + x * x + y * y
    return torch.where(area < 0.006 * far, area / (math.pi * far * far), whole.clamp_min(0.0))


def _corner(x: Tensor, y: Tensor) -> Tensor:
    """Integral of a lobe of width 1 over the rectangle from the origin to (x, y); a whole quadrant has 1/4."""
    p, q = (1 + x * x).rsqrt(), (1 + y * y).rsqrt()
    return (x * p * torch.atan(y * p) + y * q * torch.atan(x * q)) / (2 * math.pi)
