# SPDX-License-Identifier: Apache-2.0
"""Rays over hemispheres and blurred reflections, and the share of them that glowing surfaces fill.

Glowing surfaces are bright and often small. Some rays are drawn from the lobe, others go to random points on glowing surfaces.
Both are combined by the power heuristic, as in Cycles (Veach and Guibas 1995, "Optimally Combining Sampling Techniques for Monte
Carlo Rendering"). The mirror image of a glowing surface blurs with roughness, and its contrast is too high to mix a sharp image
with a blurred one: hence the several values of roughness.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import torch
from torch import Generator, Tensor

from ..geometry.vectors import above, cosine_directions, cross, dot, reflect, tangents, unit
from ..geometry.visibility import Hits, RayGeometry, Surface, shared_points
from ..lights.environment import GLOSSY, SATIN
from ..material.albedo import visible_normals

BLURS = (0.1, SATIN, GLOSSY)  # roughness of the reflections between the mirror image and the diffuse light
_LOBE_RAYS = 64
_LAMP_RAYS = 16
_LEAST_COSINE = 0.02


def glow_of(
    geometry: RayGeometry,
    lobes: LobeRays,
    near: Tensor,
    wide: Tensor,
    clusters: Mapping[int, Sequence[object]],
    generator: Generator,
) -> list[Tensor]:
    """Shares (A, M) of the view from A points that the glow of each of M materials fills, one tensor for each lobe.

    The first lobe is the hemisphere, weighted by the cosine; the others are reflections blurred by each of `BLURS`.
    `clusters` is `Emitters.clusters`: the first lobe leaves out materials with lights. Points with the same number in
    `near` (A,) share random numbers of reflections, in `wide` (A,) those of the hemisphere: see `GatherPoints.turns`.
    """
    points, unlit = lobes.points, sorted(material for material, some in clusters.items() if not some)
    diffuse = _Search(geometry, points, wide, unlit, "diffuse", generator)
    glossy = _Search(geometry, points, near, sorted(clusters), "glossy", generator)
    found = [diffuse.shares(lobes.hemisphere, lobes.hemisphere_density)]
    for roughness in BLURS:
        alpha = roughness * roughness
        lobe = partial(lobes.reflections, alpha=alpha), partial(lobes.reflections_density, alpha=alpha)
        found.append(glossy.shares(*lobe))
    return found


class _Search:
    """Rays of one kind from points to glowing surfaces; target points are chosen once, equally many per material."""

    def __init__(
        self, geometry: RayGeometry, points: Surface, turn: Tensor, glowing: list[int], ray: str, generator: Generator
    ) -> None:
        self._geometry, self._points, self._ray, self._generator, self._turn = geometry, points, ray, generator, turn
        self._origin = geometry.lifted(points)
        self._targets: Hits | None = None
        # (F,) chosen points per square meter on each triangle; 0 where these rays see no glow.
        a, b, c = geometry.corners.permute(0, 2, 1)
        self._areas = cross(b - a, c - a).norm(dim=0) / 2
        self._density = torch.zeros_like(self._areas)
        visible = geometry.visible_to(ray)
        for material in glowing:
            own = (geometry.material == material) & visible
            self._density[own] = 1 / (self._areas[own].sum().clamp_min(1e-12) * len(glowing))
        lamps = (self._density > 0).nonzero()[:, 0]
        if len(lamps):
            self._aim(lamps)

    def _aim(self, lamps: Tensor) -> None:
        """Chooses target points on the triangles `lamps`, and traces the share of their light that arrives at each point."""
        # Points that are spread evenly over the glowing areas, and divided among the turns.
        chance = (self._density * self._areas)[lamps].cumsum(0)
        spots = shared_points(_LAMP_RAYS, self._turn, self._generator)
        order = torch.arange(_LAMP_RAYS, device=chance.device) / _LAMP_RAYS
        shift = torch.rand(1, generator=self._generator).to(chance.device) + self._turn[:, None]
        shift = shift / (int(self._turn.max()) + 1) / _LAMP_RAYS
        where = ((order + shift) * chance[-1]).flatten()
        triangle = lamps[torch.searchsorted(chance, where).clamp_max(len(lamps) - 1)]
        root, second = spots[0].flatten().sqrt(), spots[1].flatten()
        weights = torch.stack((1 - root, root * (1 - second), root * second))
        place = sum(w * c[triangle].T for w, c in zip(weights, self._geometry.corners, strict=True))
        # Directions to them, and the share of their light that arrives.
        start = self._origin.repeat_interleave(_LAMP_RAYS, 1)
        offset = place - start
        distance = dot(offset, offset).clamp_min(1e-12).sqrt()
        self._toward = offset / distance
        self._targets = Hits(triangle, weights[1], weights[2], distance)
        index = (dot(self._toward, self._points.facet.repeat_interleave(_LAMP_RAYS, 1)) > 0).nonzero()[:, 0]
        self._seen = torch.zeros_like(distance)
        way = start[:, index], self._toward[:, index], distance[index] * (1 - 1e-4)
        self._seen[index] = self._geometry.clear(*way, ray=self._ray)
        self._seen *= self._geometry.stopping(self._geometry.surface(self._targets, self._toward), self._toward)

    def shares(self, directions: Callable[[Tensor], Tensor], density: Callable[[Tensor], Tensor]) -> Tensor:
        """Shares (A, M) of the lobes at A points that the glow of each of M materials fills.

        `directions` maps uniform samples (2, A, R), R for each lobe, to unit directions (3, A * R), `density` to their density.
        """
        if self._targets is None:
            return torch.zeros((self._origin.shape[1], len(self._geometry.glass)), device=self._origin.device)
        toward = directions(shared_points(_LOBE_RAYS, self._turn, self._generator))
        hits = self._geometry.first_hits(self._origin.repeat_interleave(_LOBE_RAYS, 1), toward, self._ray)
        found = self._weighed(hits, toward, density(toward), torch.ones_like(hits.distance), True)
        return found + self._weighed(self._targets, self._toward, density(self._toward), self._seen, False)

    def _weighed(self, hits: Hits, toward: Tensor, lobe: Tensor, seen: Tensor, by_lobe: bool) -> Tensor:
        """Shares (A, M) by rays drawn `by_lobe`, or else by target points, weighted by the power heuristic.

        `lobe` (A * R) is the rays' density in the lobe, `seen` (A * R) the share of their light that arrives.
        """
        index = (hits.hit & (seen > 0) & (self._density[hits.triangle.clamp_min(0)] > 0)).nonzero()[:, 0]
        triangle, distance = hits.triangle[index], hits.distance[index]
        a, b, c = (self._geometry.corners[k, triangle].T for k in range(3))
        cosine = dot(unit(cross(b - a, c - a), 1e-15), toward[:, index]).abs().clamp_min(1e-4)
        by_chance = _LOBE_RAYS * lobe[index]
        aimed = _LAMP_RAYS * self._density[triangle] * distance * distance / cosine
        chosen = by_chance if by_lobe else aimed
        share = lobe[index] * chosen / (by_chance**2 + aimed**2).clamp_min(1e-20) * seen[index]
        rays = _LOBE_RAYS if by_lobe else _LAMP_RAYS
        points, materials = len(seen) // rays, len(self._geometry.glass)
        place = index // rays * materials + self._geometry.material[triangle]
        return torch.zeros(points * materials, device=share.device).index_add(0, place, share).view(points, materials)


@dataclass(frozen=True)
class LobeRays:
    """Random rays that leave A points, at which other rays have arrived."""

    points: Surface  # the points
    arrived: Tensor  # (3, A) directions of the rays that have met them
    cosine: Tensor  # (A,) between the arrived rays, reversed, and the normals

    @staticmethod
    def of(points: Surface, arrived: Tensor) -> LobeRays:
        """The rays of `points`, whose lobes depend on the directions `arrived` (3, A) of rays that have met them."""
        return LobeRays(points, arrived, (-dot(arrived, points.normal)).clamp(_LEAST_COSINE, 1.0))

    def hemisphere(self, uv: Tensor) -> Tensor:
        """Cosine-distributed rays (3, A * R) above the points, from (2, A, R) in [0, 1)."""
        rays = uv.shape[2]
        toward = cosine_directions(self.points.normal.repeat_interleave(rays, 1), uv.flatten(1))
        return above(toward, self.points.facet.repeat_interleave(rays, 1))

    def hemisphere_density(self, way: Tensor) -> Tensor:
        """Probability density (A * R) of `hemisphere` at directions (3, A * R)."""
        rays = way.shape[1] // self.points.normal.shape[1]
        return dot(self.points.normal.repeat_interleave(rays, 1), way).clamp_min(0.0) / math.pi

    def reflections(self, uv: Tensor, alpha: float) -> Tensor:
        """Rays (3, A * R) that visible GGX microfacets of width `alpha` reflect, from (2, A, R) in [0, 1)."""
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
        """Probability density (A * R) of `reflections` at directions (3, A * R): the half vector's over 4 h.v."""
        rays = way.shape[1] // self.points.normal.shape[1]
        normal, arrived = (f.repeat_interleave(rays, 1) for f in (self.points.normal, self.arrived))
        cosine, squared = self.cosine.repeat_interleave(rays), alpha * alpha
        up = dot(unit(way - arrived, 1e-4), normal).clamp(0.0, 1.0)
        spread = squared / (math.pi * (up * up * (squared - 1) + 1) ** 2)
        spread = torch.where(up > 0, spread, 0.0)
        return spread / (2 * (cosine + (squared + (1 - squared) * cosine * cosine).sqrt()))
