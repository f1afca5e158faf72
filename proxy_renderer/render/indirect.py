# SPDX-License-Identifier: Apache-2.0
"""Light that comes over other surfaces and from the world: rays traced once, weighed anew every render.

A ray's hit is shaded simply: its albedo times the lights' irradiance there, plus its glow. That is
linear in (albedo x light), so the rays of a point add up to a fixed row of weights over a small table
of radiances, and one matrix product per render gives every point its bounced light.
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass

import torch
from torch import Tensor

from .environment import harmonics
from .lights import Lamp, arrival, tangents
from .samples import Samples
from .visibility import Geometry, Surface, sphere_points
from .vectors import dot, unit

GLOSSY = 0.4
"""Roughness of the blurred reflection between the mirror image and the diffuse light."""
_ANCHORS_ACROSS = 96
_DIFFUSE_RAYS = 16
_GLOSSY_RAYS = 8


@dataclass(frozen=True)
class Table:
    """What far hits and the world radiate in one render; the rows of `radiances` are:

    for every material, the light of each lamp that it scatters and of the world; then every
    material's glow; then the world's nine spherical harmonics.
    """

    radiances: Tensor

    @staticmethod
    def of(albedo: Tensor, glow: Tensor, lamp_colors: Tensor, sky_mean: Tensor, sky: Tensor) -> Table:
        """Builds the table.

        Args:
            albedo: (M, 3) share of light that each material scatters.
            glow: (M, 3) emitted radiance.
            lamp_colors: (L, 3).
            sky_mean: (3,) average radiance of the world.
            sky: (9, 3) its spherical harmonics.
        """
        sources = torch.cat((lamp_colors / math.pi, sky_mean[None]))
        scattered = (albedo[:, None, :] * sources).flatten(0, 1)
        return Table(torch.cat((scattered, glow, sky)))


class Far:
    """Rays from A points, R each, and what they meet.

    Attributes:
        count: Rays per point.
        open: (A,) share of rays that leave the scene.
        surface: The surface at the hits, (A * R).
    """

    def __init__(
        self, geometry: Geometry, origin: Tensor, toward: Tensor, count: int, materials: int, lamps: int
    ) -> None:
        self.geometry, self.count = geometry, count
        hits = geometry.first_hits(origin, toward)
        self.hit = hits.hit.to(torch.float32)
        self.surface: Surface = geometry.surface(hits, toward)
        self.distance = hits.distance
        self.open = 1 - self.hit.view(-1, count).mean(1)
        self.owner = self.surface.material * hits.hit + materials * ~hits.hit
        self.materials = materials
        self._sources: Tensor | None = None
        self.irradiance = torch.zeros((lamps, len(self.hit)), device=self.hit.device)
        self.sky_seen = self._ambient()
        self.harmonics = (harmonics(toward) * (1 - self.hit)).view(9, -1, count).mean(2)

    def _ambient(self) -> Tensor:
        """(A * R,) whether a hit sees the world along its normal's side: one random ray tells."""
        generator = torch.Generator().manual_seed(7)
        uv = torch.rand((2, self.surface.position.shape[1]), generator=generator).to(self.hit.device)
        origin = self.geometry.lifted(self.surface)
        reach = torch.full_like(self.hit, math.inf)
        return self.geometry.clear(origin, cosine_directions(self.surface.normal, uv), reach)

    def light(self, index: int, lamp: Lamp) -> None:
        """Traces the hits' shadow rays to one lamp."""
        met = arrival(lamp, self.surface.position, self.surface.normal)
        shade = torch.ones_like(self.hit)
        if lamp.light.shadow:
            facing = dot(self.surface.facet, met.toward) > 0
            origin = self.geometry.lifted(self.surface)
            shade = self.geometry.clear(origin, met.toward, met.distance * 0.999) * facing
        self.irradiance[index] = met.irradiance * shade
        self._sources = None

    def image(self, table: Table) -> Tensor:
        """Radiance (3, A) of the hits of single rays; 0 where they leave the scene."""
        if self._sources is None:
            self._sources = torch.cat((self.irradiance, self.sky_seen[None]))
            self._members = [(self.owner == m).nonzero()[:, 0] for m in range(self.materials)]
        return _Image.apply(table.radiances, self._sources, self._members)

    def weights(self) -> Tensor:
        """(A, K) average over each point's rays: weights over the rows of `Table.radiances`."""
        rays = -1, self.count
        slots = torch.cat((self.irradiance, self.sky_seen[None], torch.ones_like(self.hit)[None]))
        slots = slots.view(len(slots), *rays).permute(1, 2, 0)
        owner = self.owner.view(rays)
        one_hot = torch.nn.functional.one_hot(owner, self.materials + 1)[..., :-1].to(slots.dtype)
        summed = torch.einsum("arm,ars->ams", one_hot, slots) / self.count
        scattered, glow = summed[..., :-1].flatten(1), summed[..., -1]
        return torch.cat((scattered, glow, self.harmonics.T), 1)


class Indirect:
    """Bounced light and reflections for the samples of one view.

    `points` are the anchors' surface; `open_sky` holds the shares (N,) of the blurred and of the mirrored
    reflection that the world fills.

    Diffuse light and blurred reflections vary slowly, so they are gathered at a coarse grid of
    anchors and spread to the samples by position and normal; mirror images are traced per sample.
    """

    def __init__(self, geometry: Geometry, samples: Samples, surface: Surface, materials: int, lamps: int,
                 generator: torch.Generator) -> None:  # fmt: skip
        n = samples.surfaces
        anchors, self._smooth, self.spread = _anchors(samples, surface)
        self.points = points = surface.pick(anchors)
        toward = samples.toward[:, anchors]
        origin = geometry.lifted(points)
        shape = geometry, materials, lamps
        self.diffuse = _far(*shape, origin, _diffuse_rays(points, generator), _DIFFUSE_RAYS)
        self.glossy = _far(*shape, origin, _glossy_rays(points, toward, generator), _GLOSSY_RAYS)
        mirrored = reflect(samples.toward[:, :n], surface.normal)
        mirrored = above(mirrored, surface.facet)
        self.mirror = Far(geometry, geometry.lifted(surface), mirrored, 1, materials, lamps)
        self.open_sky = self.spread(self.glossy.open[:, None])[:, 0], self.mirror.open
        self._weights: tuple[Tensor, Tensor] | None = None
        self._skies = materials * (lamps + 2)

    def light(self, index: int, lamp: Lamp) -> None:
        """Takes up that a lamp has moved."""
        for far in (self.diffuse, self.glossy, self.mirror):
            far.light(index, lamp)
        self._weights = None

    def gather(self, table: Table, ambient: Tensor | None = None) -> tuple[Tensor, Tensor, Tensor]:
        """Light that comes over other surfaces and from the world.

        Args:
            table: The radiances of all there is to see.
            ambient: (A,) share of the world's light that fog lets through to the anchors.

        Returns:
            Irradiance (3, N), the world's included; blurred and mirrored radiance of surfaces, (3, N)
            each, without the world.
        """
        if self._weights is None:
            low, glossy = self._smooth(self.diffuse.weights()) * math.pi, self.glossy.weights()
            self._weights = low, glossy[:, : self._skies]
        wide, narrow = self._weights
        sky = wide[:, self._skies :] @ table.radiances[self._skies :]
        sky = sky if ambient is None else sky * ambient[:, None]
        over = table.radiances[: self._skies]
        low = torch.cat((wide[:, : self._skies] @ over + sky, narrow @ over), 1)
        full = self.spread(low).T
        return full[:3].clamp_min(0.0), full[3:], self.mirror.image(table)



def _far(geometry: Geometry, materials: int, lamps: int, origin: Tensor, toward: Tensor, count: int) -> Far:
    origins = origin.repeat_interleave(count, 1)
    return Far(geometry, origins, toward, count, materials, lamps)


class _Image(torch.autograd.Function):
    """Radiance (3, N) of single hits: like `Far.weights() @ radiances`, without the mostly empty matrix."""

    @staticmethod
    def forward(ctx, radiances, sources, members):  # type: ignore[no-untyped-def]
        ctx.members, ctx.sources, ctx.rows = members, sources, len(radiances)
        count, materials = len(sources), len(members)
        out = torch.zeros((3, sources.shape[1]), device=sources.device)
        for m, chosen in enumerate(members):
            if len(chosen):
                rows, glow = radiances[m * count : (m + 1) * count], radiances[materials * count + m]
                out.index_copy_(1, chosen, rows.T @ sources.index_select(1, chosen) + glow[:, None])
        return out

    @staticmethod
    def backward(ctx, gradient):  # type: ignore[no-untyped-def]
        count, materials = len(ctx.sources), len(ctx.members)
        result = gradient.new_zeros((ctx.rows, 3))
        for m, chosen in enumerate(ctx.members):
            if len(chosen):
                part = gradient.index_select(1, chosen)
                result[m * count : (m + 1) * count] = ctx.sources.index_select(1, chosen) @ part.T
                result[materials * count + m] = part.sum(1)
        return result, None, None


class Spread:
    """A fixed sparse matrix (N, A), applied to (A, C), with its transpose ready for gradients."""

    def __init__(self, rows: Tensor, columns: Tensor, weights: Tensor, shape: tuple[int, int]) -> None:
        with warnings.catch_warnings(), torch.sparse.check_sparse_tensor_invariants(False):
            warnings.filterwarnings("ignore", "Sparse (CSR|invariant)")  # "in beta", says torch
            matrix = torch.sparse_coo_tensor(torch.stack((rows, columns)), weights, shape).coalesce()
            self.forward = matrix.to_sparse_csr()
            self.backward = matrix.t().coalesce().to_sparse_csr()

    def __call__(self, values: Tensor) -> Tensor:
        return _SparseProduct.apply(values, self.forward, self.backward)


class _SparseProduct(torch.autograd.Function):
    @staticmethod
    def forward(ctx, values, matrix, transposed):  # type: ignore[no-untyped-def]
        ctx.transposed = transposed
        return matrix @ values

    @staticmethod
    def backward(ctx, gradient):  # type: ignore[no-untyped-def]
        return ctx.transposed @ gradient.contiguous(), None, None


def _anchors(samples: Samples, surface: Surface) -> tuple[Tensor, Spread, Spread]:
    """Chooses anchors among the samples on a coarse grid.

    Returns:
        Indices (A,) of samples; the sparse weights that smooth noise over neighboring anchors, and those
        that carry from anchors to samples.
    """
    width, height = samples.size
    n, device = samples.surfaces, surface.position.device
    stride = max(1, round(max(samples.size) / _ANCHORS_ACROSS))
    columns, rows = -(-width // stride), -(-height // stride)
    place = samples.place[:, :n] / stride
    cell = place[1].long().clamp(0, rows - 1) * columns + place[0].long().clamp(0, columns - 1)
    # One anchor for each material seen in each cell, the one that lies nearest to the cell's middle.
    order = torch.argsort((place % 1.0 - 0.5).abs().sum(0), descending=True, stable=True)
    _, group = torch.unique(cell * 4096 + surface.material, return_inverse=True)
    chosen = torch.empty(int(group.max()) + 1 if n else 0, dtype=torch.int64, device=device)
    chosen[group[order]] = order
    lists = _cell_lists(cell[chosen], columns, rows)
    pitch = samples.hits.distance[:n] * (2.0 / max(columns, rows))
    points = _Places(place, surface, pitch)
    smooth = _spread(points.pick(chosen), points.pick(chosen), lists, (-2, -1, 0, 1, 2), nearest=25, width=2.5)
    return chosen, smooth, _spread(points.pick(chosen), points, lists, (0, 1), nearest=4, width=1.0)


@dataclass(frozen=True)
class _Places:
    """Points between which light is carried: place (2, N) in cells, surface, and size (N,) of a cell there."""

    place: Tensor
    surface: Surface
    pitch: Tensor

    def pick(self, index: Tensor) -> _Places:
        return _Places(self.place[:, index], self.surface.pick(index), self.pitch[index])


def _cell_lists(cell: Tensor, columns: int, rows: int, most: int = 3) -> Tensor:
    """(rows, columns, most) anchors of every cell, -1 where there are fewer."""
    order = torch.argsort(cell, stable=True)
    count = torch.bincount(cell, minlength=columns * rows)
    rank = torch.arange(len(cell), device=cell.device) - (count.cumsum(0) - count)[cell[order]]
    lists = torch.full((columns * rows, most), -1, dtype=torch.int64, device=cell.device)
    keep = rank < most
    lists[cell[order][keep], rank[keep]] = order[keep]
    return lists.view(rows, columns, most)


def _spread(
    anchors: _Places, points: _Places, lists: Tensor, window: tuple[int, ...], nearest: int, width: float
) -> Spread:
    """Weights to points from the anchors around them that fit their normal, plane and place best.

    Args:
        anchors, points: From where, to where.
        lists: The anchors of every cell.
        window: Cells to look at along both axes: offsets from a point's own, or from the upper left of the
            four whose middles surround it where the window has an even length.
        nearest: How many of the anchors to keep.
        width: Distance in cells at which an anchor's weight has faded.
    """
    rows, columns = lists.shape[:2]
    shift = 0.0 if len(window) % 2 else 0.5
    x, y = (points.place - shift).floor().long()
    near = [
        lists[(y + dy).clamp(0, rows - 1), (x + dx).clamp(0, columns - 1)] for dy in window for dx in window
    ]
    candidates = torch.cat(near, 1)
    index = candidates.clamp_min(0)
    plane = torch.zeros(index.shape, device=index.device)
    alike = torch.zeros_like(plane)
    for axis in range(3):
        normal = points.surface.normal[axis, :, None]
        plane += (anchors.surface.position[axis, index] - points.surface.position[axis, :, None]) * normal
        alike += anchors.surface.normal[axis, index] * normal
    apart = (anchors.place[:, index] - points.place[..., None]) / width
    fit = (-((plane / points.pitch[:, None]) ** 2) * 4).exp() * alike.clamp_min(0.0) ** 8
    weight = (fit + 1e-6) * (1.0 - apart.abs()).clamp_min(0.02 / width).prod(0)
    weight = torch.where(candidates >= 0, weight, 0.0)
    weight, best = weight.topk(min(nearest, weight.shape[1]), 1)
    weight = weight / weight.sum(1, keepdim=True).clamp_min(1e-20)
    to = torch.arange(len(index), device=index.device)[:, None].expand_as(best)
    shape = len(index), anchors.place.shape[1]
    return Spread(to.flatten(), index.gather(1, best).flatten(), weight.flatten(), shape)


def reflect(toward: Tensor, normal: Tensor) -> Tensor:
    """Mirror directions (3, N) of rays (3, N) at unit normals (3, N)."""
    return toward - normal * (2 * dot(toward, normal))


def above(toward: Tensor, facet: Tensor) -> Tensor:
    """Lifts directions (3, N) that would enter the surface to just above it."""
    cosine = dot(toward, facet)
    return unit(toward + facet * (0.01 - cosine).clamp_min(0.0))


def cosine_directions(normal: Tensor, uv: Tensor) -> Tensor:
    """Cosine-distributed directions (3, N) around unit normals (3, N) from points (2, N) in [0, 1)^2."""
    radius, angle = uv[0].sqrt(), 2 * math.pi * uv[1]
    across, up = tangents(normal)
    return across * (radius * angle.cos()) + up * (radius * angle.sin()) + normal * (1 - uv[0]).sqrt()


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
