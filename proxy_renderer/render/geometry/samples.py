# SPDX-License-Identifier: Apache-2.0
"""Samples: the points that are shaded, also behind transparent surfaces, and the filter that adds them up to pixels."""

from dataclasses import dataclass, replace

import torch
from torch import Tensor

from .camera import View
from .vectors import PointSet, dot
from .visibility import Hits, RayGeometry

EDGE_SAMPLES = 5  # rays through a pixel at an edge
_NEIGHBOR = 0.084  # a pixel's share of each neighbor along an axis: a variance of 0.17 square pixels
_FILTER_WIDTH = 3.0  # pixels: twice Blender's setting (1.5 by default), which Cycles takes for a radius
_FAINT = 0.004  # share of a ray's light below which the ray ends, and a hit is not counted
_MOST_LAYERS = 8  # surfaces that a camera ray meets at most


@dataclass(frozen=True)
class Samples:
    """All N shaded points of one view, sorted by material, the background last; P pixels."""

    size: tuple[int, int]  # width and height of the image
    pixel: Tensor  # (N,) index of the pixel (row-major, row 0 on top) that a sample counts towards
    weight: Tensor  # (N,) the sample's share of the pixel; the shares of a pixel sum to 1
    place: Tensor  # (2, N) image position in pixels
    layer: Tensor  # (N,) number of surfaces that the ray has met before the sample
    hits: Hits  # (N,) where the samples' rays meet a surface or leave the scene
    slices: tuple[tuple[int, int, int], ...]  # for each material in view: index, first sample, one past the last
    surfaces: int  # number of samples that meet a surface; the samples after them see the background
    first: Tensor  # (P,) index of one sample of every pixel
    others: Tensor  # (N - P,) indices of the samples that are no pixel's `first`
    plain: Tensor  # (P,) bool: pixels with samples in their middle only
    owner: Tensor  # (P,) index of the object that the ray through a pixel's center meets; -1 for none
    center_hits: Hits  # hits of the rays through the pixels' centers (P,)
    origin: Tensor  # (3, N) origins of the samples' rays
    toward: Tensor  # (3, N) unit directions of the samples' rays

    def resolve(self, values: Tensor) -> Tensor:
        """Filtered pixels (C, P) from values (C, N) of the samples."""
        return _Resolve.apply(values, self)


class _Resolve(torch.autograd.Function):
    """Weighted sum of samples per pixel, whose backward pass is a gather."""

    @staticmethod
    def forward(ctx, values, samples):
        ctx.samples = samples
        weighted = values * samples.weight
        picture = weighted.index_select(1, samples.first)
        picture.index_add_(1, samples.pixel[samples.others], weighted.index_select(1, samples.others))
        # Pixels with one sample are mixed with their neighbors, in place of more samples under the pixel filter.
        return torch.where(samples.plain, _diffuse(picture, samples.size), picture)

    @staticmethod
    def backward(ctx, gradient):
        samples = ctx.samples
        softened = torch.where(samples.plain, gradient, 0.0)
        gradient = gradient - softened + _diffuse(softened, samples.size)
        return gradient.index_select(1, samples.pixel) * samples.weight, None


def _diffuse(picture: Tensor, size: tuple[int, int]) -> Tensor:
    """Pixels (C, P) that have exchanged a share with their neighbors; symmetric, so it is its own backward pass."""
    spread = picture.view(-1, size[1], size[0]).clone()
    for axis in (1, 2):
        n = spread.shape[axis] - 1
        flow = spread.narrow(axis, 1, n) - spread.narrow(axis, 0, n)
        flow *= _NEIGHBOR
        spread.narrow(axis, 0, n).add_(flow)
        spread.narrow(axis, 1, n).sub_(flow)
    return spread.view(picture.shape)


def take(geometry: RayGeometry, view: View, smooth: Tensor) -> Samples:
    """Finds the points that a view sees: one ray through the middle of plain pixels, several where edges pass.

    Pixels of `smooth` materials (M,) bool get several rays, too: edges may pass anywhere in their reflections. A ray
    through transparent surfaces makes a sample on each surface, weighted by the surface's share of the ray's light.
    """
    # Rays through the centers show where edges pass.
    centers = pixel_centers(view.size).to(geometry.device)
    origin, toward = view.rays(centers)
    layers = follow(geometry, view, origin, toward)
    strongest = last_of(layers.ray, torch.argsort(layers.weight, stable=True), len(origin[0]))
    center_hits = layers.hits.pick(strongest)
    edge = _edges(geometry, center_hits, toward, *view.size)
    if geometry.opacity is not None:
        nearest = last_of(layers.ray, torch.arange(len(layers.ray), device=edge.device).flip(0), len(origin[0]))
        edge |= _edges(geometry, layers.hits.pick(nearest), toward, *view.size)
    edge |= smooth[geometry.material[center_hits.triangle.clamp_min(0)]] & center_hits.hit
    # More rays for these pixels.
    busy = edge.nonzero()[:, 0]
    places = (centers[:, busy, None] + _filter_points(geometry.device)[:, None, :]).flatten(1)
    more_origin, more_toward = view.rays(places)
    more = follow(geometry, view, more_origin, more_toward)
    few = layers.pick((~edge)[layers.ray])
    pixel = torch.cat((few.ray, busy.repeat_interleave(EDGE_SAMPLES)[more.ray]))
    met = HitLayers.joined((few, replace(more, weight=more.weight / EDGE_SAMPLES)))
    # All are sorted by material, those of the background last.
    materials = int(geometry.material.max()) + 1
    owner = torch.where(met.hits.hit, geometry.material[met.hits.triangle.clamp_min(0)], materials)
    owner, order = torch.sort(owner, stable=True)
    slices, start = [], 0
    for material, count in enumerate(torch.bincount(owner, minlength=materials + 1).tolist()[:-1]):
        if count:
            slices.append((material, start, start + count))
        start += count
    pixel, met = pixel[order], met.pick(order)
    index = torch.arange(len(pixel), device=pixel.device)
    first = last_of(pixel, index, int(pixel.max()) + 1)
    return Samples(
        size=view.size,
        pixel=pixel,
        weight=met.weight,
        place=torch.cat((centers[:, few.ray], places[:, more.ray]), 1)[:, order],
        layer=met.number,
        hits=met.hits,
        slices=tuple(slices),
        surfaces=start,
        first=first,
        others=index[first[pixel] != index],
        plain=~edge,
        owner=torch.where(center_hits.hit, geometry.object[center_hits.triangle.clamp_min(0)], -1),
        center_hits=center_hits,
        origin=torch.cat((origin[:, few.ray], more_origin[:, more.ray]), 1)[:, order],
        toward=torch.cat((toward[:, few.ray], more_toward[:, more.ray]), 1)[:, order],
    )


def pixel_centers(size: tuple[int, int]) -> Tensor:
    """(2, P) image positions of the middles of all pixels of a size (width, height), row by row."""
    y, x = torch.meshgrid(torch.arange(size[1]), torch.arange(size[0]), indexing="ij")
    return torch.stack((x.flatten(), y.flatten())).to(torch.float32) + 0.5


def _edges(geometry: RayGeometry, hits: Hits, toward: Tensor, width: int, height: int) -> Tensor:
    """(P,) bool: pixels that differ from a neighbor in object, material, normal or depth, by hits of center rays."""
    surface = geometry.surface(hits, toward)
    index = hits.triangle.clamp_min(0)
    name = torch.where(hits.hit, geometry.object[index] * 4096 + surface.material, -1).view(height, width)
    normal = torch.where(hits.hit, surface.normal, 0.0).view(3, height, width)
    depth = torch.where(hits.hit, hits.distance, 0.0).view(height, width)
    slope = torch.where(hits.hit, dot(surface.facet, toward).abs().clamp_min(0.05), 1.0).view(height, width)
    pitch = 4.0 / max(width, height)
    edge = torch.zeros((height, width), dtype=torch.bool, device=name.device)
    for axis in (0, 1):
        n = name.shape[axis] - 1
        a, b = name.narrow(axis, 0, n), name.narrow(axis, 1, n)
        na, nb = normal.narrow(axis + 1, 0, n), normal.narrow(axis + 1, 1, n)
        da, db = depth.narrow(axis, 0, n), depth.narrow(axis, 1, n)
        steep = torch.minimum(slope.narrow(axis, 0, n), slope.narrow(axis, 1, n))
        jump = (a != b) | ((dot(na, nb) < 0.9) & (a >= 0)) | ((da - db).abs() * steep > pitch * da)
        edge.narrow(axis, 0, n).logical_or_(jump)
        edge.narrow(axis, 1, n).logical_or_(jump)
    return edge.flatten()


def _filter_points(device: torch.device) -> Tensor:
    """Offsets (2, EDGE_SAMPLES) in pixels from a pixel's center, distributed like Cycles' Blackman-Harris filter."""
    x = torch.linspace(0, 1, 513, dtype=torch.float64)
    angle = 2 * torch.pi * x
    window = 0.35875 - 0.48829 * angle.cos() + 0.14128 * (2 * angle).cos() - 0.01168 * (3 * angle).cos()
    total = window.cumsum(0) / window.sum()
    index = torch.arange(EDGE_SAMPLES, dtype=torch.float64)
    columns = (index + 0.5) / EDGE_SAMPLES
    rows = ((index * 2 + 1) % EDGE_SAMPLES + 0.5) / EDGE_SAMPLES  # five rooks that do not attack each other
    offsets = [x[torch.searchsorted(total, c).clamp_max(512)] - 0.5 for c in (columns, rows)]
    return (torch.stack(offsets) * _FILTER_WIDTH).to(device, torch.float32)


@dataclass(frozen=True)
class HitLayers(PointSet):
    """N hits of camera rays: the surfaces that a ray passes, nearest first, then the surface or miss that ends it."""

    ray: Tensor  # (N,) index of the ray
    number: Tensor  # (N,) number of surfaces that the ray has met before
    hits: Hits  # (N,) the ray's hit on this surface, or a miss for the background
    weight: Tensor  # (N,) the surface's share of the ray's light; the shares of a ray sum to 1


def follow(geometry: RayGeometry, view: View, origin: Tensor, toward: Tensor) -> HitLayers:
    """All hits that camera rays (3, N) see from the near to the far plane, through transparent surfaces."""
    index = torch.arange(origin.shape[1], device=geometry.device)
    left = torch.ones(len(index), device=geometry.device)
    near, far = view.span(toward)
    hits = geometry.nearest(origin + toward * near, toward, "camera")
    hits = _before(far, replace(hits, distance=hits.distance + near))
    if geometry.opacity is None:
        return HitLayers(index, torch.zeros_like(index), hits, left)
    collected: list[HitLayers] = []
    for number in range(_MOST_LAYERS):
        alpha = geometry.opacity(geometry.surface(hits, toward[:, index]), by_camera=number == 0)
        alpha = torch.where(hits.hit, alpha, 1.0)
        rest = left * (1 - alpha)
        ends = (rest < _FAINT) | (number == _MOST_LAYERS - 1)
        share = torch.where(ends, left, left * alpha)
        counts = share >= _FAINT
        collected.append(HitLayers(index, torch.full_like(index, number), hits, share).pick(counts))
        onward = ~ends
        if not bool(onward.any()):
            break
        # A share that is too faint to count goes to the next hit of the ray.
        index, left = index[onward], torch.where(counts, rest, left)[onward]
        hits = _before(far[index], geometry.onward(hits.pick(onward), origin[:, index], toward[:, index], "camera"))
    return HitLayers.joined(collected)


def _before(far: Tensor, hits: Hits) -> Hits:
    """The hits of N rays, with those beyond the rays' distances `far` (N,) turned into misses."""
    inside = hits.distance <= far
    triangle, distance = torch.where(inside, hits.triangle, -1), torch.where(inside, hits.distance, torch.inf)
    return replace(hits, triangle=triangle, distance=distance)


def last_of(group: Tensor, order: Tensor, count: int) -> Tensor:
    """Index (count,) of each group's member that comes last in `order`, a permutation (N,) of the members.

    `group` (N,) has the number of each member's group, from 0 to `count` - 1; no group may be empty.
    """
    rank = torch.arange(len(order), device=order.device)
    last = torch.zeros(count, dtype=torch.int64, device=order.device)
    # Not by assignment: which of several writes to one place wins is not defined.
    return order[last.scatter_reduce(0, group[order], rank, "amax")]
