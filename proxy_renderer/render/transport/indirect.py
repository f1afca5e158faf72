# SPDX-License-Identifier: Apache-2.0
"""Light that comes to the samples over other surfaces and from the world.

Diffuse light and blurred reflections vary slowly, so they are gathered at anchors, where one matrix
product per render weighs all rays, and spread to the samples; mirror images are traced per sample.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import torch
from torch import Tensor

from ..geometry.camera import View
from ..geometry.directions import above, cosine_directions, reflect
from ..geometry.gather_points import Anchors, Spread
from ..geometry.samples import Samples
from ..geometry.vectors import cross, dot, length, tangents, unit
from ..geometry.visibility import Geometry, Surface, sphere_points
from ..lights.lamps import Lamp
from ..lights.prefilter import GLOSSY
from ..material.microfacets import visible_normals
from ..material.textures import Maps
from .fog import Fog, Ways
from .indirect_fog import Murk
from .secondary_hits import Far, Table

_DIFFUSE_RAYS = 16
_GLOSSY_RAYS = 8
_LEAST_COSINE = 0.02


@dataclass(frozen=True)
class Gathered:
    """Light that comes over other surfaces and from the world.

    Attributes:
        irradiance: (3, N) the world's included.
        glossy, mirror: (3, N) blurred and mirrored radiance of surfaces and fog, without the world.
        open_glossy, open_mirror: (N,) shares of the blurred and of the mirrored reflection that the world fills.
        anchors: (A, 3) the irradiance at the anchors.
    """

    irradiance: Tensor
    glossy: Tensor
    mirror: Tensor
    open_glossy: Tensor
    open_mirror: Tensor
    anchors: Tensor


class Indirect:
    """Bounced light and reflections for the samples of one view.

    `anchors` are the indices (A,) of the samples at which diffuse light is gathered.
    """

    def __init__(
        self,
        geometry: Geometry,
        samples: Samples,
        surface: Surface,
        view: View,
        metals: Tensor,
        lamps: int,
        glowing: Sequence[int],
        maps: Maps,
        generator: torch.Generator,
    ) -> None:
        self._view = view
        self._anchors = anchors = Anchors(samples, surface)
        self.anchors = anchors.index
        points = surface.pick(anchors.index)
        origin = geometry.lifted(points)
        shape = geometry, metals, lamps
        glossy = _glossy_rays(points, samples.toward[:, anchors.index], generator)
        # What metals send on is a caustic on a matte surface: as if they scattered it evenly, on average.
        matte = geometry, torch.zeros_like(metals), lamps
        self.diffuse = _far(*matte, origin, _diffuse_rays(points, generator), _DIFFUSE_RAYS)
        self.glossy = _far(*shape, origin, glossy, _GLOSSY_RAYS)
        mirrored = above(reflect(samples.toward[:, : samples.surfaces], surface.normal), surface.facet)
        self.mirror = Far(geometry, geometry.lifted(surface), mirrored, 1, metals, lamps, maps)
        self._mirror_ambient = self.spread_to(self.mirror)
        self._ways = Ways(surface.position, mirrored, self.mirror.distance)
        self._open_glossy = anchors.spread(self.glossy.open[:, None])[:, 0]
        self._weights: tuple[Tensor, Tensor] | None = None
        self._shape = len(metals), 2 * (lamps + 2)
        self._skies = len(metals) * (2 * lamps + 5)
        self._glowing = [len(metals) * 2 * (lamps + 2) + m for m in glowing]

    def light(self, index: int, lamp: Lamp) -> None:
        """Takes up that a lamp has moved."""
        for far in (self.diffuse, self.glossy, self.mirror):
            far.light(index, lamp)
        self._weights = None

    def spread_to(self, far: Far) -> Spread:
        """Carries irradiance from the anchors to what rays meet, if the picture shows it, or nearly."""
        surface = far.surface
        distance = length(surface.position - self._view.position[:, None])
        return self._anchors.spread_to(
            surface, self._view.project(surface.position), distance, far.hit.bool()
        )

    def gather(self, table: Table) -> Gathered:
        """Weighs all rays."""
        wide, narrow = self._weighed()
        low = (wide @ table.radiances).clamp_min(0.0)
        full = self._anchors.spread(torch.cat((low, narrow @ table.radiances[: self._skies]), 1)).T
        mirror = self.mirror.image(table, self._mirror_ambient(low).T)
        return Gathered(full[:3], full[3:], mirror, self._open_glossy, self.mirror.open, low)

    def gather_through(self, table: Table, fog: Fog, murk: Murk) -> Gathered:
        """Weighs all rays, dimmed by fog, and adds what the fog scatters."""
        wide, narrow = self._weighed()
        sky = wide[:, self._skies :] @ table.radiances[self._skies :]
        low = self._dimmed(wide, table, murk.factors, murk.passing)
        low = (low + sky * murk.ambient[:, None]).clamp_min(0.0) + murk.scattered
        through = murk.mirrored[:, None]
        glossy = self._dimmed(narrow, table, murk.legs, torch.ones_like(murk.passing)) * through
        glossy = glossy + murk.haze * (1 - through)
        opening = self.glossy.open[:, None] * through
        full = self._anchors.spread(torch.cat((low, glossy, murk.haze, opening), 1)).T
        passing = self._ways.transmittance(fog)
        image = self.mirror.image(table.dimmed(murk.legs.mean(0)), self._mirror_ambient(low).T)
        mirror = image * passing + full[6:9] * (1 - passing)
        return Gathered(full[:3], full[3:6], mirror, full[9], self.mirror.open * passing, low)

    def following(self, gathered: Gathered, table: Table, lamps: Sequence[Lamp]) -> Gathered:
        """The same light, with gradients by where the lamps that are being learned stand.

        Fog between surfaces is left out here: only the gradients miss what it dims.
        """
        moving = [(index, lamp) for index, lamp in enumerate(lamps) if lamp.moving]
        if not moving:
            return gathered
        wide, narrow, mirror = (
            torch.stack([far.moved(*row, table) for row in moving]).sum(0)
            for far in (self.diffuse, self.glossy, self.mirror)
        )
        low = self._anchors.smooth(wide) * math.pi
        full = self._anchors.spread(torch.cat((low, narrow), 1)).T
        return replace(
            gathered,
            irradiance=gathered.irradiance + full[:3],
            glossy=gathered.glossy + full[3:],
            mirror=gathered.mirror + mirror.T,
            anchors=gathered.anchors + low,
        )

    def _weighed(self) -> tuple[Tensor, Tensor]:
        if self._weights is None:
            wide = self.diffuse.weights()
            wide[:, self._glowing] = 0.0  # their lamps count
            low = self._anchors.smooth(wide) * math.pi
            glossy = self._anchors.smooth_glossy(self.glossy.weights())
            self._weights = low, glossy[:, : self._skies]
        return self._weights

    def _dimmed(self, weights: Tensor, table: Table, shares: Tensor, glow: Tensor) -> Tensor:
        """What anchors get from surfaces (A, 3), with shares (A, S) of the sources, and of the glow (A,)."""
        materials, sources = self._shape
        split = materials * sources
        by_source = weights[:, :split].view(-1, materials, sources).permute(2, 0, 1)
        scattered = torch.bmm(by_source, table.radiances[:split].view(materials, sources, 3).transpose(0, 1))
        emitted = weights[:, split : self._skies] @ table.radiances[split : self._skies]
        return torch.einsum("sac,as->ac", scattered, shares) + emitted * glow[:, None]


def _far(geometry: Geometry, metals: Tensor, lamps: int, origin: Tensor, toward: Tensor, count: int) -> Far:
    origins = origin.repeat_interleave(count, 1)
    return Far(geometry, origins, toward, count, metals, lamps, deep=True)


def _diffuse_rays(points: Surface, generator: torch.Generator) -> Tensor:
    count = points.position.shape[1]
    uv = sphere_points(_DIFFUSE_RAYS, count, generator).to(points.position.device).flatten(1)
    normal = points.normal.repeat_interleave(_DIFFUSE_RAYS, 1)
    return above(cosine_directions(normal, uv), points.facet.repeat_interleave(_DIFFUSE_RAYS, 1))


def _glossy_rays(points: Surface, toward: Tensor, generator: torch.Generator) -> Tensor:
    """Rays (3, N) reflected by the GGX microfacets that the camera's rays (3, A) meet."""
    count = points.position.shape[1]
    uv = sphere_points(_GLOSSY_RAYS, count, generator).to(points.position.device).flatten(1)
    normal = points.normal.repeat_interleave(_GLOSSY_RAYS, 1)
    facet = points.facet.repeat_interleave(_GLOSSY_RAYS, 1)
    toward = toward.repeat_interleave(_GLOSSY_RAYS, 1)
    cosine = (-dot(toward, normal)).clamp(_LEAST_COSINE, 1.0)
    x, y, z = visible_normals(cosine, GLOSSY**2, uv)
    level = -toward - normal * cosine
    head_on = dot(level, level) < 1e-8
    across = torch.where(head_on, tangents(normal)[0], unit(level))
    return above(reflect(toward, across * x + cross(normal, across) * y + normal * z), facet)
