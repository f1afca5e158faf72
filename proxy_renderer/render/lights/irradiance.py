# SPDX-License-Identifier: Apache-2.0
"""What reaches a point from a lamp, unshadowed.

Formulas follow Cycles (kernel/light, scene/light.cpp). Intensities are per unit of `Lamp.color`,
so that everything geometric is constant while only power, color or temperature change.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor

from ..geometry.vectors import cross, dot, length, unit, within
from .cones import mean_spread, spot_cone
from .lamps import Lamp, half_axes

_POINT_RADIUS = 1e-3
"""Least angular radius (radians) of a lamp: a true point would have no highlight in a mirror."""


@dataclass(frozen=True)
class Arrival:
    """What reaches N points from one lamp, unshadowed, per unit of its color.

    Attributes:
        toward: (3, N) unit vectors to the lamp's center.
        distance: (N,) to the lamp's center; infinite for suns.
        irradiance: (N,) on the surface, cosine included.
        frontal: (N,) on a surface that faces the lamp: radiance times solid angle.
        solid_angle: (N,) that the lamp fills.
    """

    toward: Tensor
    distance: Tensor
    irradiance: Tensor
    frontal: Tensor
    solid_angle: Tensor


def arrival(lamp: Lamp, points: Tensor, normals: Tensor) -> Arrival:
    """Unshadowed light at points (3, N) with unit normals (3, N)."""
    if lamp.light.type == "SUN":
        return _sun(lamp, normals)
    offset = lamp.position[:, None] - points
    squared = dot(offset, offset).clamp_min(1e-8)
    distance = squared.sqrt()
    toward = offset / distance
    if lamp.light.type == "AREA":
        return _area(lamp, points, normals, toward, distance, squared)
    return _point(lamp, normals, toward, distance, squared)


def _sun(lamp: Lamp, normals: Tensor) -> Arrival:
    """A sun's strength is the irradiance of a surface that faces it."""
    z = lamp.axes[:, 2:3]
    cosine = dot(normals, z).clamp_min(0.0)
    half = within(lamp.size / 2, _POINT_RADIUS, math.pi / 2)
    one = torch.ones_like(cosine)
    solid = 2 * math.pi * (1 - half.cos())
    return Arrival(z.expand_as(normals), one * math.inf, cosine, one, one * solid)


def _point(lamp: Lamp, normals: Tensor, toward: Tensor, distance: Tensor, squared: Tensor) -> Arrival:
    """Point and spot: power / 4 pi d^2, which Blender's soft falloff (its default) lowers near large lamps.

    With it Cycles takes the lamp for a disc that faces the point, whose view factor is r^2 / (d^2 + r^2);
    without it for a sphere, whose view factor from outside is r^2 / d^2.
    """
    area = lamp.size * lamp.size
    frontal = 1.0 / (
        4 * math.pi * (squared + area if lamp.light.soft_falloff else torch.maximum(squared, area))
    )
    if not lamp.light.normalize:
        frontal = frontal * (4 * math.pi * lamp.size * lamp.size)
    if lamp.light.type == "SPOT":
        frontal = frontal * spot_cone(lamp, toward, lamp.size / distance)
    cosine = dot(normals, toward)
    radius2 = lamp.size * lamp.size
    if lamp.glow:
        frontal = frontal * lamp.glow.toward(-toward)
        cosine = _clipped_sphere(cosine, (radius2 / squared).clamp_max(1.0))
    cosine = cosine.clamp_min(0.0)
    solid = (math.pi * radius2 / squared).clamp(math.pi * _POINT_RADIUS**2, 2 * math.pi)
    return Arrival(toward, distance, frontal * cosine, frontal, solid)


def _area(
    lamp: Lamp, points: Tensor, normals: Tensor, toward: Tensor, distance: Tensor, squared: Tensor
) -> Arrival:
    """Area light: radiance power / (pi area) on the side that it shines to."""
    facing = dot(toward, lamp.axes[:, 2:3]).clamp_min(0.0)
    radiance = 1.0 / (math.pi * (lamp.area if lamp.light.normalize else 1.0))
    solid = (lamp.area * facing / (squared + lamp.area / math.pi)).clamp_min(1e-7)
    front = (facing > 0).to(facing.dtype)
    if not lamp.focused:
        irradiance = radiance * front * _polygon(lamp, points, normals)
        return Arrival(toward, distance, irradiance, radiance * front * solid, solid)
    spread = mean_spread(lamp, points)
    irradiance = radiance * front * _polygon(lamp, points, normals) * spread
    return Arrival(toward, distance, irradiance, radiance * front * solid * spread, solid)


def _polygon(lamp: Lamp, points: Tensor, normals: Tensor) -> Tensor:
    """Irradiance (N,) from a rectangle of radiance 1: Lambert's formula, clipped at the horizon.

    The clipped part follows Hill and Heitz's sphere approximation ("Real-Time Area Lighting", 2016).
    Discs count as squares of the same area.
    """
    half = half_axes(lamp)
    corners = [lamp.position[:, None] + half[0] * sx + half[1] * sy - points for sx, sy in _CORNERS]
    corners = [unit(c) for c in corners]
    flux = torch.zeros_like(points)
    for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
        cosine = dot(a, b).clamp(-0.99999, 0.99999)
        flux = flux + cross(a, b) * _theta_over_sine(cosine)
    flux = flux * 0.5
    size = length(flux, 1e-9)
    cosine = dot(flux, normals) / size
    return size * _clipped_sphere(cosine, (size / math.pi).clamp_max(1.0))


_CORNERS = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))


def _theta_over_sine(cosine: Tensor) -> Tensor:
    """theta / sin(theta) for cos(theta)."""
    return torch.arccos(cosine) / (1 - cosine * cosine).sqrt()


def _clipped_sphere(cosine: Tensor, share: Tensor) -> Tensor:
    """Cosine-weighted part of a sphere above the horizon, relative to the unclipped vector flux.

    A sphere with sin^2(radius) = share and its center at this cosine. Fully above: the cosine;
    in between a smooth blend that meets both ends with the right slope.
    """
    sine = share.clamp_min(1e-8).sqrt()
    t = (cosine / sine).clamp(-1.0, 1.0)
    partial = sine * (1 + t) * (1 + t) / 4
    return torch.where(cosine > sine, cosine, partial)
