# SPDX-License-Identifier: Apache-2.0
"""Fog between surfaces: in-scattered light on them, transmittance of indirect light, haze in reflections.

All of it varies slowly: it is integrated along a few rays from a very coarse grid of points, and interpolated to the gather
points of indirect light. As on camera rays, light scatters once: Cycles' default of no volume bounces.
"""

import math
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TypeVar

import torch
from torch import Tensor

from ...scene.values import Recent
from ..geometry.camera import RaySegments, View
from ..geometry.gather_points import GatherPoints
from ..geometry.samples import Samples
from ..geometry.vectors import above, cosine_directions, reflect
from ..geometry.visibility import RayGeometry, Surface, sphere_points
from ..lights.environment import Sky
from ..lights.light_source import LightSource
from .fog import DIRECTIONS, WEIGHTS, FogMedium, SingleScattering, phase_shares
from .secondary_hits import clear_to

T = TypeVar("T")

_ACROSS = 24
_DIFFUSE_RAYS = 6
_SEGMENTS = 5
_NEAR = 0.1  # first cut of a ray, relative to the viewing distance: in thick fog, near light counts most


@dataclass(frozen=True)
class IndirectFog:
    """Effects of fog on indirect light at A gather points, from the S sources of `RadianceTable`."""

    ambient: Tensor  # (A,) transmittance of the world's light
    passing: Tensor  # (A,) transmittance between the point and the surfaces that light it diffusely
    path_transmittance: Tensor  # (A, S) transmittance from a source to those surfaces and on to the point
    light_transmittance: Tensor  # (A, S) transmittance from a source to those surfaces
    scattered: Tensor  # (A, 3) irradiance from light that the fog scatters
    haze: Tensor  # (A, 3) in-scattered radiance in the mirror direction, as if the fog were endless there
    mirrored: Tensor  # (A,) transmittance in the mirror direction


class IndirectFogRays:
    """Rays of one view along which fog is integrated, and their hits; `near` is a typical distance in view, meters."""

    def __init__(
        self, geometry: RayGeometry, samples: Samples, surface: Surface, view: View, gather_points: Tensor, near: float
    ) -> None:
        self._geometry, self._near, self._signature = geometry, near, view.signature()
        self._volume = SingleScattering(geometry.clear)
        coarse = GatherPoints(samples, surface, _ACROSS)
        self._points = points = surface.pick(coarse.index)
        self._smooth = coarse.smooth
        place, distance = samples.place[:, gather_points], samples.hits.distance[gather_points]
        self._to_gather_points = coarse.spread_to(surface.pick(gather_points), place, distance)
        mirrored = above(reflect(samples.toward[:, coarse.index], points.normal), points.facet)
        count = points.position.shape[1]
        uv = sphere_points(_DIFFUSE_RAYS, count, torch.Generator().manual_seed(5)).to(mirrored.device)
        normal, facet = (v.repeat_interleave(_DIFFUSE_RAYS, 1) for v in (points.normal, points.facet))
        diffuse = above(cosine_directions(normal, uv.flatten(1)), facet).view(3, count, _DIFFUSE_RAYS)
        rays = torch.cat((diffuse, mirrored[:, :, None]), 2)  # (3, P, rays)
        self._toward, self._start = rays, geometry.lifted(points)[:, :, None].expand_as(rays)
        start, toward = self._start.flatten(1), rays.flatten(1)
        hits = geometry.first_hits(start, toward, "diffuse")
        self._hit, self._distance = (part.view(rays.shape[1:]) for part in (hits.hit, hits.distance))
        self._surface = geometry.surface(hits, toward)
        ways = DIRECTIONS.to(start)[:, :, None].expand(-1, -1, rays.shape[1])
        begin = self._start[:, None, :, 0].expand_as(ways)
        far = torch.full_like(ways[0], math.inf)
        clear = geometry.clear(begin.flatten(1), ways.flatten(1), far.flatten())
        self._open = clear.view(far.shape)  # (14, P)
        self._irradiance, self._kept = Recent(), Recent()

    def gather(self, fog: FogMedium, lamps: Sequence[LightSource], sky: Sky) -> IndirectFog:
        """Sums the fog's effects at the values of one render."""
        passing, kept, ambient = self._of(fog, "passing", lambda: self._passing(fog))
        mirrored = passing[:, -1]
        columns = []
        for i, lamp in enumerate(lamps):
            make = partial(self._lamp_transmittance, fog, lamp, i, passing)
            columns.append(self._of(fog, i, make, lamp.signature()))
        world = ambient[:, None].expand(-1, 2)
        light_transmittance = torch.cat((*(column[0] for column in columns), world), 1)
        path_transmittance = torch.cat((*(column[1] for column in columns), kept[:, None] * world), 1)
        light = self._light(fog, lamps, sky, passing)  # (3, P, rays)
        scattered = light[:, :, :-1].mean(2) * math.pi
        haze = light[:, :, -1] / (1 - mirrored).clamp_min(1e-4)
        # Few rays are noisy: their sums are averaged over points, then interpolated to the gather points.
        rows = (torch.stack((ambient, kept)), path_transmittance.T, light_transmittance.T, scattered)
        even = self._smooth(torch.cat(rows).T)
        carried = self._to_gather_points(torch.cat((even, haze.T, mirrored[:, None]), 1))
        count = path_transmittance.shape[1]
        single, path, light, scattered, haze, mirrored = carried.split((2, count, count, 3, 3, 1), 1)
        # Light scattered twice crosses the way between surfaces once more.
        ambient, again = single[:, 0], single[:, 1:2]
        path, light = torch.cat((path, path * again), 1), torch.cat((light, light * again), 1)
        return IndirectFog(ambient, single[:, 1], path, light, scattered, haze, mirrored[:, 0])

    def _of(self, fog: FogMedium, name: Hashable, make: Callable[[], T], key: Hashable = None) -> T:
        """A value that depends on the fog and a key; made again when they change, or while the fog needs gradients."""
        return make() if fog.signature is None else self._kept.of(name, (fog.signature, key), make)

    def _passing(self, fog: FogMedium) -> tuple[Tensor, Tensor, Tensor]:
        """Transmittance (P, rays) of the rays, (P,) of the diffuse ones that hit surfaces, and (P,) of the world's light."""
        passing = fog.transmittance(self._start, self._toward, self._distance)
        diffuse, hit = passing[:, :-1], self._hit[:, :-1].to(passing.dtype)
        kept = (diffuse * hit + 1e-3 * diffuse).sum(1) / (hit + 1e-3).sum(1)
        # The world's light is weighted by the cosine.
        ways = DIRECTIONS.to(self._start)
        facing = (ways.T @ self._points.normal).clamp_min(0) * WEIGHTS.to(ways)[:, None]
        far = torch.full_like(facing, math.inf)
        reaching = fog.transmittance(self._start[:, None, :, 0], ways[:, :, None], far)
        facing = facing * (self._open + 1e-3)
        return passing, kept, (reaching * facing).sum(0) / facing.sum(0)

    def _lamp_transmittance(
        self, fog: FogMedium, lamp: LightSource, index: int, passing: Tensor
    ) -> tuple[Tensor, Tensor]:
        """Transmittance (P, 1) from a light to the hits of diffuse rays, and from there on, `passing` (P, rays), to the points."""
        still, position = lamp.detached(), self._surface.position

        @torch.no_grad()
        def weights() -> Tensor:  # irradiance (P, rays) where the rays end; never 0, because its sum is a divisor
            direct = still.irradiance(position, self._surface.normal)
            irradiance = direct.irradiance * clear_to(self._geometry, still, direct, self._surface)
            irradiance = (irradiance.view(self._hit.shape) * self._hit)[:, :-1]
            return irradiance + 1e-3 * irradiance.mean() + 1e-12

        weight = self._irradiance.of(index, lamp.signature(), weights)
        share = fog.transmittance(position, *still.toward(position)).view(self._hit.shape)[:, :-1]
        total = weight.sum(1, keepdim=True)
        light = (weight * share).sum(1, keepdim=True) / total
        return light, (weight * share * passing[:, :-1]).sum(1, keepdim=True) / total

    def _light(self, fog: FogMedium, lamps: Sequence[LightSource], sky: Sky, passing: Tensor) -> Tensor:
        """Radiance (3, P, rays) that the fog sends back along the rays."""
        start, toward, points, count = self._start, self._toward, *self._hit.shape
        reach = fog.reach(start.detach().mean((1, 2)))
        near = self._near * _NEAR
        growth = (1 + reach / near) ** (1 / _SEGMENTS)
        cuts = near * (growth ** torch.arange(_SEGMENTS + 1, device=start.device) - 1)
        cuts = torch.minimum(cuts[:, None, None].expand(-1, points, count), self._distance)
        rays = RaySegments(start, toward, cuts, (self._signature, reach))
        depth = torch.exp(-fog.density * fog.thickness(start[:, None], toward[:, None], cuts))
        light = torch.zeros((3, _SEGMENTS, points, count), device=start.device)
        for lamp in (lamp for lamp in lamps if lamp.shines):
            light = light + self._volume.lamp_light(fog, rays, lamp, 1)
        light = (light * (depth[:-1] - depth[1:])).sum(1)
        # The world's light, scattered back by endless fog, from the mean depth of scattering.
        arriving = self._of(fog, "world", lambda: self._world_arriving(fog, passing))
        world = (sky.color[:, None] * sky.soft(DIRECTIONS.to(passing))).expand(3, -1)
        light = light + torch.einsum("cd,dpr->cpr", world, arriving) * (1 - passing)
        return light * fog.albedo[:, None, None]

    def _world_arriving(self, fog: FogMedium, passing: Tensor) -> Tensor:
        """Shares (14, P, rays) of the world's radiance from `DIRECTIONS` that are scattered back."""
        ways = DIRECTIONS.to(self._start)
        way = fog.thickness(self._start, self._toward, self._distance.clamp_max(1e6)).detach()
        depth = (fog.density.detach() * way).clamp_min(1e-3)
        mean = way * (1 / depth - 1 / torch.expm1(depth.clamp_max(60.0)))  # of t exp(-t) over the way
        place = self._start + self._toward * mean
        far = torch.full((len(ways.T), *passing.shape), math.inf, device=ways.device)
        reaching = fog.transmittance(place[:, None], ways[:, :, None, None], far) * self._open[:, :, None]
        return reaching * phase_shares(torch.einsum("cd,cpr->dpr", ways, self._toward), fog.anisotropy)
