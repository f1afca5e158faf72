# SPDX-License-Identifier: Apache-2.0
"""Area lights: flat rectangles and ellipses that shine to one side (kernel/light/area.h)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import torch
from jaxtyping import Float
from torch import Tensor

from ....scene import Light
from ....scene.values import RenderValues
from ...geometry.segments import RaySegments
from ...geometry.vectors import cross, dot, length, unit
from .light_source import DirectIrradiance, LightSource, SegmentLight
from .local import clipped_sphere, equiangular, offsets

_CORNERS = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
_GAUSS = ((-0.861136, 0.173927), (-0.339981, 0.326073), (0.339981, 0.326073), (0.861136, 0.173927))
"""Places in [-1, 1] and weights of Gauss and Legendre's rule."""


@dataclass(frozen=True)
class AreaLight(LightSource):
    """A flat light; its energy is its power in watts, its radiance power / (pi area)."""

    energy_name: ClassVar[str] = "power"
    at_infinity: ClassVar[bool] = False
    segment_parts: ClassVar[int] = 1

    @staticmethod
    def read_size(light: Light, values: RenderValues) -> Float[Tensor, ""]:
        """Its width () in meters."""
        return values.scalar(f"light/{light.name}/size") * light.scale

    @property
    def round(self) -> bool:
        """Whether its outline is an ellipse rather than a rectangle."""
        return self.light.shape in ("DISK", "ELLIPSE")

    @property
    def focused(self) -> bool:
        """Whether it shines into a narrower cone than a plain one."""
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

    def toward(self, points: Float[Tensor, "3 n"]) -> tuple[Float[Tensor, "3 n"], Float[Tensor, " n"]]:
        """See `LightSource.toward`."""
        return offsets(self.position, points)[:2]

    def irradiance(self, points: Float[Tensor, "3 n"], normals: Float[Tensor, "3 n"]) -> DirectIrradiance:
        """See `LightSource.irradiance`."""
        toward, distance, squared = offsets(self.position, points)
        facing = dot(toward, self.axes[:, 2:3]).clamp_min(0.0)
        radiance = 1.0 / (math.pi * (self.area if self.light.normalize else 1.0))
        solid = (self.area * facing / (squared + self.area / math.pi)).clamp_min(1e-7)
        front = (facing > 0).to(facing.dtype)
        if not self.focused:
            irradiance = radiance * front * self._polygon(points, normals)
            return DirectIrradiance(toward, distance, irradiance, radiance * front * solid, solid)
        spread = self._mean_spread(points)
        irradiance = radiance * front * self._polygon(points, normals) * spread
        return DirectIrradiance(toward, distance, irradiance, radiance * front * solid * spread, solid)

    def shadow_targets(
        self,
        toward: Float[Tensor, "3 n"],
        distance: Float[Tensor, " n"],
        solid_angle: Float[Tensor, " n"],
        uv: Float[Tensor, "2 n"],
    ) -> tuple[Float[Tensor, "3 n"], Float[Tensor, " n"]]:
        """See `LightSource.shadow_targets`."""
        if self.round:
            radius, angle = uv[0].sqrt(), 2 * math.pi * uv[1]
            offset = self.axes[:, 0:1] * (radius * angle.cos() * self.size / 2)
            offset = offset + self.axes[:, 1:2] * (radius * angle.sin() * self.size / 2 * self.light.aspect)
        else:
            u, v = self.half_axes()
            offset = u * (2 * uv[0] - 1) + v * (2 * uv[1] - 1)
        target = toward * distance + offset
        away = length(target)
        return target / away, away

    def in_scattering(self, segments: RaySegments, parts: int) -> SegmentLight:
        """See `LightSource.in_scattering`."""
        back = self.axes[:, 2]
        return equiangular(segments, self.position, self.size * 0.25, back, parts, self._intensity)

    def _intensity(self, toward: Tensor) -> Tensor:
        facing = (self.axes[:, 2] @ toward).clamp_min(0)
        return facing * self.spread(facing) * ((1.0 if self.light.normalize else self.area) / math.pi)

    def spread(self, facing: Float[Tensor, " n"]) -> Float[Tensor, " n"]:
        """Cycles' attenuation (N,) of a focused light, by the cosine (N,) to a point of it."""
        if not self.focused:
            return torch.ones_like(facing)
        half = max(self.light.spread / 2, 1e-2)
        tangent = math.tan(half)
        angle = (1 / (facing * facing).clamp_min(1e-6) - 1).clamp_min(1e-12).sqrt()
        return ((tangent - angle) / (tangent - half)).clamp_min(0.0)

    def _mean_spread(self, points: Tensor) -> Tensor:
        """The same (N,), averaged over the light as points (3, N) see its parts."""
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
        """Irradiance (N,) from a rectangle of radiance 1: Lambert's formula, clipped at the horizon."""
        u, v = self.half_axes()
        corners = [self.position[:, None] + u * x + v * y - points for x, y in _CORNERS]
        corners = [unit(corner) for corner in corners]
        flux = torch.zeros_like(points)
        for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
            cosine = dot(a, b).clamp(-0.99999, 0.99999)
            flux = flux + cross(a, b) * _theta_over_sine(cosine)
        flux = flux * 0.5
        size = length(flux, 1e-9)
        return size * clipped_sphere(dot(flux, normals) / size, (size / math.pi).clamp_max(1.0))


def _theta_over_sine(cosine: Tensor) -> Tensor:
    """theta / sin(theta) for cos(theta)."""
    return torch.arccos(cosine) / (1 - cosine * cosine).sqrt()
