# SPDX-License-Identifier: Apache-2.0
"""Fog between surfaces: in-scattered light on them, transmittance of indirect light, haze in reflections.

All of it varies slowly: it is integrated along a few rays from a very coarse grid of points, and interpolated to the
gather points of indirect light. As on camera rays, light scatters once: Cycles' default of no volume bounces.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from ..geometry.camera import RaySegments, View
from ..geometry.gather_points import GatherPoints
from ..geometry.samples import Samples
from ..geometry.vectors import above, cosine_directions, reflect
from ..geometry.visibility import RayGeometry, Surface, sphere_points
from ..lights.environment import Sky
from ..lights.light_source import LightSource
from .fog import DIRECTIONS, WEIGHTS, FogMedium, SingleScattering, phase
from .secondary_hits import shadowed_irradiance

_ACROSS = 24
_DIFFUSE_RAYS = 6
_SEGMENTS = 5
_NEAR = 0.1  # first cut of a ray, of the view's distance: in thick fog, light scattered close counts most


@dataclass(frozen=True)
class IndirectFog:
    """Effects of fog on indirect light at A gather points.

    The S sources are those of `RadianceTable`: L lights and 2 hemispheres, then the same for light scattered twice.
    """

    ambient: Tensor  # (A,) transmittance of the world's light
    passing: Tensor  # (A,) transmittance between the point and the surfaces that light it diffusely
    path_transmittance: Tensor  # (A, S) transmittance from a source over such a surface to the point
    light_transmittance: Tensor  # (A, S) transmittance from a source to those surfaces
    scattered: Tensor  # (A, 3) irradiance from light that the fog scatters
    haze: Tensor  # (A, 3) in-scattered radiance in the mirror direction, as if the fog were endless there
    mirrored: Tensor  # (A,) transmittance in the mirror direction


class IndirectFogRays:
    """Rays of one view along which fog is integrated, and their hits; `near` is a typical distance in view, meters."""

    def __init__(
        self,
        geometry: RayGeometry,
        samples: Samples,
        surface: Surface,
        view: View,
        gather_points: Tensor,
        near: float,
    ) -> None:
        self._geometry, self._near, self._signature = geometry, near, view.signature()
        self._volume = SingleScattering(geometry.clear)
        coarse = GatherPoints(samples, surface, _ACROSS)
        self._points = points = surface.pick(coarse.index)
        self._smooth = coarse.smooth
        distance = samples.hits.distance[gather_points]
        self._to_gather_points = coarse.spread_to(
            surface.pick(gather_points), samples.place[:, gather_points], distance
        )
        mirrored = above(reflect(samples.toward[:, coarse.index], points.normal), points.facet)
        rays = torch.cat((_diffuse(points), mirrored[:, :, None]), 2)  # (3, P, rays)
        self._toward = rays
        self._start = geometry.lifted(points)[:, :, None].expand_as(rays)
        start, toward = self._start.flatten(1), rays.flatten(1)
        hits = geometry.first_hits(start, toward, "diffuse")
        self._hit = hits.hit.view(rays.shape[1:])
        self._distance = hits.distance.view(rays.shape[1:])
        self._surface = geometry.surface(hits, toward)
        ways = DIRECTIONS.to(start)[:, :, None].expand(-1, -1, rays.shape[1])
        begin = self._start[:, None, :, 0].expand_as(ways)
        far = torch.full_like(ways[0], math.inf)
        clear = geometry.clear(begin.flatten(1), ways.flatten(1), far.flatten())
        self._open = clear.view(far.shape)  # (14, P)
        self._irradiance: dict[int, tuple[object, Tensor]] = {}

    def gather(self, fog: FogMedium, lamps: Sequence[LightSource], sky: Sky) -> IndirectFog:
        """Sums the fog's effects at the values of one render."""
        passing = fog.transmittance(self._start, self._toward, self._distance)  # (P, rays)
        diffuse, mirrored = passing[:, :-1], passing[:, -1]
        hit = self._hit[:, :-1].to(passing.dtype)
        kept = (diffuse * hit + 1e-3 * diffuse).sum(1) / (hit + 1e-3).sum(1)
        ambient = self._ambient(fog)
        light_transmittance, path_transmittance = self._light_transmittance(fog, lamps, diffuse)
        light_transmittance = torch.cat((light_transmittance, ambient[:, None].expand(-1, 2)), 1)
        path_transmittance = torch.cat((path_transmittance, (kept * ambient)[:, None].expand(-1, 2)), 1)
        light = self._light(fog, lamps, sky, passing)  # (3, P, rays)
        scattered = light[:, :, :-1].mean(2) * math.pi
        haze = light[:, :, -1] / (1 - mirrored).clamp_min(1e-4)
        # A few rays are noisy: what they bring is averaged, then interpolated to the gather points.
        rows = (torch.stack((ambient, kept)), path_transmittance.T, light_transmittance.T, scattered)
        even = self._smooth(torch.cat(rows).T)
        carried = self._to_gather_points(torch.cat((even, haze.T, mirrored[:, None]), 1))
        count = path_transmittance.shape[1]
        single, path, light, scattered, haze, mirrored = carried.split((2, count, count, 3, 3, 1), 1)
        # Light scattered twice crosses the way between surfaces once more.
        ambient, again = single[:, 0], single[:, 1:2]
        path, light = torch.cat((path, path * again), 1), torch.cat((light, light * again), 1)
        return IndirectFog(ambient, single[:, 1], path, light, scattered, haze, mirrored[:, 0])

    def _ambient(self, fog: FogMedium) -> Tensor:
        """Transmittance (P,) of the world's light, cosine-weighted."""
        ways = DIRECTIONS.to(self._start)
        facing = (ways.T @ self._points.normal).clamp_min(0) * WEIGHTS.to(ways)[:, None]
        far = torch.full_like(facing, math.inf)
        reaching = fog.transmittance(self._start[:, None, :, 0], ways[:, :, None], far)
        facing = facing * (self._open + 1e-3)
        return (reaching * facing).sum(0) / facing.sum(0)

    def _light_transmittance(
        self, fog: FogMedium, lamps: Sequence[LightSource], passing: Tensor
    ) -> tuple[Tensor, Tensor]:
        """Transmittance (P, L) from the lights to the hits of diffuse rays, and from there on (P, rays) to the points."""
        position = self._surface.position
        light_transmittance = [passing.new_zeros((len(passing), 0))]
        path_transmittance = [light_transmittance[0]]
        for i, lamp in enumerate(lamps):
            # The light's irradiance (P, rays) where the diffuse rays end, never 0: it is divided by.
            kept = self._irradiance.get(i)
            if kept is None or kept[0] != lamp.signature():
                with torch.no_grad():
                    irradiance = shadowed_irradiance(self._geometry, lamp.detached(), self._surface)
                    irradiance = (irradiance.view(self._hit.shape) * self._hit)[:, :-1]
                kept = lamp.signature(), irradiance + 1e-3 * irradiance.mean() + 1e-12
                self._irradiance[i] = kept
            weight = kept[1]
            share = fog.transmittance(position, *lamp.detached().toward(position))
            share = share.view(self._hit.shape)[:, :-1]
            total = weight.sum(1, keepdim=True)
            light_transmittance.append((weight * share).sum(1, keepdim=True) / total)
            path_transmittance.append((weight * share * passing).sum(1, keepdim=True) / total)
        return torch.cat(light_transmittance, 1), torch.cat(path_transmittance, 1)

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
        for lamp in lamps:
            light = light + self._volume.lamp_light(fog, rays, lamp, 1)
        light = (light * (depth[:-1] - depth[1:])).sum(1)
        light = light + self._world(fog, sky, passing) * (1 - passing)
        return light * fog.albedo[:, None, None]

    def _world(self, fog: FogMedium, sky: Sky, passing: Tensor) -> Tensor:
        """The world's light (3, P, rays) scattered back by endless fog, from the mean depth of scattering."""
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
