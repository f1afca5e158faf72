# SPDX-License-Identifier: Apache-2.0
"""Gradients of moving shadows, which rays that are blocked or not cannot have by themselves.

The soft shadow of a lamp is the mean of the hard shadows of points on it. Where such a hard shadow ends between two
neighboring pixels, its edge is the projection of a point on the blocker, from the lamp's point, onto the surface: a
differentiable function of where the lamp stands and how large it is. Moved by one pixel, it darkens or clears one pixel:
as for outlines (`silhouette`; Laine et al. 2020, section 3.6), only that derivative is added, zero in value.
A blocker's contour point is taken in the middle of the ray's way through the blocker, where a round one is grazed.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor
from torch.nn.functional import max_pool2d

from ..geometry.camera import View
from ..geometry.samples import Samples
from ..geometry.vectors import dot
from ..geometry.visibility import RayGeometry, Surface
from ..lights.types.light_source import LightSource

_PENUMBRA = 2
"""Pixels around one within which its shadow's share varies if a hard shadow may end there."""
_LEAST_SHARE = 1e-3
_GRAZING = 0.1
"""Least cosine between light and surface: at less, shadows would race over the surface."""


@dataclass(frozen=True)
class ShadowEdges:
    """All pairs of neighboring pixels between which a hard shadow of one point of a lamp ends.

    Attributes:
        pixel: (2, E) the pixel in shadow and the one in light.
        step: (2, E) from the one to the other, in pixels, over the number of the lamp's points.
        spot: (2, E) the point of the lamp, as `LightSource.shadow_targets` takes it.
        surface: Of the pixels in shadow.
        blocker: (3, E) points that cast the edge.
    """

    pixel: Tensor
    step: Tensor
    spot: Tensor
    surface: Surface
    blocker: Tensor

    @staticmethod
    def of(
        geometry: RayGeometry, samples: Samples, view: View, lamp: LightSource, visible: Tensor
    ) -> ShadowEdges:
        """Traces shadows of a lamp, detached, where a view, detached, shows its penumbra.

        Args:
            visible: (N,) share of it that the samples see.
        """
        pixel_index = (samples.center_hits.hit & _penumbra(samples, visible)).nonzero()[:, 0]
        surface = _centers(geometry, samples, view, pixel_index)
        direct = lamp.irradiance(surface.position, surface.normal)
        lit = (dot(surface.facet, direct.toward) > 0) & (direct.irradiance > 0)
        origin = geometry.lifted(surface)
        spots = _spots(lamp).to(origin.device)
        neighbors = _neighbors(samples, surface, pixel_index, lit)
        edges = []
        for point in spots.unbind(1):
            spot = point[:, None].expand(2, len(pixel_index))
            toward, distance = lamp.shadow_targets(direct.toward, direct.distance, direct.solid_angle, spot)
            clear = torch.zeros(len(pixel_index), device=origin.device)
            clear[lit] = geometry.clear(origin[:, lit], toward[:, lit], distance[lit] * (1 - 1e-4))
            dark, bright = _split(neighbors, clear)
            keep = dot(surface.facet[:, dark], toward[:, dark]) > _GRAZING
            dark, bright = dark[keep], bright[keep]
            blocker = _contour(geometry, origin[:, dark], toward[:, dark], distance[dark])
            edges.append((dark, bright, spot[:, dark], blocker))
        dark, bright, spot, blocker = (torch.cat(parts, -1) for parts in zip(*edges, strict=True))
        pixel = torch.stack((pixel_index[dark], pixel_index[bright]))
        width = samples.size[0]
        step = torch.stack((pixel[1] % width - pixel[0] % width, pixel[1] // width - pixel[0] // width))
        return ShadowEdges(pixel, step / spots.shape[1], spot, surface.pick(dark), blocker)

    def term(self, view: View, lamp: LightSource, pixels: int) -> Tensor:
        """The zero-valued picture (P,) whose gradient is that of the lamp's visible share.

        Args:
            view: The camera, differentiable if it is learned.
        """
        direct = lamp.irradiance(self.surface.position, self.surface.normal)
        toward, distance = lamp.shadow_targets(direct.toward, direct.distance, direct.solid_angle, self.spot)
        if not lamp.at_infinity:
            toward = self.surface.position + toward * distance - self.blocker
            toward = toward / toward.detach().norm(dim=0)
        facing = dot(self.surface.facet, toward)
        away = dot(self.surface.facet, self.blocker - self.surface.position)
        cast = self.blocker - toward * (away / facing.clamp_min(_GRAZING))
        place = view.project(cast)
        darker = ((place - place.detach()) * self.step).sum(0) * -0.5
        zero = torch.zeros(pixels, device=darker.device)
        return zero.index_add(0, self.pixel[0], darker).index_add(0, self.pixel[1], darker)


def _spots(lamp: LightSource) -> Tensor:
    """(2, 4) points that stand for a whole lamp, as `LightSource.shadow_targets` takes them: their second moments are its own."""
    if lamp.half_sides() is None:
        return torch.tensor([[0.5, 0.5, 0.5, 0.5], [0.125, 0.375, 0.625, 0.875]])
    low, high = 0.5 - 12**-0.5, 0.5 + 12**-0.5
    return torch.tensor([[low, low, high, high], [low, high, low, high]])


def _penumbra(samples: Samples, visible: Tensor) -> Tensor:
    """(P,) bool: pixels near which a lamp is seen (N,) here and not there."""
    width, height = samples.size
    pixel = samples.pixel[: samples.surfaces]
    signed = torch.stack((visible, -visible))
    most = torch.full((2, width * height), -2.0, device=visible.device)  # below all: such pixels do not count
    most = most.scatter_reduce(1, pixel.expand_as(signed), signed, "amax").view(1, 2, height, width)
    across = max_pool2d(most, (1, 2 * _PENUMBRA + 1), 1, (0, _PENUMBRA))
    near = max_pool2d(across, (2 * _PENUMBRA + 1, 1), 1, (_PENUMBRA, 0)).flatten(2)[0]
    return (near[0] > _LEAST_SHARE) & (near[1] > _LEAST_SHARE - 1)


def _centers(geometry: RayGeometry, samples: Samples, view: View, pixel_index: Tensor) -> Surface:
    """The surface at the centers of the pixels (N,) that see one."""
    width = samples.size[0]
    _, toward = view.rays(torch.stack((pixel_index % width, pixel_index // width)).to(torch.float32) + 0.5)
    return geometry.surface(samples.center_hits.pick(pixel_index), toward)


def _neighbors(samples: Samples, surface: Surface, pixel_index: Tensor, lit: Tensor) -> Tensor:
    """(2, E) neighboring pixels on one smooth surface that both face the lamp, as indices into `pixel_index`."""
    width, height = samples.size
    index = torch.full((height * width,), -1, device=pixel_index.device)
    index[pixel_index[lit]] = lit.nonzero()[:, 0]
    index = index.view(height, width)
    pairs = [(index[:, :-1], index[:, 1:]), (index[:-1], index[1:])]
    a, b = (torch.cat([pair[i].flatten() for pair in pairs]) for i in (0, 1))
    a, b = torch.stack((a, b))[:, (a >= 0) & (b >= 0)]
    apart = surface.position[:, b] - surface.position[:, a]
    flat = dot(apart, surface.facet[:, a]).abs() < 0.5 * apart.norm(dim=0)
    same = samples.owner[pixel_index[a]] == samples.owner[pixel_index[b]]
    return torch.stack((a, b))[:, same & flat & (dot(surface.normal[:, a], surface.normal[:, b]) > 0.9)]


def _split(neighbors: Tensor, clear: Tensor) -> tuple[Tensor, Tensor]:
    """Of the pairs (2, E) those that a shadow's edge divides: the dark and the bright ones."""
    difference = clear[neighbors[0]] - clear[neighbors[1]]
    up, down = neighbors[:, difference < 0], neighbors[:, difference > 0].flip(0)
    dark, bright = torch.cat((up, down), 1)
    return dark, bright


def _contour(geometry: RayGeometry, origin: Tensor, toward: Tensor, distance: Tensor) -> Tensor:
    """Points (3, E) in the middle of what blocks rays (3, E): between its first hits from either end."""
    far = distance.clamp_max(2 * geometry.size)
    first = geometry.first_hits(origin, toward, "shadow").distance.minimum(far)
    last = far - geometry.first_hits(origin + toward * far, -toward, "shadow").distance.minimum(far)
    return origin + toward * ((first + last.maximum(first)) / 2)
