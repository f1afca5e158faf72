# SPDX-License-Identifier: Apache-2.0
"""Light that comes to the samples over other surfaces and from the world.

Diffuse light and blurred reflections vary slowly, so they are gathered at anchors, where one matrix
product per render weighs all rays, and spread to the samples; mirror images are traced per sample.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor

from .anchors import Anchors, Spread
from .camera import View
from .directions import above, cosine_directions, reflect
from .far import Far, Table
from .lights import Lamp, tangents
from .samples import Samples
from .vectors import length
from .visibility import Geometry, Surface, sphere_points

GLOSSY = 0.4
"""Roughness of the blurred reflection between the mirror image and the diffuse light."""
_DIFFUSE_RAYS = 16
_GLOSSY_RAYS = 8


@dataclass(frozen=True)
class Gathered:
    """Light that comes over other surfaces and from the world.

    Attributes:
        irradiance: (3, N) the world's included.
        glossy, mirror: (3, N) blurred and mirrored radiance of surfaces, without the world.
        anchors: (A, 3) the irradiance at the anchors.
    """

    irradiance: Tensor
    glossy: Tensor
    mirror: Tensor
    anchors: Tensor


class Indirect:
    """Bounced light and reflections for the samples of one view.

    `points` are the anchors' surface; `open_sky` holds the shares (N,) of the blurred and of the mirrored
    reflection that the world fills.
    """

    def __init__(
        self,
        geometry: Geometry,
        samples: Samples,
        surface: Surface,
        view: View,
        metals: Tensor,
        lamps: int,
        generator: torch.Generator,
    ) -> None:
        self._view = view
        self._anchors = anchors = Anchors(samples, surface)
        self.points = points = surface.pick(anchors.index)
        origin = geometry.lifted(points)
        shape = geometry, metals, lamps
        glossy = _glossy_rays(points, samples.toward[:, anchors.index], generator)
        self.diffuse = _far(*shape, origin, _diffuse_rays(points, generator), _DIFFUSE_RAYS)
        self.glossy = _far(*shape, origin, glossy, _GLOSSY_RAYS)
        mirrored = above(reflect(samples.toward[:, : samples.surfaces], surface.normal), surface.facet)
        self.mirror = Far(geometry, geometry.lifted(surface), mirrored, 1, metals, lamps)
        self._mirror_ambient = self.spread_to(self.mirror.surface)
        self.open_sky = anchors.spread(self.glossy.open[:, None])[:, 0], self.mirror.open
        self._weights: tuple[Tensor, Tensor] | None = None
        self._skies = len(metals) * (2 * lamps + 5)

    def light(self, index: int, lamp: Lamp) -> None:
        """Takes up that a lamp has moved."""
        for far in (self.diffuse, self.glossy, self.mirror):
            far.light(index, lamp)
        self._weights = None

    def spread_to(self, surface: Surface) -> Spread:
        """Carries irradiance from the anchors to points that the picture shows, or nearly."""
        distance = length(surface.position - self._view.position[:, None])
        return self._anchors.spread_to(surface, self._view.project(surface.position), distance)

    def gather(self, table: Table, ambient: Tensor | None = None) -> Gathered:
        """Weighs all rays.

        Args:
            table: The radiances of all there is to see.
            ambient: (A,) share of the world's light that fog lets through to the anchors.
        """
        if self._weights is None:
            low, glossy = self._anchors.smooth(self.diffuse.weights()) * math.pi, self.glossy.weights()
            self._weights = low, glossy[:, : self._skies]
        wide, narrow = self._weights
        sky = wide[:, self._skies :] @ table.radiances[self._skies :]
        sky = sky if ambient is None else sky * ambient[:, None]
        over = table.radiances[: self._skies]
        low = (wide[:, : self._skies] @ over + sky).clamp_min(0.0)
        full = self._anchors.spread(torch.cat((low, narrow @ over), 1)).T
        mirror = self.mirror.image(table, self._mirror_ambient(low).T)
        return Gathered(full[:3], full[3:], mirror, low)


def _far(geometry: Geometry, metals: Tensor, lamps: int, origin: Tensor, toward: Tensor, count: int) -> Far:
    origins = origin.repeat_interleave(count, 1)
    return Far(geometry, origins, toward, count, metals, lamps, deep=True)


def _diffuse_rays(points: Surface, generator: torch.Generator) -> Tensor:
    count = points.position.shape[1]
    uv = sphere_points(_DIFFUSE_RAYS, count, generator).to(points.position.device).flatten(1)
    normal = points.normal.repeat_interleave(_DIFFUSE_RAYS, 1)
    return above(cosine_directions(normal, uv), points.facet.repeat_interleave(_DIFFUSE_RAYS, 1))


def _glossy_rays(points: Surface, toward: Tensor, generator: torch.Generator) -> Tensor:
    """Rays reflected by GGX-distributed microfacets (Walter et al. 2007, equations 35 and 36)."""
    count = points.position.shape[1]
    uv = sphere_points(_GLOSSY_RAYS, count, generator).to(points.position.device).flatten(1)
    normal = points.normal.repeat_interleave(_GLOSSY_RAYS, 1)
    facet = points.facet.repeat_interleave(_GLOSSY_RAYS, 1)
    tangent2 = GLOSSY**4 * uv[0] / (1 - uv[0]).clamp_min(1e-4)
    cosine = (1 / (1 + tangent2)).sqrt()
    sine, angle = (1 - cosine * cosine).clamp_min(0.0).sqrt(), 2 * math.pi * uv[1]
    across, up = tangents(normal)
    half = across * (sine * angle.cos()) + up * (sine * angle.sin()) + normal * cosine
    return above(reflect(toward.repeat_interleave(_GLOSSY_RAYS, 1), half), facet)
