# SPDX-License-Identifier: Apache-2.0
"""The samples as the camera sees them, and the direct light of each light, kept while neither camera nor light moves.

Also gradients of moving outlines and shadow edges, which point samples and rays cannot have themselves.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, field
from typing import Self

import torch
from torch import Tensor
from torch.nn.functional import max_pool2d

from ...scene.values import Recent, needs_gradient
from ..geometry.camera import View
from ..geometry.samples import Samples, last_of
from ..geometry.vectors import above, dot, reflect
from ..geometry.visibility import RayGeometry, Surface
from ..lights.area_specular import AreaSpecular, area_specular
from ..lights.light_source import DirectIrradiance, LightSource
from ..lights.shadows import LightClusters, ShadowFilter, cluster_shadow, shadow
from ..material import albedo
from ..transport.fog import FogMedium, LightPaths

_PENUMBRA = 2  # pixels: a hard shadow may end at a pixel if visible shares differ within this radius
_LEAST_SHARE = 1e-3  # least difference of a visible share from 0 or 1
_CONTOUR_WINDOW = 2  # pixels around a pair from which the contour's direction is estimated
_GRAZING = 0.1  # least cosine between light and surface: below it, shadows move too fast over the surface


@dataclass
class _Shadowed:
    """Traced shadows of one light, and the results that are computed from them on demand."""

    signature: tuple[float, ...]  # placement of the lights in the light's cluster
    visible: Tensor  # (N,) share of the light that each sample sees
    direct_light: DirectLight | None = None  # kept if it needs no gradients
    edges: ShadowEdges | None = None  # made when gradients of the shadows are needed


class DirectLights:
    """The direct light of each light at the samples of one view; `seen` has these samples without gradients."""

    def __init__(self, geometry: RayGeometry, samples: Samples, seen: ViewSamples, clusters: LightClusters) -> None:
        self._geometry, self._samples, self._seen, self._clusters = geometry, samples, seen, clusters
        self._smoothing = ShadowFilter(samples, seen.surface)
        self._pixel = samples.pixel[: samples.surfaces]
        self._on_center = geometry.object[samples.hits.triangle[: samples.surfaces]] == samples.owner[self._pixel]
        self._kept: dict[int, _Shadowed] = {}
        self._shared: dict[int, tuple[tuple[float, ...], Tensor]] = {}  # shadows of clusters, by row

    def aside(self) -> Self:
        """A copy in which lights may move while this one stays as it is."""
        other = copy(self)
        other._kept = dict(self._kept)
        return other

    def forget_moved(self, index: int, lamps: Sequence[LightSource]) -> bool:
        """Drops the shadows of light `index` if a light of its cluster has moved; True if shadows have to be traced."""
        kept = self._kept.get(index)
        if kept is not None and kept.signature == self._signature(index, lamps):
            return False
        self._kept.pop(index, None)
        return True

    def of(self, index: int, lamps: Sequence[LightSource], view_samples: ViewSamples, view: View) -> DirectLight:
        """Direct light of one light, kept until `forget_moved` drops it; differentiable if light or camera is."""
        lamp, moving = lamps[index], lamps[index].moving or view_samples.moving
        kept = self._kept.get(index)
        if not moving and kept is not None and kept.direct_light is not None:
            return kept.direct_light
        direct = lamp.irradiance(view_samples.surface.position, view_samples.surface.normal)
        if kept is None:
            with torch.no_grad():
                kept = self._kept[index] = self._shadowed(index, lamps, None if view_samples.moving else direct)
        if not moving:
            with torch.no_grad():
                kept.direct_light = DirectLight.of(lamp, self._seen, direct, kept.visible)
            return kept.direct_light
        visible = kept.visible
        if lamp.light.shadow and lamp.owner:  # surfaces that glow do not move
            if kept.edges is None:
                with torch.no_grad():
                    still = view.detached(), lamp.detached()
                    kept.edges = ShadowEdges.of(self._geometry, self._samples, *still, visible)
            # Zeros whose gradient is that of the light's shadows, which move with light and camera.
            term = kept.edges.term(view, lamp, self._samples.size[0] * self._samples.size[1])
            visible = visible + torch.where(self._on_center, term[self._pixel], 0.0)
        return DirectLight.of(lamp, view_samples, direct, visible)

    def _signature(self, index: int, lamps: Sequence[LightSource]) -> tuple[float, ...]:
        members = self._clusters.clusters[self._clusters.row[index]].members
        return tuple(number for member in members for number in lamps[member].signature())

    def _shadowed(self, index: int, lamps: Sequence[LightSource], direct: DirectIrradiance | None) -> _Shadowed:
        """Traces the shadows of light `index`; its unshadowed irradiance `direct` is computed if None."""
        row, signature = self._clusters.row[index], self._signature(index, lamps)
        view, cluster = (self._geometry, self._smoothing), self._clusters.clusters[row]
        if len(cluster.members) > 1:
            if row not in self._shared or self._shared[row][0] != signature:
                self._shared[row] = signature, cluster_shadow(*view, cluster, lamps)
            return _Shadowed(signature, self._shared[row][1])
        still = lamps[index].detached()
        direct = direct or still.irradiance(self._seen.surface.position, self._seen.surface.normal)
        return _Shadowed(signature, shadow(*view, still, direct, lamps[index].moving))


@dataclass(frozen=True)
class ViewSamples:
    """N samples on surfaces and B of the background, as the camera sees them; differentiable if the camera is."""

    surface: Surface  # the N surface points
    toward_eye: Tensor  # (3, N) unit vectors to the camera
    basis: Tensor  # (7, N) `albedo.basis` of the viewing cosine
    mirrored: Tensor  # (3, N) unit mirror directions
    beyond: Tensor  # (3, B) unit directions of the background's rays
    _parts: dict[int, Tensor] = field(default_factory=dict, repr=False, compare=False)

    def part(self, samples: slice) -> Tensor:
        """The albedo basis (7, n) at the samples of one material; always the same object, for `ShadingInputs.seen`."""
        if samples.start not in self._parts:
            self._parts[samples.start] = self.basis[:, samples]
        return self._parts[samples.start]

    @staticmethod
    def of(surface: Surface, toward: Tensor) -> ViewSamples:
        """Samples of camera rays with unit directions (3, N + B), of which the first N meet the points of `surface`."""
        n = surface.position.shape[1]
        cosine = -dot(surface.normal, toward[:, :n])
        mirrored = above(reflect(toward[:, :n], surface.normal), surface.facet)
        return ViewSamples(surface, -toward[:, :n], albedo.basis(cosine.clamp(1e-3, 1.0)), mirrored, toward[:, n:])

    @property
    def moving(self) -> bool:
        """True if gradients with respect to the camera are wanted."""
        # If only the camera's position is learned, rays do not turn.
        return needs_gradient(self.toward_eye, self.surface.position)


@dataclass(frozen=True)
class DirectLight:
    """Direct light of one light at N samples, per unit of its color."""

    irradiance: Tensor  # (N,) shadowed
    area_specular: AreaSpecular | None  # shadowed; None for `pictured` lights: glowing surfaces and wide suns
    paths: LightPaths  # from the samples to the light
    _parts: dict[int, AreaSpecular] = field(default_factory=dict, repr=False, compare=False)
    _fogged: Recent = field(default_factory=Recent, repr=False, compare=False)

    def part(self, samples: slice) -> AreaSpecular:
        """The highlight at the samples of one material; always the same object, which caches lobes."""
        assert self.area_specular
        if samples.start not in self._parts:
            self._parts[samples.start] = self.area_specular.pick(samples)
        return self._parts[samples.start]

    def through(self, fog: FogMedium) -> DirectLight:
        """A copy dimmed by the fog between light and samples; for the same fog the same object, which caches lobes."""

        def dimmed() -> DirectLight:
            passing = self.paths.transmittance(fog)
            specular = self.area_specular and self.area_specular.times(passing)
            return DirectLight(self.irradiance * passing, specular, self.paths)

        return dimmed() if fog.signature is None else self._fogged.of("", fog.signature, dimmed)

    @staticmethod
    def of(lamp: LightSource, view_samples: ViewSamples, direct: DirectIrradiance, visible: Tensor) -> DirectLight:
        """Direct light from unshadowed irradiance `direct` and the share (N,) of the light that each sample sees."""
        surface, specular = view_samples.surface, None
        if not lamp.pictured:
            unshadowed = area_specular(lamp, direct, surface.position, surface.normal, view_samples.toward_eye)
            specular = unshadowed.times(visible * lamp.reaches("glossy"))
        paths = LightPaths(surface.position, direct.toward, direct.distance)
        return DirectLight(direct.irradiance * visible * lamp.reaches("diffuse"), specular, paths)


@dataclass(frozen=True)
class ShadowEdges:
    """All E pairs of neighboring pixels between which a hard shadow of a point on a light ends, for gradients.

    The soft shadow of a light is the mean of the hard shadows of points on it. Where a hard shadow ends between two
    neighboring pixels, its edge is the projection of a point on the blocker from the light's point to the surface: a
    differentiable function of the light's position and size. An edge that moves by one pixel darkens or lights one
    pixel. The point on the blocker is the middle of the ray's way through it, on the contour of a round blocker.
    """

    pixel: Tensor  # (2, E) indices of the pixel in shadow and the pixel in light
    step: Tensor  # (2, E) offset in pixels from shadow to light, divided by the number of points on the light
    spot: Tensor  # (2, E) the point of the light: `uv` of `LightSource.shadow_targets`
    surface: Surface  # (E,) at the centers of the pixels in shadow
    blocker: Tensor  # (3, E) points on the blockers that cast the edge

    @staticmethod
    def of(geometry: RayGeometry, samples: Samples, view: View, lamp: LightSource, visible: Tensor) -> ShadowEdges:
        """Finds edges of hard shadows of points on a light; each sample sees a share `visible` (N,) of the light."""
        pixel_index = (samples.center_hits.hit & _penumbra(samples, visible)).nonzero()[:, 0]
        width = samples.size[0]
        centers = torch.stack((pixel_index % width, pixel_index // width)).to(torch.float32) + 0.5
        surface = geometry.surface(samples.center_hits.pick(pixel_index), view.rays(centers)[1])
        direct = lamp.irradiance(surface.position, surface.normal)
        facing_lamp = (dot(surface.facet, direct.toward) > 0) & (direct.irradiance > 0)
        origin = geometry.lifted(surface)
        # Four points stand for the whole light: their second moments are its own.
        low, high = 0.5 - 12**-0.5, 0.5 + 12**-0.5
        spots = torch.tensor([[low, low, high, high], [low, high, low, high]], device=origin.device)
        if lamp.half_sides() is None:
            spots = spots.new_tensor([[0.5, 0.5, 0.5, 0.5], [0.125, 0.375, 0.625, 0.875]])
        neighbors = _neighbors(samples, surface, pixel_index, facing_lamp)
        edges = []
        for point in spots.unbind(1):
            spot = point[:, None].expand(2, len(pixel_index))
            toward, distance = lamp.shadow_targets(direct, spot)
            clear = torch.zeros(len(pixel_index), device=origin.device)
            ways = origin[:, facing_lamp], toward[:, facing_lamp], distance[facing_lamp] * (1 - 1e-4)
            clear[facing_lamp] = geometry.clear(*ways)
            # Pairs of neighbors that the shadow's edge divides.
            difference = clear[neighbors[0]] - clear[neighbors[1]]
            up, down = neighbors[:, difference < 0], neighbors[:, difference > 0].flip(0)
            dark, bright = torch.cat((up, down), 1)
            keep = dot(surface.facet[:, dark], toward[:, dark]) > _GRAZING
            dark, bright = dark[keep], bright[keep]
            blocker = _contour(geometry, origin[:, dark], toward[:, dark], distance[dark])
            edges.append((dark, bright, spot[:, dark], blocker))
        dark, bright, spot, blocker = (torch.cat(parts, -1) for parts in zip(*edges, strict=True))
        pixel = torch.stack((pixel_index[dark], pixel_index[bright]))
        step = torch.stack((pixel[1] % width - pixel[0] % width, pixel[1] // width - pixel[0] // width))
        return ShadowEdges(pixel, step / spots.shape[1], spot, surface.pick(dark), blocker)

    def term(self, view: View, lamp: LightSource, pixels: int) -> Tensor:
        """Zeros (P,), P = `pixels`, whose gradient is that of the light's visible share in each pixel."""
        toward, distance = lamp.shadow_targets(lamp.irradiance(self.surface.position, self.surface.normal), self.spot)
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


def _penumbra(samples: Samples, visible: Tensor) -> Tensor:
    """(P,) bool: pixels near which the `visible` share (N,) is above 0 at some samples and below 1 at some."""
    width, height = samples.size
    pixel = samples.pixel[: samples.surfaces]
    signed = torch.stack((visible, -visible))
    most = torch.full((2, width * height), -2.0, device=visible.device)  # below all: such pixels do not count
    most = most.scatter_reduce(1, pixel.expand_as(signed), signed, "amax").view(1, 2, height, width)
    across = max_pool2d(most, (1, 2 * _PENUMBRA + 1), 1, (0, _PENUMBRA))
    near = max_pool2d(across, (2 * _PENUMBRA + 1, 1), 1, (_PENUMBRA, 0)).flatten(2)[0]
    return (near[0] > _LEAST_SHARE) & (near[1] > _LEAST_SHARE - 1)


def _neighbors(samples: Samples, surface: Surface, pixel_index: Tensor, facing_lamp: Tensor) -> Tensor:
    """Pairs (2, E) of neighboring pixels on one smooth surface that face the light, as indices into `pixel_index`."""
    width, height = samples.size
    index = torch.full((height * width,), -1, device=pixel_index.device)
    index[pixel_index[facing_lamp]] = facing_lamp.nonzero()[:, 0]
    index = index.view(height, width)
    pairs = [(index[:, :-1], index[:, 1:]), (index[:-1], index[1:])]
    a, b = (torch.cat([pair[i].flatten() for pair in pairs]) for i in (0, 1))
    a, b = torch.stack((a, b))[:, (a >= 0) & (b >= 0)]
    apart = surface.position[:, b] - surface.position[:, a]
    flat = dot(apart, surface.facet[:, a]).abs() < 0.5 * apart.norm(dim=0)
    same = samples.owner[pixel_index[a]] == samples.owner[pixel_index[b]]
    return torch.stack((a, b))[:, same & flat & (dot(surface.normal[:, a], surface.normal[:, b]) > 0.9)]


def _contour(geometry: RayGeometry, origin: Tensor, toward: Tensor, distance: Tensor) -> Tensor:
    """Middles (3, E) of what blocks rays (3, E) of length `distance` (E,): between the first hits from either end."""
    far = distance.clamp_max(2 * geometry.size)
    first = geometry.first_hits(origin, toward, "shadow").distance.minimum(far)
    last = far - geometry.first_hits(origin + toward * far, -toward, "shadow").distance.minimum(far)
    return origin + toward * ((first + last.maximum(first)) / 2)


@dataclass(frozen=True)
class Silhouettes:
    """All E pairs of neighboring pixels that an outline separates, for gradients of moving outlines.

    One pixel of a pair has a near surface, the other something farther. As in nvdiffrast (Laine et al. 2020, section
    3.6), their colors blend by the near surface's coverage a. The image is antialiased already, so only the derivative
    is added: (a - a.detach()) * (near - far), zero in value. The outline moves with the projection of the near
    surface's point; along the contour's normal this is exact to first order, for creases and smooth outlines.
    """

    pixel: Tensor  # (2, E) indices of the pixel with the near and of the pixel with the far surface
    sample: Tensor  # (2, E) index of a sample of the near surface, and of the far surface
    points: Tensor  # (3, E) world positions on the near surface
    motion: Tensor  # (2, E) coverage that the near surface gains if its point moves by one pixel along x or y

    @staticmethod
    def of(samples: Samples, surface: Surface) -> Silhouettes:
        """Finds the pairs in a view; `surface` has the points of the samples that meet a surface."""
        width, height = samples.size
        depth = samples.center_hits.distance.view(height, width)
        owner = samples.owner.view(height, width)
        pairs = [_pairs(depth, owner, axis) for axis in (0, 1)]
        near, far = (torch.cat([p[i] for p in pairs]) for i in (0, 1))
        # The nearest sample of the near pixel, the farthest sample of the far pixel.
        order, pixels = torch.argsort(samples.hits.distance, descending=True, stable=True), len(samples.first)
        nearest = last_of(samples.pixel, order, pixels)[near]
        sample = torch.stack((nearest, last_of(samples.pixel, order.flip(0), pixels)[far]))
        keep = sample[0] < samples.surfaces
        near, far, sample = near[keep], far[keep], sample[:, keep]
        # Unit normals (2, E) of outlines in the image, away from the near surface.
        flat = depth.flatten()
        edge = torch.minimum((flat[near] + flat[far]) / 2, flat[near] * 1.5)
        normal = torch.zeros((2, len(near)), device=depth.device)
        for dy in range(-_CONTOUR_WINDOW, _CONTOUR_WINDOW + 1):
            for dx in range(-_CONTOUR_WINDOW, _CONTOUR_WINDOW + 1):
                y, x = (near // width + dy).clamp(0, height - 1), (near % width + dx).clamp(0, width - 1)
                sign = torch.where(flat[y * width + x] < edge, -1.0, 1.0)
                normal[0] += sign * dx
                normal[1] += sign * dy
        normal = normal / normal.norm(dim=0).clamp_min(1e-6)
        step = torch.stack((far % width - near % width, far // width - near // width)).to(normal.dtype)
        motion = normal * (normal * step).sum(0).clamp_min(0.0)
        return Silhouettes(torch.stack((near, far)), sample, surface.position[:, sample[0]], motion)

    def term(self, view: View, values: Tensor, pixels: int) -> Tensor:
        """Zeros (C, P), P = `pixels`, whose gradient is that of moving outlines, from values (C, N) of the samples."""
        place = view.project(self.points)
        moved = ((place - place.detach()) * self.motion).sum(0)
        values = values.detach()
        contrast = values[:, self.sample[0]] - values[:, self.sample[1]]
        change = contrast * (moved * 0.5)
        zero = torch.zeros((len(values), pixels), device=values.device)
        return zero.index_add(1, self.pixel[0], change).index_add(1, self.pixel[1], change)


def _pairs(depth: Tensor, owner: Tensor, axis: int) -> tuple[Tensor, Tensor]:
    """Indices (E,) of the near and (E,) of the far pixels of neighbors along an axis whose object or depth differs."""
    n = depth.shape[axis] - 1
    index = torch.arange(depth.numel(), device=depth.device).view(depth.shape)
    a, b = depth.narrow(axis, 0, n), depth.narrow(axis, 1, n)
    i, j = index.narrow(axis, 0, n), index.narrow(axis, 1, n)
    low, high = torch.minimum(a, b), torch.maximum(a, b)
    # A smooth surface continues its slope over the neighbors; an outline does not.
    last = depth.shape[axis] - 1
    previous, following = (
        depth.index_select(axis, (torch.arange(n, device=depth.device) + by).clamp(0, last)) for by in (-1, 2)
    )
    before = torch.minimum(previous, a) / torch.maximum(previous, a)
    after = torch.minimum(following, b) / torch.maximum(following, b)
    bent = torch.minimum(before.nan_to_num(1.0), after.nan_to_num(1.0))
    jump = (owner.narrow(axis, 0, n) != owner.narrow(axis, 1, n)) | (low < high * (0.985 * bent))
    jump &= low.isfinite()
    return torch.where(a < b, i, j)[jump], torch.where(a < b, j, i)[jump]
