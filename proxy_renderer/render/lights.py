# SPDX-License-Identifier: Apache-2.0
"""Lights: where they stand, how bright they are, and what reaches a point, in Blender's calibration.

Formulas follow Cycles (kernel/light, scene/light.cpp). Intensities are per unit of `Lamp.color`,
so that everything geometric is constant while only power, color or temperature change.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import torch
from torch import Tensor

from ..scene import Light, SceneData
from . import color
from .camera import direction, frame
from .settings import Settings, wanted
from .vectors import cross, dot, length, unit, within
from .visibility import Geometry

_POINT_RADIUS = 1e-3
"""Least angular radius (radians) of a lamp: a true point would have no highlight in a mirror."""
_SOFT_RIM = 0.01
"""Radius of a spot, seen from a point, above which the rim of its cone is averaged over the lamp."""
_RIM_POINTS = 9


@dataclass(frozen=True)
class Glow:
    """How a glowing surface differs from a point that shines to all sides alike.

    Attributes:
        form: (3, 3) symmetric: the root of w.form.w is how brightly it shines to the unit vector w and to -w.
        lean: (3,) what it shines more to w than to -w, as a factor of w.
        blockers: The scene without it.
    """

    form: Tensor
    lean: Tensor
    blockers: Geometry

    def toward(self, way: Tensor) -> Tensor:
        """Intensity (N,) to unit vectors (3, N), 1 on average."""
        even = dot(way, self.form @ way).clamp_min(1e-12).sqrt()
        return (even + self.lean @ way).clamp_min(0.0)


@dataclass(frozen=True)
class Lamp:
    """A light in one render.

    Attributes:
        light: The scene's record.
        color: (3,) power or strength times color, temperature and exposure.
        position: (3,) in meters; for suns the pivot, which nothing depends on.
        axes: (3, 3) columns x, y, z of the lamp; it shines along -z.
        size: () radius of a point or spot, width of an area light, angle of a sun in radians.
        of_world: Whether it is a bright part of the world's picture.
        glow: What it is as a part of a glowing surface; None for a lamp.
        wide: Whether it is a large part of the world's picture.
    """

    light: Light
    color: Tensor
    position: Tensor
    axes: Tensor
    size: Tensor
    of_world: bool = False
    glow: Glow | None = None
    wide: bool = False

    @property
    def owner(self) -> str:
        """Whose parameters its color depends on: "light/NAME" or "world"; "" for what surfaces emit."""
        if self.glow:
            return ""
        return "world" if self.of_world else f"light/{self.light.name}"

    @property
    def pictured(self) -> bool:
        """Whether reflections show its image, so that it has no highlight."""
        return self.wide or self.glow is not None

    @property
    def moving(self) -> bool:
        """Whether gradients with respect to its place, direction or size are wanted."""
        return wanted(self.position, self.axes, self.size)

    @property
    def round(self) -> bool:
        """Whether its outline is a disc rather than a rectangle."""
        return self.light.type != "AREA" or self.light.shape in ("DISK", "ELLIPSE")

    @property
    def focused(self) -> bool:
        """Whether an area light shines into a narrower cone than a plain one."""
        return self.light.type == "AREA" and self.light.spread / 2 <= math.pi / 2 - 1e-3

    @property
    def area(self) -> Tensor:
        """Area () of an area light in square meters."""
        rectangle = self.size * self.size * self.light.aspect
        return (rectangle * (math.pi / 4 if self.round else 1.0)).clamp_min(1e-8)

    def signature(self) -> tuple[float, ...]:
        """Numbers that change when anything that shadows depend on does."""
        parts = torch.cat((self.position, self.axes.flatten(), self.size[None]))
        return tuple(parts.detach().tolist())

    def detached(self) -> Lamp:
        """The same lamp without gradients."""
        return replace(
            self,
            color=self.color.detach(),
            position=self.position.detach(),
            axes=self.axes.detach(),
            size=self.size.detach(),
        )


def lamps_of(scene: SceneData, settings: Settings) -> list[Lamp]:
    """All lights of the scene at the render's values."""
    return [_lamp(light, scene, settings) for light in scene.lights]


def _lamp(light: Light, scene: SceneData, settings: Settings) -> Lamp:
    key = f"light/{light.name}/"
    sun = light.type == "SUN"
    azimuth, elevation = settings.scalar(key + "azimuth"), settings.scalar(key + "elevation")
    power = settings.scalar(key + ("strength" if sun else "power"), 1.0)
    tint = settings.color(key + "color", 1.0) * (power * 2.0**light.exposure)
    temperature = settings.scalar(key + "temperature", 6500.0)
    if light.use_temperature or wanted(temperature) or float(temperature.detach()) != 6500.0:
        tint = tint * color.blackbody(temperature)
    if light.tint != (1.0, 1.0, 1.0):
        tint = tint * torch.tensor(light.tint, device=settings.device)
    pivot = torch.tensor(scene.pivot, device=settings.device)
    distance = 0.0 if sun else settings.scalar(key + "distance", 1.0)
    size = (
        torch.deg2rad(settings.scalar(key + "angle")) if sun else settings.scalar(key + "size") * light.scale
    )
    axes = frame(azimuth, elevation) @ torch.tensor(light.residual, device=settings.device)
    position = pivot + distance * direction(azimuth, elevation)
    return Lamp(light, tint, position, axes, within(size, 0.0, math.inf))


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
        frontal = frontal * _spot_cone(lamp, toward, lamp.size / distance)
    cosine = dot(normals, toward)
    radius2 = lamp.size * lamp.size
    if lamp.glow:
        frontal = frontal * lamp.glow.toward(-toward)
        cosine = _clipped_sphere(cosine, (radius2 / squared).clamp_max(1.0))
    cosine = cosine.clamp_min(0.0)
    solid = (math.pi * radius2 / squared).clamp(math.pi * _POINT_RADIUS**2, 2 * math.pi)
    return Arrival(toward, distance, frontal * cosine, frontal, solid)


def _spot_cone(lamp: Lamp, toward: Tensor, radius: Tensor | None = None) -> Tensor:
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
    spread = _mean_spread(lamp, points)
    irradiance = radiance * front * _polygon(lamp, points, normals) * spread
    return Arrival(toward, distance, irradiance, radiance * front * solid * spread, solid)


def _spread(lamp: Lamp, facing: Tensor) -> Tensor:
    """Cycles' attenuation of a focused area light, by the cosine to a point of it (kernel/light/area.h)."""
    if not lamp.focused:
        return torch.ones_like(facing)
    half = max(lamp.light.spread / 2, 1e-2)
    tangent = math.tan(half)
    angle = (1 / (facing * facing).clamp_min(1e-6) - 1).clamp_min(1e-12).sqrt()
    return ((tangent - angle) / (tangent - half)).clamp_min(0.0)


def _mean_spread(lamp: Lamp, points: Tensor) -> Tensor:
    """The same (N,), averaged over a lamp by Gauss and Legendre's rule as points (3, N) see its parts."""
    u, v = half_axes(lamp)
    total, weight = torch.zeros_like(points[0]), torch.full_like(points[0], 1e-12)
    for x, share_x in _GAUSS:
        for y, share_y in _GAUSS:
            offset = lamp.position[:, None] + u * x + v * y - points
            squared = dot(offset, offset).clamp_min(1e-8)
            facing = (dot(offset, lamp.axes[:, 2:3]) * squared.rsqrt()).clamp_min(0.0)
            seen = facing / squared * (share_x * share_y)
            total, weight = total + seen * _spread(lamp, facing), weight + seen
    return total / weight


_GAUSS = ((-0.861136, 0.173927), (-0.339981, 0.326073), (0.339981, 0.326073), (0.861136, 0.173927))


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


def half_axes(lamp: Lamp) -> tuple[Tensor, Tensor]:
    """Half the sides of an area light, (3, 1) each; a disc counts as a square of the same area."""
    half = lamp.size / 2 * (math.sqrt(math.pi) / 2 if lamp.round else 1.0)
    return lamp.axes[:, 0:1] * half, lamp.axes[:, 1:2] * (half * lamp.light.aspect)


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


def outline(lamp: Lamp, toward: Tensor, distance: Tensor, solid: Tensor, uv: Tensor) -> tuple[Tensor, Tensor]:
    """Points on a lamp to which shadow rays go.

    Args:
        lamp: The lamp.
        toward: (3, N) unit vectors to its center.
        distance: (N,) to its center.
        solid: (N,) its solid angle.
        uv: (2, N) in [0, 1), stratified.

    Returns:
        Unit directions (3, N) and distances (N,).
    """
    if lamp.light.type == "AREA" and not lamp.round:
        u, v = half_axes(lamp)
        offset = u * (2 * uv[0] - 1) + v * (2 * uv[1] - 1)
    else:
        radius, angle = uv[0].sqrt(), 2 * math.pi * uv[1]
        x, y = radius * angle.cos(), radius * angle.sin()
        if lamp.light.type == "AREA":
            offset = lamp.axes[:, 0:1] * (x * lamp.size / 2)
            offset = offset + lamp.axes[:, 1:2] * (y * lamp.size / 2 * lamp.light.aspect)
        else:
            reach = torch.where(distance.isinf(), torch.ones_like(distance), distance)
            across, up = tangents(toward)
            offset = (across * x + up * y) * (solid / math.pi).sqrt() * reach
    reach = torch.where(distance.isinf(), torch.ones_like(distance), distance)
    target = toward * reach + offset
    away = length(target)
    return target / away, torch.where(distance.isinf(), distance, away)


def tangents(normal: Tensor) -> tuple[Tensor, Tensor]:
    """Two unit vectors (3, N) that make a right-handed frame with unit vectors (3, N).

    Duff et al., "Building an Orthonormal Basis, Revisited", 2017.
    """
    x, y, z = normal.unbind(0)
    sign = torch.where(z < 0, -1.0, 1.0).to(z.dtype)
    a = -1.0 / (sign + z)
    b = x * y * a
    return torch.stack((1 + sign * x * x * a, sign * b, -sign * x)), torch.stack((b, sign + y * y * a, -y))
