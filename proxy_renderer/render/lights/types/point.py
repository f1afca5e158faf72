# SPDX-License-Identifier: Apache-2.0
"""Point lights: spheres that shine to all sides alike."""

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
from ...geometry.vectors import dot, length
from .light_source import POINT_RADIUS, DirectIrradiance, LightSource, SegmentLight
from .local import disc_offsets, equiangular, offsets


@dataclass(frozen=True)
class PointLight(LightSource):
    """A sphere of some radius; its energy is its power in watts."""

    energy_name: ClassVar[str] = "power"
    at_infinity: ClassVar[bool] = False
    segment_parts: ClassVar[int] = 1

    @staticmethod
    def read_size(light: Light, values: RenderValues) -> Float[Tensor, ""]:
        """Its radius () in meters."""
        return values.scalar(f"light/{light.name}/size") * light.scale

    def toward(self, points: Float[Tensor, "3 n"]) -> tuple[Float[Tensor, "3 n"], Float[Tensor, " n"]]:
        """See `LightSource.toward`."""
        return offsets(self.position, points)[:2]

    def irradiance(self, points: Float[Tensor, "3 n"], normals: Float[Tensor, "3 n"]) -> DirectIrradiance:
        """Power / (4 pi d^2), which Blender's soft falloff (its default) lowers near large lights.

        With it Cycles takes the light for a disc that faces the point, whose view factor is r^2 / (d^2 + r^2);
        without it for a sphere, whose view factor from outside is r^2 / d^2 (kernel/light/point.h).
        """
        toward, distance, squared = offsets(self.position, points)
        near2 = self.size * self.size
        near2 = squared + near2 if self.light.soft_falloff else torch.maximum(squared, near2)
        frontal = 1.0 / (4 * math.pi * near2)
        if not self.light.normalize:
            frontal = frontal * (4 * math.pi * self.size * self.size)
        frontal = frontal * self.directivity(toward, self.size / distance)
        cosine = dot(normals, toward)
        radius2 = self.size * self.size
        cosine = self.surface_cosine(cosine, (radius2 / squared).clamp_max(1.0)).clamp_min(0.0)
        solid = (math.pi * radius2 / squared).clamp(math.pi * POINT_RADIUS**2, 2 * math.pi)
        return DirectIrradiance(toward, distance, frontal * cosine, frontal, solid)

    def directivity(
        self, toward: Float[Tensor, "3 n"], radius: Float[Tensor, " n"] | None = None
    ) -> Float[Tensor, " n"]:
        """What it shines to points relative to a light that is the same to all sides.

        Args:
            toward: (3, N) unit vectors from the points to its center.
            radius: (N,) its radius as seen from the points, as a tangent; None for a small one.

        Returns:
            (N,).
        """
        return torch.ones_like(toward[0])

    def surface_cosine(self, cosine: Float[Tensor, " n"], share: Float[Tensor, " n"]) -> Float[Tensor, " n"]:
        """Cosine (N,) by which a surface is lit, from that of its center and its squared angular radius (N,)."""
        return cosine

    def shadow_targets(
        self,
        toward: Float[Tensor, "3 n"],
        distance: Float[Tensor, " n"],
        solid_angle: Float[Tensor, " n"],
        uv: Float[Tensor, "2 n"],
    ) -> tuple[Float[Tensor, "3 n"], Float[Tensor, " n"]]:
        """See `LightSource.shadow_targets`: points of the disc that faces the shaded point."""
        target = toward * distance + disc_offsets(toward, solid_angle, uv) * distance
        away = length(target)
        return target / away, away

    def half_sides(self) -> None:
        """It is round."""
        return

    def in_scattering(self, segments: RaySegments, parts: int) -> SegmentLight:
        """See `LightSource.in_scattering`."""
        return equiangular(segments, self.position, self.size * 0.5, None, parts, self._intensity)

    def _intensity(self, toward: Tensor) -> Tensor:
        radius2 = self.size * self.size
        even = (1.0 if self.light.normalize else 4 * math.pi * radius2) / (4 * math.pi)
        return even * torch.ones_like(toward[0]) * self.directivity(toward)
