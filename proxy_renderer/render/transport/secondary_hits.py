# SPDX-License-Identifier: Apache-2.0
"""Secondary rays: traced once per view, straight or refracted through glass, their hits shaded anew in every render.

The radiance of a hit is albedo x irradiance / pi + emission. One more ray from the hit adds a second bounce, with the same
albedo. That is linear in albedo x light: all rays of a point become one fixed row of weights over a small table of radiances.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass

import torch
from jaxtyping import Float
from torch import Tensor

from ..geometry.vectors import above, cosine_directions, dot, reflect, unit
from ..geometry.visibility import RayGeometry, Surface
from ..lights.environment import harmonics
from ..lights.light_source import DirectIrradiance, LightSource
from ..material.inputs import MaterialTextures

_WORLD_AT_SECOND = 0.3  # most of the world that second hits get; less in rooms, which rays rarely leave
_MOST_WALLS = 8  # surfaces of glass that a ray is followed through; Cycles' default is twelve


@dataclass(frozen=True)
class RadianceTable:
    """Radiance of all that secondary rays can meet, in one render.

    There are S = 2 (L + 2) sources: the L lights and both hemispheres of the world, then the same again for light scattered twice.
    """

    scattered: Tensor  # (S, M, 3) radiance that each material scatters of each source
    emission: Tensor  # (M, 3) radiance that each material emits
    sky: Tensor  # (9, 3) spherical harmonics of the world
    albedo: Tensor  # (M, 3) share of light that each material scatters, or reflects if it is a metal


class _HitRadiance(torch.autograd.Function):
    """Radiance (3, N) that N rays meet, 0 where they leave the scene; computed by material, without a sparse matrix.

    `ambient` (3, N) is irradiance besides that of the table's sources. `incoming` (S, N) is how much of each source a hit gets.
    `members` has the indices of each material's hits. `relative_base_color` (3, N) is texture over mean color.
    """

    @staticmethod
    def forward(ctx, scattered, emission, albedo, ambient, incoming, members, relative_base_color):
        ctx.save_for_backward(albedo, ambient)
        ctx.relative_base_color = relative_base_color
        ctx.members, ctx.incoming = members, incoming
        out = torch.zeros((3, incoming.shape[1]), device=incoming.device)
        for m, chosen in enumerate(members):
            if len(chosen):
                light = scattered[:, m].T @ incoming.index_select(1, chosen)
                light += ambient.index_select(1, chosen) * albedo[m][:, None]
                if relative_base_color is not None:
                    light *= relative_base_color.index_select(1, chosen)
                out.index_copy_(1, chosen, light + emission[m][:, None])
        return out

    @staticmethod
    def backward(ctx, gradient):
        albedo, ambient = ctx.saved_tensors
        scattered = gradient.new_zeros((len(ctx.incoming), len(albedo), 3))
        emission, albedos, ambients = (torch.zeros_like(each) for each in (albedo, albedo, ambient))
        for m, chosen in enumerate(ctx.members):
            if len(chosen):
                part = gradient.index_select(1, chosen)
                emission[m] = part.sum(1)
                if ctx.relative_base_color is not None:
                    part = part * ctx.relative_base_color.index_select(1, chosen)
                scattered[:, m] = ctx.incoming.index_select(1, chosen) @ part.T
                albedos[m] = (part * ambient.index_select(1, chosen)).sum(1)
                ambients.index_copy_(1, chosen, part * albedo[m][:, None])
        return scattered, emission, albedos, ambients, None, None, None


class SecondaryHits:
    """R rays, of a kind in `RAYS`, from each of A points, and the surfaces that they hit.

    They start at `origin` (3, A), `count` = R each, in unit directions `toward` (3, A * R). `metals` (M,) are weights of mirror
    reflection of the materials, `lamps` is the number of lights or clusters, `maps` has textures of the hits, None for each
    material's mean color. If `deep`, hits get the world's light and a second bounce.
    """

    def __init__(
        self,
        geometry: RayGeometry,
        origin: Tensor,
        toward: Tensor,
        count: int,
        metals: Tensor,
        lamps: int,
        ray: str,
        maps: MaterialTextures | None = None,
        deep: bool = False,
    ) -> None:
        self.geometry, self.count = geometry, count
        hits = geometry.first_hits(origin.repeat_interleave(count, 1), toward, ray)
        self.hit = hits.hit.to(torch.float32)
        self.surface = geometry.surface(hits, toward)
        self.distance = hits.distance
        self._relative_base_color = maps.relative_base_color(self.surface, geometry) if maps else None
        self.open = 1 - self.hit.view(-1, count).mean(1)  # (A,) share of rays that leave the scene
        self.materials, self.lamps = len(metals), lamps
        self.owner = self.surface.material * hits.hit + self.materials * ~hits.hit
        self._members: list[Tensor] = []
        # Rows: every light and both hemispheres of the world at the hits, then the same at second hits.
        self.incoming = torch.zeros((2 * (lamps + 2), len(self.hit)), device=self.hit.device)
        self._clear = torch.zeros_like(self.incoming)
        self.toward, self._deep = toward, deep
        self._seconds: list[tuple[Tensor, Surface]] = []
        self._beyond = torch.zeros((3, len(self.hit)), device=self.hit.device)
        self._weigh(metals)
        self._look_around(torch.ones_like(hits.hit))
        self.harmonics = (harmonics(toward) * (1 - self.hit)).view(9, -1, count).mean(2)

    def _weigh(self, metals: Tensor) -> None:
        """Sets the mirror weights of materials (M,), and what follows from them."""
        self.mirror_weight = metals[self.surface.material] * self.hit  # (A * R,) of the hits
        self._matte = (self.hit > self.mirror_weight).nonzero()[:, 0]  # mirrors do not scatter light
        self._first = self.surface.pick(self._matte)
        # If not deep, second rays have the mirrored share; ambient light (see `image`) has the rest.
        self._share = torch.ones_like(self.hit) if self._deep else self.mirror_weight

    def with_mirrors(self, metals: Tensor, lamps: Mapping[int, LightSource]) -> SecondaryHits:
        """A copy with other mirror weights (M,); only hits whose weight changes are traced again.

        `lamps`: index of a light -> the light for which shadow rays were traced before.
        """
        other = self.aside()
        other._weigh(metals)
        changed = other.mirror_weight != self.mirror_weight
        other.incoming[:, changed], other._clear[:, changed] = 0.0, 0.0
        other._seconds, other._beyond = [], torch.where(changed, 0.0, self._beyond)
        for rays, surface in self._seconds:
            same = (~changed[rays]).nonzero()[:, 0]
            other._seconds.append((rays[same], surface.pick(same)))
        other._look_around(changed)
        for index, lamp in lamps.items():
            other.light(index, lamp, among=changed)
        return other

    def _look_around(self, among: Tensor) -> None:
        """Traces second rays from the hits in `among` (A * R,) bool: to the world, or the surface of a second bounce."""
        around = self.hit.bool() if self._deep else self.mirror_weight > 0
        chosen = (among & around).nonzero()[:, 0]
        if len(chosen):
            # One ray from each: mirrored at metals, cosine-distributed elsewhere.
            generator = torch.Generator().manual_seed(7)
            uv = torch.rand((2, len(self.hit)), generator=generator).to(self.hit.device)[:, chosen]
            start, mirror_weight = self.surface.pick(chosen), self.mirror_weight[chosen]
            mirrored = reflect(self.toward[:, chosen], start.normal)
            toward = torch.lerp(cosine_directions(start.normal, uv), mirrored, mirror_weight)
            toward = above(unit(toward), start.facet)
            hits = self.geometry.first_hits(self.geometry.lifted(start), toward, "diffuse", chosen)
            hit_share = hits.hit.to(torch.float32)
            beyond, leaves = self.geometry.surface(hits, toward), 1 - hit_share
            facing = torch.where(mirror_weight > 0, torch.where(toward[2] > 0, 1.0, -1.0), start.normal[2])
            upper, share = (1 + facing) / 2, leaves * self._share[chosen]
            self.incoming[self.lamps, chosen] = upper * share
            self.incoming[self.lamps + 1, chosen] = (1 - upper) * share
            upper = (1 + beyond.normal[2]) / 2
            self._beyond[:, chosen] = torch.stack((upper * hit_share, (1 - upper) * hit_share, leaves))
            again = hits.hit.nonzero()[:, 0]
            self._seconds.append((chosen[again], beyond.pick(again)))
        if bool(around.any()):
            up, down, leaves = self._beyond
            self.incoming[-2:] = torch.stack((up, down)) * leaves[around].mean().clamp_max(_WORLD_AT_SECOND)

    def aside(self) -> SecondaryHits:
        """A copy in which lights may move while this one stays as it is."""
        other = copy(self)
        other.incoming, other._clear = self.incoming.clone(), self._clear.clone()
        return other

    def light(self, index: int, lamp: LightSource, same_rays: bool = False, among: Tensor | None = None) -> None:
        """Updates `incoming` for light `index` at all hits, or `among` (A * R,) bool; `same_rays` keeps its shadows."""
        for row, rays, surface, share in self._bounces(index):
            if among is not None:
                some = among[rays].nonzero()[:, 0]
                rays, surface, share = rays[some], surface.pick(some), share[some]
            direct = lamp.irradiance(surface.position, surface.normal)
            if not same_rays:
                self._clear[row, rays] = clear_to(self.geometry, lamp, direct, surface) * share
            self.incoming[row, rays] = direct.irradiance * self._clear[row, rays]

    def _bounces(self, index: int) -> list[tuple[int, Tensor, Surface, Tensor]]:
        """First and second bounces of a light: (row of `incoming`, indices of rays, surfaces, share that counts)."""
        first = index, self._matte, self._first, 1 - self.mirror_weight[self._matte]
        second = self.lamps + 2 + index
        return [first, *((second, rays, surface, self._share[rays]) for rays, surface in self._seconds)]

    def moved(self, index: int, lamp: LightSource, table: RadianceTable) -> Tensor:
        """Zeros (A, 3) with the gradient that the points' radiance has by a light's placement if shadows stay."""
        rows = torch.nn.functional.pad(table.scattered.detach(), (0, 0, 0, 1))  # dark outside the scene
        total = torch.zeros((len(self.owner) // self.count, 3), device=rows.device)
        for row, rays, surface, _ in self._bounces(index):
            clear = self._clear[row, rays]
            reached = clear.nonzero()[:, 0]
            rays, clear = rays[reached], clear[reached]
            irradiance = lamp.irradiance(surface.position[:, reached], surface.normal[:, reached]).irradiance
            light = (irradiance - irradiance.detach()) * clear
            total = total.index_add(0, rays // self.count, rows[row, self.owner[rays]] * light[:, None])
        return total / self.count

    def image(self, table: RadianceTable, ambient: Tensor) -> Tensor:
        """Radiance (3, A) that single rays (R = 1) meet, 0 outside the scene; `ambient` (3, A) is added irradiance."""
        if not self._members:
            self._members = [(self.owner == m).nonzero()[:, 0] for m in range(self.materials)]
        given = table.scattered, table.emission, table.albedo / math.pi, ambient * (1 - self.mirror_weight)
        hits = self.incoming, self._members, self._relative_base_color
        return _HitRadiance.apply(*given, *hits)

    def weights(self, sources: Sequence[int] | None = None) -> Tensor:
        """Shares (A points, S + 1, M materials) with which the points' rays see light, averaged over each point's rays.

        Rows 0 to S - 1 are for the light of each source that a material scatters, the last row for what it emits. With `sources`,
        shares (A, n, M) for these n sources only.
        """
        slots = torch.cat((self.incoming, self.hit[None])) if sources is None else self.incoming[[*sources]]
        slots = slots.view(len(slots), -1, self.count).transpose(0, 1)
        owner = self.owner.view(-1, self.count)
        one_hot = torch.nn.functional.one_hot(owner, self.materials + 1)[..., :-1].to(slots.dtype)
        return torch.bmm(slots, one_hot) / self.count


def clear_to(geometry: RayGeometry, lamp: LightSource, direct: DirectIrradiance, surface: Surface) -> Tensor:
    """Share (N,) of a light that gets from its middle to a surface; 1 without shadows, 0 if it is not linked."""
    linked = lamp.lights(surface.object)
    if not lamp.light.shadow:
        return linked.to(torch.float32)
    facing = (dot(surface.facet, direct.toward) > 0) & linked
    return geometry.clear(geometry.lifted(surface), direct.toward, direct.distance * 0.999, lamp.shadowless) * facing


def refract(
    toward: Float[Tensor, "3 n"], normal: Float[Tensor, "3 n"], ratio: float
) -> tuple[Float[Tensor, "3 n"], Tensor]:
    """Snell's law: refracted unit directions (3, N), mirrored at total reflection, and (N,) bool where that is.

    Normals (3, N) are on the side that the rays come from; the ratio is the IOR before the surface over that behind it.
    """
    cosine = -dot(toward, normal)
    squared = 1 - ratio * ratio * (1 - cosine * cosine)
    bent = unit(toward * ratio + normal * (ratio * cosine - squared.clamp_min(0.0).sqrt()))
    total = squared < 0
    return torch.where(total, reflect(toward, normal), bent), total


def through(geometry: RayGeometry, surface: Surface, toward: Tensor, ior: float) -> tuple[Tensor, Tensor]:
    """Origins and directions (3, N) with which rays leave a glass, after at most `_MOST_WALLS` walls.

    They enter the glass at `surface` in directions `toward` (3, N).
    """
    direction, _ = refract(toward, surface.normal, 1.0 / ior)
    direction = -above(-direction, surface.facet)
    origin = 2 * surface.position - geometry.lifted(surface)  # just behind the surface
    index = torch.arange(toward.shape[1], device=toward.device)
    for _ in range(_MOST_WALLS):
        way, start = direction[:, index], origin[:, index]
        hits = geometry.nearest(start, way, "transmission")
        wall = geometry.surface(hits, way)
        met = hits.hit & (wall.material == surface.material[index])
        if not bool(met.any()):
            break
        # Rays leave where they meet triangles on the side that the shading normals look away from.
        normals = geometry.normals[:, hits.triangle.clamp_min(0)]
        leaving = dot(sum((normal.T for normal in normals), torch.zeros_like(way)), way) > 0
        bent, total = refract(way, wall.normal, ior)
        entered, _ = refract(way, wall.normal, 1.0 / ior)
        bent = torch.where(leaving, bent, entered)
        total = total & leaving
        bent = torch.where(total, above(bent, wall.facet), -above(-bent, wall.facet))
        before = geometry.lifted(wall)
        goes_on = torch.where(total, before, 2 * wall.position - before)
        index = index[met]
        direction = direction.index_copy(1, index, bent[:, met])
        origin = origin.index_copy(1, index, goes_on[:, met])
    return origin, direction
