# SPDX-License-Identifier: Apache-2.0
"""Fog on the ways between surfaces: it lights them, dims what lights them, and hazes what they mirror.

All of it varies slowly, so it is summed along a few rays from a very coarse grid of points, and carried to
the anchors of indirect light. As on camera rays, light scatters once: Cycles' default of no volume bounces.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from ..geometry.camera import View
from ..geometry.directions import above, cosine_directions, reflect
from ..geometry.gather_points import Anchors
from ..geometry.samples import Samples
from ..geometry.vectors import dot
from ..geometry.visibility import Geometry, Surface, sphere_points
from ..lights.environment import Sky
from ..lights.lamps import Lamp
from .fog import Fog
from .secondary_hits import lit
from .volume import DIRECTIONS, WEIGHTS, Rays, Volume, phase

_ACROSS = 24
_DIFFUSE_RAYS = 6
_SEGMENTS = 5
_NEAR = 0.1
"""First cut of a ray as a part of the view's distance: light scattered close by counts most in thick fog."""


@dataclass(frozen=True)
class Murk:
    """What fog does to indirect light at A anchors. S sources: the lamps, the world's halves, both once more.

    Attributes:
        ambient: (A,) share of the world's light that comes through.
        passing: (A,) share of what nearby surfaces send that comes through, on diffuse ways.
        factors: (A, S) the same, together with the fog before those surfaces.
        legs: (A, S) share of the light that comes through to those surfaces.
        scattered: (A, 3) irradiance from the fog.
        haze: (A, 3) radiance of the fog in mirror directions, were it endless there.
        mirrored: (A,) share of mirrored light that comes through.
    """

    ambient: Tensor
    passing: Tensor
    factors: Tensor
    legs: Tensor
    scattered: Tensor
    haze: Tensor
    mirrored: Tensor


class MurkRays:
    """The rays of one view, and what stands in their way.

    Args:
        geometry: The triangles.
        samples, surface: What the view sees.
        view: The camera.
        anchors: Indices (A,) of the samples at which indirect light is gathered.
        near: A typical distance of what is seen, meters.
    """

    def __init__(
        self,
        geometry: Geometry,
        samples: Samples,
        surface: Surface,
        view: View,
        anchors: Tensor,
        near: float,
    ) -> None:
        self._geometry, self._near, self._signature = geometry, near, view.signature()
        self._volume = Volume(geometry.clear)
        coarse = Anchors(samples, surface, _ACROSS)
        self._points = points = surface.pick(coarse.index)
        self._smooth = coarse.smooth
        distance = samples.hits.distance[anchors]
        self._to_anchors = coarse.spread_to(surface.pick(anchors), samples.place[:, anchors], distance)
        mirrored = above(reflect(samples.toward[:, coarse.index], points.normal), points.facet)
        rays = torch.cat((_diffuse(points), mirrored[:, :, None]), 2)  # (3, P, rays)
        self._toward = rays
        self._start = geometry.lifted(points)[:, :, None].expand_as(rays)
        start, toward = self._start.flatten(1), rays.flatten(1)
        hits = geometry.first_hits(start, toward)
        self._hit = hits.hit.view(rays.shape[1:])
        self._distance = hits.distance.view(rays.shape[1:])
        self._surface = geometry.surface(hits, toward)
        ways = DIRECTIONS.to(start)[:, :, None].expand(-1, -1, rays.shape[1])
        begin = self._start[:, None, :, 0].expand_as(ways)
        far = torch.full_like(ways[0], math.inf)
        clear = geometry.clear(begin.flatten(1), ways.flatten(1), far.flatten())
        self._open = clear.view(far.shape)  # (14, P)
        self._lit: dict[int, tuple[object, Tensor]] = {}

    def gather(self, fog: Fog, lamps: Sequence[Lamp], sky: Sky) -> Murk:
        """Sums the fog's effects at the values of one render."""
        passing = fog.transmittance(self._start, self._toward, self._distance)  # (P, rays)
        diffuse, mirrored = passing[:, :-1], passing[:, -1]
        hit = self._hit[:, :-1].to(passing.dtype)
        kept = (diffuse * hit + 1e-3 * diffuse).sum(1) / (hit + 1e-3).sum(1)
        ambient = self._ambient(fog)
        legs, factors = self._legs(fog, lamps, diffuse)
        legs = torch.cat((legs, ambient[:, None].expand(-1, 2)), 1)
        factors = torch.cat((factors, (kept * ambient)[:, None].expand(-1, 2)), 1)
        light = self._light(fog, lamps, sky, passing)  # (3, P, rays)
        scattered = light[:, :, :-1].mean(2) * math.pi
        haze = light[:, :, -1] / (1 - mirrored).clamp_min(1e-4)
        one = (ambient, kept)
        rows = (torch.stack(one), factors.T, legs.T, scattered)
        even = self._smooth(torch.cat(rows).T)  # a few rays are noisy
        found = self._to_anchors(torch.cat((even, haze.T, mirrored[:, None]), 1))
        count = factors.shape[1]
        single, factors, legs, scattered, haze, mirrored = found.split((2, count, count, 3, 3, 1), 1)
        again = torch.cat((factors, factors * single[:, 1:2]), 1)
        return Murk(
            ambient=single[:, 0],
            passing=single[:, 1],
            factors=again,
            legs=torch.cat((legs, legs * single[:, 1:2]), 1),
            scattered=scattered,
            haze=haze,
            mirrored=mirrored[:, 0],
        )

    def _ambient(self, fog: Fog) -> Tensor:
        """Share (P,) of the world's light that comes through, weighted by what a surface would get of it."""
        ways = DIRECTIONS.to(self._start)
        facing = (ways.T @ self._points.normal).clamp_min(0) * WEIGHTS.to(ways)[:, None]
        far = torch.full_like(facing, math.inf)
        reaching = fog.transmittance(self._start[:, None, :, 0], ways[:, :, None], far)
        facing = facing * (self._open + 1e-3)
        return (reaching * facing).sum(0) / facing.sum(0)

    def _legs(self, fog: Fog, lamps: Sequence[Lamp], passing: Tensor) -> tuple[Tensor, Tensor]:
        """(P, L) shares of lamps' light that reach what the diffuse rays (P, rays) hit, and come back from there."""
        legs, factors = [], []
        for i, lamp in enumerate(lamps):
            weight = self._arriving(i, lamp)
            still = lamp.detached()
            position = self._surface.position
            if lamp.light.type == "SUN":
                toward = still.axes[:, 2:3].expand_as(position)
                distance = torch.full_like(position[0], math.inf)
            else:
                toward = still.position[:, None] - position
                distance = dot(toward, toward).clamp_min(1e-8).sqrt()
                toward = toward / distance
            share = fog.transmittance(position, toward, distance).view(self._hit.shape)[:, :-1]
            total = weight.sum(1)
            legs.append((weight * share).sum(1) / total)
            factors.append((weight * share * passing).sum(1) / total)
        empty = passing.new_zeros((len(passing), 0))
        return (torch.stack(legs, 1), torch.stack(factors, 1)) if legs else (empty, empty)

    def _arriving(self, index: int, lamp: Lamp) -> Tensor:
        """A lamp's irradiance (P, rays) where the diffuse rays end; a trace of it everywhere, to divide by."""
        kept = self._lit.get(index)
        if kept is None or kept[0] != lamp.signature():
            with torch.no_grad():
                found = lit(self._geometry, lamp.detached(), self._surface).view(self._hit.shape)
                found = (found * self._hit)[:, :-1]
            kept = self._lit[index] = (lamp.signature(), found + 1e-3 * found.mean() + 1e-12)
        return kept[1]

    def _light(self, fog: Fog, lamps: Sequence[Lamp], sky: Sky, passing: Tensor) -> Tensor:
        """Radiance (3, P, rays) that the fog sends back along the rays."""
        start, toward, points, count = self._start, self._toward, *self._hit.shape
        reach = fog.reach(start.detach().mean((1, 2)))
        near = self._near * _NEAR
        growth = (1 + reach / near) ** (1 / _SEGMENTS)
        cuts = near * (growth ** torch.arange(_SEGMENTS + 1, device=start.device) - 1)
        cuts = torch.minimum(cuts[:, None, None].expand(-1, points, count), self._distance)
        rays = Rays(start, toward, cuts, (self._signature, reach))
        depth = torch.exp(-fog.density * fog.thickness(start[:, None], toward[:, None], cuts))
        light = torch.zeros((3, _SEGMENTS, points, count), device=start.device)
        for lamp in lamps:
            light = light + self._volume.lamp_light(fog, rays, lamp, 1)
        light = (light * (depth[:-1] - depth[1:])).sum(1)
        light = light + self._world(fog, sky, passing) * (1 - passing)
        return light * fog.albedo[:, None, None]

    def _world(self, fog: Fog, sky: Sky, passing: Tensor) -> Tensor:
        """The world's light (3, P, rays) scattered back, were the fog endless: from where it scatters on average."""
        ways = DIRECTIONS.to(self._start)
        way = fog.thickness(self._start, self._toward, self._distance.clamp_max(1e6)).detach()
        depth = (fog.density.detach() * way).clamp_min(1e-3)
        mean = way * (1 / depth - 1 / torch.expm1(depth.clamp_max(60.0)))  # of t exp(-t) over the way
        place = self._start + self._toward * mean
        far = torch.full((len(ways.T), *passing.shape), math.inf, device=ways.device)
        reaching = fog.transmittance(place[:, None], ways[:, :, None, None], far) * self._open[:, :, None]
        lobe = phase(torch.einsum("cd,cpr->dpr", ways, self._toward), fog.anisotropy)
        lobe = lobe * WEIGHTS.to(ways)[:, None, None]
        lobe = lobe / lobe.sum(0)
        world = (sky.color[:, None] * sky.soft(ways)).expand(3, -1)
        return torch.einsum("cd,dpr->cpr", world, reaching * lobe)


def _diffuse(points: Surface) -> Tensor:
    """(3, P, rays) cosine-distributed directions."""
    count = points.position.shape[1]
    uv = sphere_points(_DIFFUSE_RAYS, count, torch.Generator().manual_seed(5)).to(points.position.device)
    normal, facet = (v.repeat_interleave(_DIFFUSE_RAYS, 1) for v in (points.normal, points.facet))
    return above(cosine_directions(normal, uv.flatten(1)), facet).view(3, count, _DIFFUSE_RAYS)
