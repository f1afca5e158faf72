# SPDX-License-Identifier: Apache-2.0
"""The types of light that the renderer knows. A new one is a class here and a row in `LIGHT_TYPES`."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import partial
from typing import Any, ClassVar

import torch
from jaxtyping import Float
from torch import Tensor

from ...scene import Light, SceneData
from ...scene.values import Recent, RenderValues
from ..geometry.camera import RaySegments
from ..geometry.vectors import cross, dot, length, unit, within
from .light_source import (
    POINT_RADIUS,
    DirectIrradiance,
    LightSource,
    Numbers,
    SegmentLight,
    Vectors,
    clipped_sphere,
    disc_offsets,
    equiangular,
    offsets,
)

_SOFT_RIM = 0.01  # radius of a spot over its distance from which its cone's rim is averaged over the light
_RIM_POINTS = 9
_CORNERS = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
_GAUSS = ((-0.861136, 0.173927), (-0.339981, 0.326073), (0.339981, 0.326073), (0.861136, 0.173927))
"""Places in [-1, 1] and weights, whose sum is 1, of Gauss-Legendre quadrature."""


@dataclass(frozen=True)
class PointLight(LightSource):
    """A sphere of radius `size`; its energy is its power in watts."""

    clipped: ClassVar[bool] = False  # whether only its part above a surface's horizon counts

    def irradiance(self, points: Vectors, normals: Vectors) -> DirectIrradiance:
        """Power / (4 pi d^2), which Blender's soft falloff (its default) lowers near large lights.

        With soft falloff, Cycles takes the light for a disc that faces the point, whose view factor is r^2 / (d^2 + r^2). Without
        it, Cycles takes the light for a sphere, whose view factor from outside is r^2 / d^2 (kernel/light/point.h).
        """
        toward, distance, squared = offsets(self.position, points)
        near2 = self.size * self.size
        near2 = squared + near2 if self.light.soft_falloff else torch.maximum(squared, near2)
        frontal = 1.0 / (4 * math.pi * near2)
        if not self.light.normalize:
            frontal = frontal * (4 * math.pi * self.size * self.size)
        frontal = frontal * self.directivity(toward, self.size / distance)
        cosine, radius2 = dot(normals, toward), self.size * self.size
        if self.clipped:
            cosine = clipped_sphere(cosine, (radius2 / squared).clamp_max(1.0))
        solid = (math.pi * radius2 / squared).clamp(math.pi * POINT_RADIUS**2, 2 * math.pi)
        return DirectIrradiance(toward, distance, frontal * cosine.clamp_min(0.0), frontal, solid)

    def directivity(self, toward: Vectors, radius: Numbers | None = None) -> Numbers:
        """Intensity (N,) toward N points, relative to an isotropic light; `toward` (3, N) are directions to the light.

        `radius` (N,) is the light's radius over its distance; None for a small light.
        """
        return torch.ones_like(toward[0])

    def shadow_targets(self, direct: DirectIrradiance, uv: Float[Tensor, "2 n"]) -> tuple[Vectors, Numbers]:
        """See `LightSource.shadow_targets`: points of the disc that faces the shaded point."""
        target = direct.toward * direct.distance + disc_offsets(direct.toward, direct.solid_angle, uv) * direct.distance
        away = length(target)
        return target / away, away

    def in_scattering(self, segments: RaySegments, parts: int) -> SegmentLight:
        """See `LightSource.in_scattering`."""
        even = (1.0 if self.light.normalize else 4 * math.pi * (self.size * self.size)) / (4 * math.pi)
        place = segments, self.position, self.size * 0.5, None, parts
        return equiangular(*place, lambda toward: even * self.directivity(toward))


@dataclass(frozen=True)
class SpotLight(PointLight):
    """A point light that shines into a cone; inside it is as bright as a point light of the same power."""

    cone: Float[Tensor, ""] = field(kw_only=True)  # () full opening angle, radians
    segment_parts: ClassVar[int] = 4  # its cone has an edge

    @classmethod
    def of(cls, light: Light, scene: SceneData, values: RenderValues, **more: Any) -> SpotLight:
        """See `LightSource.of`."""
        opening = values.scalar(f"light/{light.name}/cone", math.degrees(light.spot_size))
        return super().of(light, scene, values, cone=torch.deg2rad(opening), **more)

    @property
    def placement(self) -> dict[str, Tensor]:
        """See `LightSource.placement`."""
        return {**super().placement, "cone": self.cone}

    def directivity(self, toward: Vectors, radius: Numbers | None = None) -> Numbers:
        """Blender's smoothstep from the cone's rim inwards; arguments and result: see `PointLight.directivity`.

        Cycles evaluates the smoothstep at a sampled point of the light, so that a large light has a soft rim. Here it is averaged
        over the disc that faces the lit point. Only offsets across the rim matter: Gauss-Chebyshev quadrature of the second kind
        weights them as a disc does.
        """
        edge = torch.cos(self.cone / 2)
        slope = 1.0 / ((1.0 - edge) * self.light.spot_blend).clamp_min(1e-5)
        cosine = dot(toward, self.axes[:, 2:3])
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


@dataclass(frozen=True)
class AreaLight(LightSource):
    """A flat light; its energy is its power in watts, its radiance power / (pi area)."""

    @property
    def round(self) -> bool:
        """True if its outline is an ellipse rather than a rectangle."""
        return self.light.shape in ("DISK", "ELLIPSE")

    @property
    def focused(self) -> bool:
        """True if its light is narrower than a hemisphere (Blender's spread below 180 degrees)."""
        return self.light.spread / 2 <= math.pi / 2 - 1e-3

    @property
    def area(self) -> Float[Tensor, ""]:
        """Area () in square meters."""
        rectangle = self.size * self.size * self.light.aspect
        return (rectangle * (math.pi / 4 if self.round else 1.0)).clamp_min(1e-8)

    def half_axes(self) -> tuple[Float[Tensor, "3 1"], Float[Tensor, "3 1"]]:
        """Half the sides, (3, 1) each; an ellipse counts as a rectangle of the same area."""
        half = self.size / 2 * (math.sqrt(math.pi) / 2 if self.round else 1.0)
        return self.axes[:, 0:1] * half, self.axes[:, 1:2] * (half * self.light.aspect)

    def half_sides(self) -> tuple[Float[Tensor, "3 1"], Float[Tensor, "3 1"]] | None:
        """See `LightSource.half_sides`."""
        return None if self.round else self.half_axes()

    def irradiance(self, points: Vectors, normals: Vectors) -> DirectIrradiance:
        """See `LightSource.irradiance`."""
        toward, distance, squared = offsets(self.position, points)
        facing = dot(toward, self.axes[:, 2:3]).clamp_min(0.0)
        radiance = 1.0 / (math.pi * (self.area if self.light.normalize else 1.0))
        solid = (self.area * facing / (squared + self.area / math.pi)).clamp_min(1e-7)
        front = (facing > 0).to(facing.dtype)
        irradiance, frontal = radiance * front * self._polygon(points, normals), radiance * front * solid
        if self.focused:
            spread = self._mean_spread(points)
            irradiance, frontal = irradiance * spread, frontal * spread
        return DirectIrradiance(toward, distance, irradiance, frontal, solid)

    def shadow_targets(self, direct: DirectIrradiance, uv: Float[Tensor, "2 n"]) -> tuple[Vectors, Numbers]:
        """See `LightSource.shadow_targets`."""
        if self.round:
            radius, angle = uv[0].sqrt(), 2 * math.pi * uv[1]
            offset = self.axes[:, 0:1] * (radius * angle.cos() * self.size / 2)
            offset = offset + self.axes[:, 1:2] * (radius * angle.sin() * self.size / 2 * self.light.aspect)
        else:
            u, v = self.half_axes()
            offset = u * (2 * uv[0] - 1) + v * (2 * uv[1] - 1)
        target = direct.toward * direct.distance + offset
        away = length(target)
        return target / away, away

    def in_scattering(self, segments: RaySegments, parts: int) -> SegmentLight:
        """See `LightSource.in_scattering`."""
        return equiangular(segments, self.position, self.size * 0.25, self.axes[:, 2], parts, self._intensity)

    def _intensity(self, toward: Tensor) -> Tensor:
        facing = (self.axes[:, 2] @ toward).clamp_min(0)
        return facing * self.spread(facing) * ((1.0 if self.light.normalize else self.area) / math.pi)

    def spread(self, facing: Numbers) -> Numbers:
        """Cycles' attenuation (N,) by the spread, from the cosine (N,) between the light's normal and the way to a lit point."""
        if not self.focused:
            return torch.ones_like(facing)
        half = max(self.light.spread / 2, 1e-2)
        tangent = math.tan(half)
        angle = (1 / (facing * facing).clamp_min(1e-6) - 1).clamp_min(1e-12).sqrt()
        return ((tangent - angle) / (tangent - half)).clamp_min(0.0)

    def _mean_spread(self, points: Tensor) -> Tensor:
        """`spread` (N,) averaged over the light, weighted by the solid angle of each part at points (3, N)."""
        u, v = self.half_axes()
        total, weight = torch.zeros_like(points[0]), torch.full_like(points[0], 1e-12)
        for x, share_x in _GAUSS:
            for y, share_y in _GAUSS:
                offset = self.position[:, None] + u * x + v * y - points
                squared = dot(offset, offset).clamp_min(1e-8)
                facing = (dot(offset, self.axes[:, 2:3]) * squared.rsqrt()).clamp_min(0.0)
                solid_angle = facing / squared * (share_x * share_y)
                total, weight = total + solid_angle * self.spread(facing), weight + solid_angle
        return total / weight

    def _polygon(self, points: Tensor, normals: Tensor) -> Tensor:
        """Irradiance (N,) from a rectangle of radiance 1: Lambert's formula, clipped at the horizon as a sphere is."""
        u, v = self.half_axes()
        corners = [unit(self.position[:, None] + u * x + v * y - points) for x, y in _CORNERS]
        flux = torch.zeros_like(points)
        for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
            cosine = dot(a, b).clamp(-0.99999, 0.99999)
            flux = flux + cross(a, b) * (torch.arccos(cosine) / (1 - cosine * cosine).sqrt())
        flux = flux * 0.5
        size = length(flux, 1e-9)
        return size * clipped_sphere(dot(flux, normals) / size, (size / math.pi).clamp_max(1.0))


@dataclass(frozen=True)
class SunLight(LightSource):
    """A disc at infinity; its energy is the irradiance of a surface that faces it, in W/m²."""

    energy_name: ClassVar[str] = "strength"
    at_infinity: ClassVar[bool] = True

    @staticmethod
    def read_size(light: Light, values: RenderValues) -> Float[Tensor, ""]:
        """Its angular diameter () in radians."""
        return torch.deg2rad(values.scalar(f"light/{light.name}/angle"))

    def toward(self, points: Vectors) -> tuple[Vectors, Numbers]:
        """The same direction from everywhere, at an infinite distance."""
        return self.axes[:, 2:3].expand_as(points), torch.full_like(points[0], math.inf)

    def irradiance(self, points: Vectors, normals: Vectors) -> DirectIrradiance:
        """See `LightSource.irradiance`."""
        toward = self.axes[:, 2:3]
        cosine = dot(normals, toward).clamp_min(0.0)
        one = torch.ones_like(cosine)
        solid = 2 * math.pi * (1 - within(self.size / 2, POINT_RADIUS, math.pi / 2).cos())
        return DirectIrradiance(toward.expand_as(normals), one * math.inf, cosine, one, one * solid)

    def shadow_targets(self, direct: DirectIrradiance, uv: Float[Tensor, "2 n"]) -> tuple[Vectors, Numbers]:
        """See `LightSource.shadow_targets`."""
        target = direct.toward + disc_offsets(direct.toward, direct.solid_angle, uv)
        return target / length(target), direct.distance

    def in_scattering(self, segments: RaySegments, parts: int) -> SegmentLight:
        """See `LightSource.in_scattering`; sunlight is the same everywhere, so that a segment has only one part."""
        points = segments.middles
        toward = self.axes[:, 2].view(3, 1, 1, 1).expand_as(points)
        distance = torch.full_like(points[0], math.inf)
        return SegmentLight(points, toward, distance, torch.ones_like(distance))


LIGHT_TYPES: dict[str, type[LightSource]] = {
    "AREA": AreaLight, "POINT": PointLight, "SUN": SunLight, "SPOT": SpotLight,
}  # fmt: skip
"""Blender's name of a light type to its class."""


def light_sources(scene: SceneData, values: RenderValues, made: Recent | None = None) -> list[LightSource]:
    """All lights of the scene at the render's values; `made` caches lights whose values stay the same."""
    kept, found = made or Recent(), []
    for number, light in enumerate(scene.lights):  # instances of a light share its name
        make = partial(LIGHT_TYPES[light.type].of, light, scene, values)
        found.append(values.kept(kept, f"light/{light.name}", make, number))
    return found
