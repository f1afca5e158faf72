# SPDX-License-Identifier: Apache-2.0
"""Suns: distant discs."""

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
from ...geometry.vectors import dot, length, within
from .light_source import POINT_RADIUS, DirectIrradiance, LightSource, SegmentLight
from .local import disc_offsets


@dataclass(frozen=True)
class SunLight(LightSource):
    """A disc at infinity; its energy is the irradiance of a surface that faces it, in W/m²."""

    energy_name: ClassVar[str] = "strength"
    at_infinity: ClassVar[bool] = True
    segment_parts: ClassVar[int] = 1

    @staticmethod
    def read_size(light: Light, values: RenderValues) -> Float[Tensor, ""]:
        """Its angular diameter () in radians."""
        return torch.deg2rad(values.scalar(f"light/{light.name}/angle"))

    def toward(self, points: Float[Tensor, "3 n"]) -> tuple[Float[Tensor, "3 n"], Float[Tensor, " n"]]:
        """The same direction from everywhere, at an infinite distance."""
        return self.axes[:, 2:3].expand_as(points), torch.full_like(points[0], math.inf)

    def irradiance(self, points: Float[Tensor, "3 n"], normals: Float[Tensor, "3 n"]) -> DirectIrradiance:
        """See `LightSource.irradiance`."""
        toward = self.axes[:, 2:3]
        cosine = dot(normals, toward).clamp_min(0.0)
        half = within(self.size / 2, POINT_RADIUS, math.pi / 2)
        one = torch.ones_like(cosine)
        solid = 2 * math.pi * (1 - half.cos())
        return DirectIrradiance(toward.expand_as(normals), one * math.inf, cosine, one, one * solid)

    def shadow_targets(
        self,
        toward: Float[Tensor, "3 n"],
        distance: Float[Tensor, " n"],
        solid_angle: Float[Tensor, " n"],
        uv: Float[Tensor, "2 n"],
    ) -> tuple[Float[Tensor, "3 n"], Float[Tensor, " n"]]:
        """See `LightSource.shadow_targets`."""
        target = toward + disc_offsets(toward, solid_angle, uv)
        return target / length(target), distance

    def half_sides(self) -> None:
        """It is round."""
        return

    def in_scattering(self, segments: RaySegments, parts: int) -> SegmentLight:
        """The same everywhere, so that one part of a segment says all."""
        points = segments.middles
        toward = self.axes[:, 2].view(3, 1, 1, 1).expand_as(points)
        distance = torch.full_like(points[0], math.inf)
        return SegmentLight(points, toward, distance, torch.ones_like(distance))
