# SPDX-License-Identifier: Apache-2.0
"""Rays from points over their hemisphere, or over a reflection that is blurred, and how densely they lie."""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor

from ..geometry.directions import above, cosine_directions, reflect
from ..geometry.vectors import cross, dot, tangents, unit
from ..geometry.visibility import Surface
from ..material.microfacets import visible_normals

_LEAST_COSINE = 0.02


@dataclass(frozen=True)
class LobeRays:
    """Rays that leave A points which rays have met.

    Attributes:
        points: The points.
        arrived: (3, A) directions of the rays that have met them.
        cosine: (A,) of their angles to the normals.
    """

    points: Surface
    arrived: Tensor
    cosine: Tensor

    @staticmethod
    def of(points: Surface, arrived: Tensor) -> LobeRays:
        """For points and (3, A) directions of the rays that have met them."""
        return LobeRays(points, arrived, (-dot(arrived, points.normal)).clamp(_LEAST_COSINE, 1.0))

    def hemisphere(self, uv: Tensor) -> Tensor:
        """Rays (3, A * R) above the points, distributed like a cosine, from (2, A, R) in [0, 1)."""
        rays = uv.shape[2]
        toward = cosine_directions(self.points.normal.repeat_interleave(rays, 1), uv.flatten(1))
        return above(toward, self.points.facet.repeat_interleave(rays, 1))

    def hemisphere_density(self, way: Tensor) -> Tensor:
        """Density (A * R) of these at directions (3, A * R)."""
        rays = way.shape[1] // self.points.normal.shape[1]
        return dot(self.points.normal.repeat_interleave(rays, 1), way).clamp_min(0.0) / math.pi

    def reflections(self, uv: Tensor, alpha: float) -> Tensor:
        """Rays (3, A * R) that visible GGX microfacets of a width reflect, from (2, A, R) in [0, 1)."""
        rays = uv.shape[2]
        fields = self.points.normal, self.points.facet, self.arrived
        normal, facet, arrived = (f.repeat_interleave(rays, 1) for f in fields)
        cosine = self.cosine.repeat_interleave(rays)
        x, y, z = visible_normals(cosine, alpha, uv.flatten(1))
        level = -arrived - normal * cosine
        head_on = dot(level, level) < 1e-8
        across = torch.where(head_on, tangents(normal)[0], unit(level))
        return above(reflect(arrived, across * x + cross(normal, across) * y + normal * z), facet)

    def reflections_density(self, way: Tensor, alpha: float) -> Tensor:
        """Density (A * R) of these at directions (3, A * R): that of the half vector over 4 h.v."""
        rays = way.shape[1] // self.points.normal.shape[1]
        normal, arrived = (f.repeat_interleave(rays, 1) for f in (self.points.normal, self.arrived))
        cosine, squared = self.cosine.repeat_interleave(rays), alpha * alpha
        up = dot(unit(way - arrived, 1e-4), normal).clamp(0.0, 1.0)
        spread = squared / (math.pi * (up * up * (squared - 1) + 1) ** 2)
        spread = torch.where(up > 0, spread, 0.0)
        return spread / (2 * (cosine + (squared + (1 - squared) * cosine * cosine).sqrt()))
