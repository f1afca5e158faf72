# SPDX-License-Identifier: Apache-2.0
"""Rays that leave surfaces: traced once, what they meet is shaded anew every render, simply.

A ray's hit is shaded as its albedo times the light there, plus its glow; one more ray from the hit brings
the light of a second bounce, as if that surface had the same albedo. This is linear in (albedo x light),
so the rays of a point add up to a fixed row of weights over a small table of radiances.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor

from ..geometry.directions import above, cosine_directions, reflect
from ..geometry.vectors import dot, unit
from ..geometry.visibility import Geometry, Surface
from ..lights.environment import harmonics
from ..lights.irradiance import Arrival, arrival
from ..lights.lamps import Lamp
from ..material.textures import Maps

_WORLD_AT_SECOND = 0.3
"""Most of the world that surfaces of second bounces are taken to see; in rooms, which rays rarely leave, less."""


@dataclass(frozen=True)
class Table:
    """What far hits and the world radiate in one render; the rows of `radiances` are:

    for every material, the light that it scatters of each lamp and of the world's upper and lower half, then
    the same scattered twice and more; then every material's glow; then the world's nine spherical harmonics.

    Attributes:
        radiances: (K, 3).
        albedo: (M, 3) share of light that each material scatters.
    """

    radiances: Tensor
    albedo: Tensor

    @staticmethod
    def of(
        albedo: Tensor, metallic: Tensor, glow: Tensor, lamp_colors: Tensor, halves: Tensor, sky: Tensor
    ) -> Table:
        """Builds the table.

        Args:
            albedo: (M, 3) share of light that each material scatters, or reflects if it is a metal.
            metallic: (M,) share of each material that is metal.
            glow: (M, 3) emitted radiance.
            lamp_colors: (L, 3).
            halves: (2, 3) light of the world on what faces up and down.
            sky: (9, 3) its spherical harmonics.
        """
        sources = torch.cat((lamp_colors / math.pi, halves))
        again = albedo * albedo / (1 - albedo / 2)  # third and later bounces follow the second
        # A metal shows things of other colors than its own: of the mean color of those that are none.
        plain = (1 - metallic)[:, None] + 1e-6
        common = (albedo * plain).sum(0) / plain.sum(0)
        again = torch.lerp(again, albedo * common / (1 - common / 2), metallic[:, None])
        scattered = torch.cat((albedo[:, None] * sources, again[:, None] * sources), 1).flatten(0, 1)
        return Table(torch.cat((scattered, glow, sky)), albedo)

    def dimmed(self, shares: Tensor) -> Table:
        """With less of each source: shares (S,) of the lamps and the world's halves, and of both scattered twice."""
        split = len(self.albedo) * len(shares)
        scattered = self.radiances[:split].view(len(self.albedo), -1, 3) * shares[:, None]
        return Table(torch.cat((scattered.flatten(0, 1), self.radiances[split:])), self.albedo)


class Far:
    """Rays from A points, R each, and what they meet.

    Args:
        geometry: The triangles.
        origin, toward: (3, A * R) rays.
        count: R.
        metals: (M,) how much like a mirror each material is; 0 for what is no metal.
        lamps: How many the scene has.
        maps: Textures: what single rays meet shows them. None for the mean color.
        deep: Whether the light at the hits includes the world's and what comes over other surfaces.

    Attributes:
        open: (A,) share of rays that leave the scene.
        surface: The surface at the hits, (A * R).
        shiny: (A * R,) bool: hits on metals.
    """

    def __init__(
        self,
        geometry: Geometry,
        origin: Tensor,
        toward: Tensor,
        count: int,
        metals: Tensor,
        lamps: int,
        maps: Maps | None = None,
        deep: bool = False,
    ) -> None:
        self.geometry, self.count = geometry, count
        hits = geometry.first_hits(origin, toward)
        self.hit = hits.hit.to(torch.float32)
        self.surface: Surface = geometry.surface(hits, toward)
        self.distance = hits.distance
        self._relief = maps.relief(self.surface, geometry) if maps else None
        self.open = 1 - self.hit.view(-1, count).mean(1)
        materials = len(metals)
        self.owner = self.surface.material * hits.hit + materials * ~hits.hit
        self.mirroring = metals[self.surface.material] * hits.hit
        self.shiny = self.mirroring > 0
        self.materials = materials
        self._members: list[Tensor] = []
        self.lamps = lamps
        # Rows: every lamp and both halves of the world at the hits; the same where one more ray from there ends.
        self.arriving = torch.zeros((2 * (lamps + 2), len(self.hit)), device=self.hit.device)
        self._clear = torch.zeros_like(self.arriving)
        self._lit = (self.hit > self.mirroring).nonzero()[:, 0]  # mirrors do not scatter what lights them
        self._first = self.surface.pick(self._lit)
        self._around = around = (hits.hit if deep else self.shiny).nonzero()[:, 0]
        # Without it, the light that lies about counts where a metal is rough, and what it mirrors otherwise.
        self._share = torch.ones_like(self.hit) if deep else self.mirroring
        self._second = self._look_around(toward[:, around], deep) if len(around) else None
        self.harmonics = (harmonics(toward) * (1 - self.hit)).view(9, -1, count).mean(2)

    def _look_around(self, arrived: Tensor, deep: bool) -> tuple[Tensor, Surface]:
        """Sends one ray from hits: to the world, or to the surface of a second bounce.

        Metals send it where they mirror, others anywhere above them, distributed like a cosine.

        Args:
            arrived: (3, H) directions of the rays that have met the hits `self._around`.
            deep: As for the class.

        Returns:
            The rays that meet a second surface, and that.
        """
        generator = torch.Generator().manual_seed(7)
        start, mirroring = self.surface.pick(self._around), self.mirroring[self._around]
        shiny = mirroring > 0
        count = len(self.hit if deep else self._around)
        uv = torch.rand((2, count), generator=generator).to(self.hit.device)
        uv = uv[:, self._around] if deep else uv
        anywhere = cosine_directions(start.normal, uv)
        toward = torch.lerp(anywhere, reflect(arrived, start.normal), mirroring)
        toward = above(unit(toward), start.facet)
        hits = self.geometry.first_hits(self.geometry.lifted(start), toward)
        found = hits.hit.to(torch.float32)
        beyond = self.geometry.surface(hits, toward)
        leaving = float((1 - found).mean())
        facing = torch.where(shiny, torch.where(toward[2] > 0, 1.0, -1.0), start.normal[2])
        for row, up, seen in (
            (self.lamps, (1 + facing) / 2, (1 - found) * self._share[self._around]),
            (2 * self.lamps + 2, (1 + beyond.normal[2]) / 2, found * min(leaving, _WORLD_AT_SECOND)),
        ):
            self.arriving[row, self._around] = up * seen
            self.arriving[row + 1, self._around] = (1 - up) * seen
        again = hits.hit.nonzero()[:, 0]
        return self._around[again], beyond.pick(again)

    def light(self, index: int, lamp: Lamp) -> None:
        """Traces shadow rays to one lamp."""
        for row, rays, surface, share in self._bounces(index):
            met = arrival(lamp, surface.position, surface.normal)
            clear = _clear(self.geometry, lamp, met, surface) * share
            self._clear[row, rays], self.arriving[row, rays] = clear, met.irradiance * clear

    def _bounces(self, index: int) -> list[tuple[int, Tensor, Surface, Tensor]]:
        """A lamp's rows of `arriving`: row, rays, the surface that it lights, and the share that rays take of it."""
        bounces = [(index, self._lit, self._first, 1 - self.mirroring[self._lit])]
        if self._second is not None:
            rays, surface = self._second
            bounces.append((self.lamps + 2 + index, rays, surface, self._share[rays]))
        return bounces

    def moved(self, index: int, lamp: Lamp, table: Table) -> Tensor:
        """Zeros (A, 3) with the gradient of what the points see by where a lamp stands.

        That it lights the hits more or less counts; that its shadows move there does not.
        """
        rows = table.radiances[: self.materials * len(self.arriving)].detach()
        rows = torch.cat((rows.view(self.materials, -1, 3), rows.new_zeros((1, len(self.arriving), 3))))
        total = torch.zeros((len(self.owner) // self.count, 3), device=rows.device)
        for row, rays, surface, _ in self._bounces(index):
            clear = self._clear[row, rays]
            lit = clear.nonzero()[:, 0]
            rays, clear = rays[lit], clear[lit]
            irradiance = arrival(lamp, surface.position[:, lit], surface.normal[:, lit]).irradiance
            light = (irradiance - irradiance.detach()) * clear
            total = total.index_add(0, rays // self.count, rows[self.owner[rays], row] * light[:, None])
        return total / self.count

    def image(self, table: Table, ambient: Tensor) -> Tensor:
        """Radiance (3, A) of the hits of single rays; 0 where they leave the scene.

        Args:
            table: The radiances of all there is to see.
            ambient: (3, A) irradiance at the hits that is not the lamps'.
        """
        if not self._members:
            self._members = [(self.owner == m).nonzero()[:, 0] for m in range(self.materials)]
        ambient = ambient * (1 - self.mirroring)
        return _Image.apply(
            table.radiances, table.albedo / math.pi, ambient, self.arriving, self._members, self._relief
        )

    def weights(self) -> Tensor:
        """(A, K) average over each point's rays: weights over the rows of `Table.radiances`."""
        rays = -1, self.count
        slots = torch.cat((self.arriving, torch.ones_like(self.hit)[None]))
        slots = slots.view(len(slots), *rays).permute(1, 2, 0)
        owner = self.owner.view(rays)
        one_hot = torch.nn.functional.one_hot(owner, self.materials + 1)[..., :-1].to(slots.dtype)
        summed = torch.einsum("arm,ars->ams", one_hot, slots) / self.count
        scattered, glow = summed[..., :-1].flatten(1), summed[..., -1]
        return torch.cat((scattered, glow, self.harmonics.T), 1)


def lit(geometry: Geometry, lamp: Lamp, surface: Surface) -> Tensor:
    """Irradiance (N,) of a lamp on a surface, shadowed by one ray to its middle."""
    met = arrival(lamp, surface.position, surface.normal)
    return met.irradiance * _clear(geometry, lamp, met, surface)


def _clear(geometry: Geometry, lamp: Lamp, met: Arrival, surface: Surface) -> Tensor:
    """(N,) 1.0 where a ray from a surface to the lamp's middle passes, else 0.0."""
    if not lamp.light.shadow:
        return torch.ones_like(met.irradiance)
    facing = dot(surface.facet, met.toward) > 0
    blockers = lamp.glow.blockers if lamp.glow else geometry
    return blockers.clear(geometry.lifted(surface), met.toward, met.distance * 0.999) * facing


class _Image(torch.autograd.Function):
    """Radiance (3, N) of single hits: like `Far.weights() @ radiances`, without the mostly empty matrix."""

    @staticmethod
    def forward(ctx, radiances, albedo, ambient, sources, members, relief):
        ctx.save_for_backward(albedo, ambient)
        ctx.relief = relief
        ctx.members, ctx.sources, ctx.rows = members, sources, len(radiances)
        count, materials = len(sources), len(members)
        out = torch.zeros((3, sources.shape[1]), device=sources.device)
        for m, chosen in enumerate(members):
            if len(chosen):
                rows, glow = radiances[m * count : (m + 1) * count], radiances[materials * count + m]
                light = rows.T @ sources.index_select(1, chosen)
                light += ambient.index_select(1, chosen) * albedo[m][:, None]
                if relief is not None:
                    light *= relief.index_select(1, chosen)
                out.index_copy_(1, chosen, light + glow[:, None])
        return out

    @staticmethod
    def backward(ctx, gradient):
        albedo, ambient = ctx.saved_tensors
        count, materials = len(ctx.sources), len(ctx.members)
        radiances, albedos = gradient.new_zeros((ctx.rows, 3)), torch.zeros_like(albedo)
        ambients = torch.zeros_like(ambient)
        for m, chosen in enumerate(ctx.members):
            if len(chosen):
                part = gradient.index_select(1, chosen)
                radiances[materials * count + m] = part.sum(1)
                if ctx.relief is not None:
                    part = part * ctx.relief.index_select(1, chosen)
                radiances[m * count : (m + 1) * count] = ctx.sources.index_select(1, chosen) @ part.T
                albedos[m] = (part * ambient.index_select(1, chosen)).sum(1)
                ambients.index_copy_(1, chosen, part * albedo[m][:, None])
        return radiances, albedos, ambients, None, None, None
