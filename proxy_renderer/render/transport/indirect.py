# SPDX-License-Identifier: Apache-2.0
"""Indirect light of the samples: from other surfaces, and from the world, with the fog between surfaces.

Diffuse light and blurred reflections vary slowly. They are gathered at few points, where one matrix product per render weights
all rays, and interpolated to the samples (an irradiance cache). Mirror images are traced per sample.

Fog scatters light onto surfaces, dims indirect light, and adds haze to reflections. It is integrated along a few rays from a very
coarse grid of points, and interpolated to the gather points. As on camera rays, light scatters once.
"""

import math
from collections.abc import Callable, Hashable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Self, TypeVar

import torch
from torch import Tensor

from ...scene.values import Recent
from ..geometry.camera import RaySegments, View
from ..geometry.gather_points import GatherPoints, SparseWeights
from ..geometry.samples import Samples
from ..geometry.vectors import above, cosine_directions, length, reflect
from ..geometry.visibility import RayGeometry, Surface, shared_points, sphere_points
from ..lights.emitters import Emitters
from ..lights.environment import GLOSSY, Sky
from ..lights.light_source import LightSource
from ..material.inputs import MaterialTextures
from .fog import DIRECTIONS, WEIGHTS, FogMedium, LightPaths, SingleScattering, phase_shares
from .glow import LobeRays, glow_of
from .secondary_hits import RadianceTable, SecondaryHits, clear_to

T = TypeVar("T")

_FOG_ACROSS = 24
_FOG_RAYS = 6
_FOG_SEGMENTS = 5
_FOG_NEAR = 0.1  # first cut of a ray, relative to the viewing distance: in thick fog, near light counts most
_DIFFUSE_RAYS = 16
_GLOSSY_RAYS = 8


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
        coarse = GatherPoints(samples, surface, _FOG_ACROSS)
        self._points = points = surface.pick(coarse.index)
        self._smooth = coarse.smooth
        place, distance = samples.place[:, gather_points], samples.hits.distance[gather_points]
        self._to_gather_points = coarse.spread_to(surface.pick(gather_points), place, distance)
        mirrored = above(reflect(samples.toward[:, coarse.index], points.normal), points.facet)
        count = points.position.shape[1]
        uv = sphere_points(_FOG_RAYS, count, torch.Generator().manual_seed(5)).to(mirrored.device)
        normal, facet = (v.repeat_interleave(_FOG_RAYS, 1) for v in (points.normal, points.facet))
        diffuse = above(cosine_directions(normal, uv.flatten(1)), facet).view(3, count, _FOG_RAYS)
        rays = torch.cat((diffuse, mirrored[:, :, None]), 2)  # (3, P, rays)
        self._toward, self._start = rays, geometry.lifted(points)[:, :, None].expand_as(rays)
        start, toward = self._start.flatten(1), rays.flatten(1)
        hits = geometry.first_hits(start, toward, "diffuse")
        self._hit, self._distance = (part.view(rays.shape[1:]) for part in (hits.hit, hits.distance))
        self._surface = geometry.surface(hits, toward)
        ways = DIRECTIONS.to(start)[:, :, None].expand(-1, -1, rays.shape[1])
        begin = self._start[:, None, :, 0].expand_as(ways)
        far = torch.full_like(ways[0], math.inf)
        self._open = geometry.clear(begin.flatten(1), ways.flatten(1), far.flatten()).view(far.shape)  # (14, P)
        self._irradiance, self._kept = Recent(), Recent()

    def gather(self, fog: FogMedium, lamps: Sequence[LightSource], sky: Sky) -> IndirectFog:
        """Effects of the fog on indirect light at the gather points, at the values of one render."""
        passing, kept, ambient = self._of(fog, "passing", lambda: self._passing(fog))
        mirrored = passing[:, -1]
        columns = []
        for i, lamp in enumerate(lamps):
            columns.append(self._of(fog, i, partial(self._transmittances, fog, lamp, i, passing), lamp.signature()))
        world = ambient[:, None].expand(-1, 2)
        light_transmittance = torch.cat((*(column[0] for column in columns), world), 1)
        path_transmittance = torch.cat((*(column[1] for column in columns), kept[:, None] * world), 1)
        light = self._light(fog, lamps, sky, passing)  # (3, P, rays)
        scattered = light[:, :, :-1].mean(2) * math.pi
        haze = light[:, :, -1] / (1 - mirrored).clamp_min(1e-4)
        # Few rays are noisy: their sums are averaged over points, then interpolated to the gather points.
        rows = (torch.stack((ambient, kept)), path_transmittance.T, light_transmittance.T, scattered)
        carried = self._to_gather_points(torch.cat((self._smooth(torch.cat(rows).T), haze.T, mirrored[:, None]), 1))
        count = path_transmittance.shape[1]
        single, path, light, scattered, haze, mirrored = carried.split((2, count, count, 3, 3, 1), 1)
        # Light scattered twice crosses the way between surfaces once more.
        ambient, again = single[:, 0], single[:, 1:2]
        path, light = torch.cat((path, path * again), 1), torch.cat((light, light * again), 1)
        return IndirectFog(ambient, single[:, 1], path, light, scattered, haze, mirrored[:, 0])

    def _of(self, fog: FogMedium, name: Hashable, make: Callable[[], T], key: Hashable = None) -> T:
        """The result of `make`, cached by name until fog or `key` change; not cached while the fog needs gradients."""
        return make() if fog.signature is None else self._kept.of(name, (fog.signature, key), make)

    def _passing(self, fog: FogMedium) -> tuple[Tensor, Tensor, Tensor]:
        """Transmittance of fog along rays (P, rays), along diffuse rays that hit a surface (P,), to the world (P,)."""
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

    def _transmittances(self, fog: FogMedium, lamp: LightSource, index: int, passing: Tensor) -> tuple[Tensor, Tensor]:
        """Fog's transmittance (P, 1) from a light to the hits of diffuse rays, and (P, 1) from the light to the points.

        `passing` (P, rays) is the transmittance along the rays.
        """
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
        near = self._near * _FOG_NEAR
        growth = (1 + reach / near) ** (1 / _FOG_SEGMENTS)
        cuts = near * (growth ** torch.arange(_FOG_SEGMENTS + 1, device=start.device) - 1)
        cuts = torch.minimum(cuts[:, None, None].expand(-1, points, count), self._distance)
        rays = RaySegments(start, toward, cuts, (self._signature, reach))
        depth = torch.exp(-fog.density * fog.thickness(start[:, None], toward[:, None], cuts))
        light = torch.zeros((3, _FOG_SEGMENTS, points, count), device=start.device)
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


@dataclass(frozen=True)
class IndirectLight:
    """Light of other surfaces and of the world at N samples."""

    irradiance: Tensor  # (3, N) of surfaces and world
    glossy: Tensor  # (3, N) blurred reflection of surfaces and fog, without the world
    mirror: Tensor  # (3, N) mirror image of surfaces and fog, without the world
    open_glossy: Tensor  # (N,) share of the world in the blurred reflection
    open_mirror: Tensor  # (N,) share of the world in the mirror image
    gather_points: Tensor  # (A, 3) irradiance at the gather points
    # radiance (3, N) of glowing surfaces, not in `glossy` and `mirror`: their mirror image, then blurred by each of
    # `glow.BLURS`. Empty if nothing glows.
    glow: tuple[Tensor, ...] = ()


@dataclass(frozen=True)
class _PointWeights:
    """Weights of the radiances of a `RadianceTable` at A points.

    Weights of scattered light are millions if there are many lights. Those of lights that have moved are kept apart, so
    that the others need no copy.
    """

    _all: Tensor  # (A, S, M) of what materials scatter of each source
    emission: Tensor  # (A, M) of what materials emit
    sky: Tensor  # (A, 9) of the world's harmonics
    _moved: Mapping[int, Tensor] = field(default_factory=dict)  # source to (A, M), used instead of `_all`

    @classmethod
    def of(cls, weights: Tensor, sky: Tensor) -> Self:
        """From weights (A, S + 1, M), of which the last are those of emission, and weights of the world's harmonics (A, 9)."""
        return cls(weights[:, :-1].contiguous(), weights[:, -1].clone(), sky)

    def with_lamp(self, sources: Sequence[int], weights: Tensor) -> Self:
        """A copy with other weights (A, n, M) of scattered light for n `sources`, numbers of rows of the table."""
        return replace(self, _moved={**self._moved, **dict(zip(sources, weights.unbind(1), strict=True))})

    def scattered(self, table: RadianceTable, shares: Tensor | None = None) -> Tensor:
        """Scattered light (A, 3); fog lets the shares (A, S) of each source through, all if None."""
        rows = table.scattered
        if self._moved:
            rows = rows.index_fill(0, torch.tensor([*self._moved], device=rows.device), 0.0)
        if shares is None:
            light = self._all.flatten(1) @ rows.flatten(0, 1)
        else:
            light = torch.einsum("sac,as->ac", torch.bmm(self._all.transpose(0, 1), rows), shares)
        for source, weights in self._moved.items():
            there = weights @ table.scattered[source]
            light = light + (there if shares is None else there * shares[:, source, None])
        return light


class FinalGather:
    """Bounced light and reflections for the samples of one view; `lamps` is the number of lights or clusters."""

    def __init__(
        self,
        geometry: RayGeometry,
        samples: Samples,
        surface: Surface,
        view: View,
        metals: Tensor,
        lamps: int,
        emitters: Emitters,
        maps: MaterialTextures,
        generator: torch.Generator,
    ) -> None:
        self._view = view
        self._borrowed = False  # whether hits are shared with the original of a copy
        self._gather_points = gather_points = GatherPoints(samples, surface)
        self.gather_points = gather_points.index  # (A,) of the samples at which diffuse light is gathered
        points = surface.pick(gather_points.index)
        origin = geometry.lifted(points)
        lobes = LobeRays.of(points, samples.toward[:, gather_points.index])
        near, wide = gather_points.turns(2), gather_points.turns(4)
        glossy = shared_points(_GLOSSY_RAYS, near, generator)
        diffuse = shared_points(_DIFFUSE_RAYS, wide, generator)
        # Light from metals on matte surfaces is a caustic: metals scatter it evenly here, right on average.
        wide_rays = geometry, origin, lobes.hemisphere(diffuse), _DIFFUSE_RAYS, torch.zeros_like(metals)
        self.diffuse = SecondaryHits(*wide_rays, lamps, "diffuse", deep=True)
        narrow_rays = geometry, origin, lobes.reflections(glossy, GLOSSY**2), _GLOSSY_RAYS, metals
        self.glossy = SecondaryHits(*narrow_rays, lamps, "glossy", deep=True)
        mirrored = above(reflect(samples.toward[:, : samples.surfaces], surface.normal), surface.facet)
        self.mirror = SecondaryHits(geometry, geometry.lifted(surface), mirrored, 1, metals, lamps, "glossy", maps)
        self._mirror_ambient = self.spread_to(self.mirror)
        self._paths = LightPaths(surface.position, mirrored, self.mirror.distance)
        self._opening = gather_points.smooth_glossy(self.glossy.open[:, None])
        self._open_glossy = gather_points.spread(self._opening)[:, 0]
        self._weights: tuple[_PointWeights, _PointWeights] | None = None
        self._blurred: list[Tensor] = []  # (A, M) shares of glowing materials in blurred reflections
        self._lamps = lamps
        self._glow: list[Tensor] = []  # see `glow_of`; empty if nothing glows
        if emitters.clusters:
            self._glow = glow_of(geometry, lobes, near, wide, emitters.clusters, generator)

    def aside(self) -> Self:
        """A copy in which lights may move while this one stays as it is."""
        other = copy(self)
        other._borrowed = True
        return other

    def with_mirrors(self, metals: Tensor, lamps: Mapping[int, LightSource]) -> Self:
        """A copy with other mirror weights (M,); see `SecondaryHits.with_mirrors`."""
        other = self.aside()
        other.glossy = self.glossy.with_mirrors(metals, lamps)
        other.mirror = self.mirror.with_mirrors(metals, lamps)
        other._weights = None
        return other

    def light(self, index: int, lamp: LightSource, same_rays: bool) -> None:
        """Traces shadow rays again for a light that has moved; see `SecondaryHits.light`."""
        if self._borrowed:
            self.diffuse, self.glossy, self.mirror = (h.aside() for h in (self.diffuse, self.glossy, self.mirror))
            self._borrowed = False
        for hits in (self.diffuse, self.glossy, self.mirror):
            hits.light(index, lamp, same_rays)
        if self._weights is not None:
            rows = index, self._lamps + 2 + index
            wide, narrow = (hits.weights(rows) for hits in (self.diffuse, self.glossy))
            diffuse, blurred = self._weights
            moved = diffuse.with_lamp(rows, self._gather_points.smooth(wide) * math.pi)
            self._weights = moved, blurred.with_lamp(rows, self._gather_points.smooth_glossy(narrow))

    def spread_to(self, hits: SecondaryHits) -> SparseWeights:
        """Interpolation of irradiance from the gather points to hits that the image shows, or nearly shows."""
        surface = hits.surface
        distance = length(surface.position - self._view.position[:, None])
        return self._gather_points.spread_to(surface, self._view.project(surface.position), distance, hits.hit.bool())

    def gather(self, table: RadianceTable) -> IndirectLight:
        """The indirect light of one render, without fog."""
        wide, narrow = self._weighed()
        low = (wide.scattered(table) + wide.emission @ table.emission + wide.sky @ table.sky).clamp_min(0.0)
        glossy = narrow.scattered(table) + narrow.emission @ table.emission
        glow = [share @ table.emission for share in self._blurred]
        full = self._gather_points.spread(torch.cat((low, glossy, *glow), 1)).T
        mirror = self.mirror.image(self._dark(table), self._mirror_ambient(low).T)
        shown = self._shown_glow(table, full[6:])
        return IndirectLight(full[:3], full[3:6], mirror, self._open_glossy, self.mirror.open, low, shown)

    def gather_through(self, table: RadianceTable, fog: FogMedium, indirect_fog: IndirectFog) -> IndirectLight:
        """The indirect light of one render, dimmed by fog, with the light that the fog scatters."""
        wide, narrow = self._weighed()
        low = wide.scattered(table, indirect_fog.path_transmittance)
        low = low + (wide.emission @ table.emission) * indirect_fog.passing[:, None]
        low = low + (wide.sky @ table.sky) * indirect_fog.ambient[:, None]
        low = low.clamp_min(0.0) + indirect_fog.scattered
        through = indirect_fog.mirrored[:, None]
        glossy = narrow.scattered(table, indirect_fog.light_transmittance) + narrow.emission @ table.emission
        glossy = glossy * through + indirect_fog.haze * (1 - through)
        opening = self._opening * through
        glow = [(share @ table.emission) * through for share in self._blurred]
        full = self._gather_points.spread(torch.cat((low, glossy, indirect_fog.haze, opening, *glow), 1)).T
        passing = self._paths.transmittance(fog)
        dark, shares = self._dark(table), indirect_fog.light_transmittance.mean(0)
        dim = replace(dark, scattered=dark.scattered * shares[:, None, None])
        mirror = self.mirror.image(dim, self._mirror_ambient(low).T) * passing + full[6:9] * (1 - passing)
        shown = self._shown_glow(table, full[10:], passing)
        return IndirectLight(full[:3], full[3:6], mirror, full[9], self.mirror.open * passing, low, shown)

    def following(self, gathered: IndirectLight, table: RadianceTable, lamps: Sequence[LightSource]) -> IndirectLight:
        """`gathered`, with gradients added with respect to the placement of lights that need them.

        These gradients ignore changes of shadows, and fog between surfaces.
        """
        moving = [(index, lamp) for index, lamp in enumerate(lamps) if lamp.moving]
        if not moving:
            return gathered
        wide, narrow, mirror = (
            torch.stack([hits.moved(*row, table) for row in moving]).sum(0)
            for hits in (self.diffuse, self.glossy, self.mirror)
        )
        low = self._gather_points.smooth(wide) * math.pi
        full = self._gather_points.spread(torch.cat((low, narrow), 1)).T
        more = {"irradiance": full[:3], "glossy": full[3:], "mirror": mirror.T, "gather_points": low}
        return replace(gathered, **{name: getattr(gathered, name) + light for name, light in more.items()})

    def _weighed(self) -> tuple[_PointWeights, _PointWeights]:
        """Weights of diffuse light, and of blurred reflections, which do not contain the world."""
        if self._weights is None:
            wide = self._gather_points.smooth(self.diffuse.weights()) * math.pi  # irradiance from mean radiance
            narrow = self._gather_points.smooth_glossy(self.glossy.weights())
            if self._glow:
                hemisphere, *narrower, widest = self._glow
                wide[:, -1], narrow[:, -1] = self._gather_points.smooth(hemisphere) * math.pi, 0.0
                # Averaging would blur edges of glow; only the widest lobe is noisy enough to need it.
                self._blurred = [*narrower, self._gather_points.smooth_glossy(widest)]
            sky = self._gather_points.smooth(self.diffuse.harmonics.T) * math.pi
            self._weights = _PointWeights.of(wide, sky), _PointWeights.of(narrow, torch.zeros_like(sky))
        return self._weights

    def _shown_glow(self, table: RadianceTable, blurred: Tensor, passing: Tensor | float = 1.0) -> tuple[Tensor, ...]:
        """`IndirectLight.glow`: the mirror image, of which fog lets `passing` through, and blurred ones (3 K, N)."""
        if not self._glow:
            return ()
        emission = torch.cat((table.emission, table.emission.new_zeros((1, 3))))  # none outside the scene
        return emission.T.index_select(1, self.mirror.owner) * passing, *blurred.split(3)

    def _dark(self, table: RadianceTable) -> RadianceTable:
        """The table without emission if glowing surfaces are searched for separately."""
        return replace(table, emission=torch.zeros_like(table.emission)) if self._glow else table
