# SPDX-License-Identifier: Apache-2.0
"""Gather points: samples on a coarse grid, at which indirect light is gathered and from which it is interpolated."""

from __future__ import annotations

import functools
import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from .samples import Samples, last_of
from .vectors import PointSet
from .visibility import Surface

_CELLS_ACROSS = 96  # along the image's longer side


class SparseWeights:
    """A constant sparse matrix (N, A), which multiplies values (A, …).

    `rows` (R,) has the indices of the rows that are not empty, in increasing order. `columns` and `weights` (R, K) have
    the K entries of each of these rows; entries of the same column add up.
    """

    def __init__(self, rows: Tensor, columns: Tensor, weights: Tensor, shape: tuple[int, int]) -> None:
        self._rows, self._columns, self._weights, self._shape = rows, columns.int(), weights, shape
        counts = torch.zeros(shape[0], dtype=torch.int64, device=rows.device)
        counts[rows] = columns.shape[1]
        self.forward = _csr(counts, self._columns.flatten(), weights.flatten(), shape)

    def __call__(self, values: Tensor) -> Tensor:
        """Weighted sums (N, …) of values (A, …)."""
        return _SparseProduct.apply(values.flatten(1), self).view(-1, *values.shape[1:])

    @functools.cached_property
    def backward(self) -> Tensor:
        """The transpose (A, N), which only gradients need."""
        rows, columns = self._shape
        sorted_columns, order = torch.sort(self._columns.flatten(), stable=True)
        counts = torch.bincount(sorted_columns, minlength=columns)
        owner = self._rows.int()[order // self._columns.shape[1]]
        return _csr(counts, owner, self._weights.flatten()[order], (columns, rows))


def _csr(counts: Tensor, columns: Tensor, weights: Tensor, shape: tuple[int, int]) -> Tensor:
    """A sparse matrix of a shape; row i has counts[i] entries, `columns` and `weights` (E,) list all, row by row."""
    starts = torch.cat((counts.new_zeros(1), counts.cumsum(0))).int()
    with warnings.catch_warnings(), torch.sparse.check_sparse_tensor_invariants(False):
        warnings.filterwarnings("ignore", "Sparse (CSR|invariant)")  # "in beta", says torch
        return torch.sparse_csr_tensor(starts, columns, weights, shape)


class _SparseProduct(torch.autograd.Function):
    @staticmethod
    def forward(ctx, values, spread):
        ctx.spread = spread
        return spread.forward @ values

    @staticmethod
    def backward(ctx, gradient):
        return ctx.spread.backward @ gradient.contiguous(), None


class GatherPoints:
    """The A gather points of a view: one sample for each material that is seen in each cell of a coarse grid.

    `surface` has the surface points of the samples. `across` is the number of cells along the image's longer side.
    """

    def __init__(self, samples: Samples, surface: Surface, across: int = _CELLS_ACROSS) -> None:
        width, height = samples.size
        n = samples.surfaces
        self._stride = max(1, round(max(samples.size) / across))
        columns, rows = -(-width // self._stride), -(-height // self._stride)
        place = samples.place[:, :n] / self._stride
        cell = place[1].long().clamp(0, rows - 1) * columns + place[0].long().clamp(0, columns - 1)
        # A gather point is the sample of its kind that lies nearest to the cell's middle.
        order = torch.argsort((place % 1.0 - 0.5).abs().sum(0), descending=True, stable=True)
        # A kind is a cell, material and layer: behind a transparent surface, the material may be seen in another place.
        kind = (cell * 4096 + surface.material) * 8 + samples.layer[:n].clamp_max(7)
        _, group = torch.unique(kind, return_inverse=True)
        self.index = last_of(group, order, int(group.max()) + 1 if n else 0)  # (A,) indices of samples
        own = cell[self.index]
        self._cell = torch.stack((own % columns, own // columns))
        # Gather points (rows, columns, most) in every cell, -1 where there are fewer.
        most = min(3 * (1 + int(samples.layer[:n].max())) if n else 3, 9)
        order = torch.argsort(own, stable=True)
        count = torch.bincount(own, minlength=columns * rows)
        rank = torch.arange(len(own), device=own.device) - (count.cumsum(0) - count)[own[order]]
        lists = torch.full((columns * rows, most), -1, dtype=torch.int64, device=own.device)
        lists[own[order][rank < most], rank[rank < most]] = order[rank < most]
        self._lists = lists.view(rows, columns, most)
        points = _Places(place, surface, samples.hits.distance[:n] * (2.0 / max(columns, rows)))
        self._gather_points = points.pick(self.index)
        # Averages over neighboring gather points, against noise: over fewer for values that depend on the view.
        self.smooth = self._weights(self._gather_points, range(-3, 4), nearest=40, width=3.5)
        self.smooth_glossy = self._weights(self._gather_points, range(-1, 2), nearest=9, width=1.6)
        self.spread = self._weights(points)  # interpolates from gather points to all surface samples

    def turns(self, side: int) -> Tensor:
        """Numbers (A,) from 0 to side² - 1 of the gather points' cells; any square of side × side cells has each once.

        Gather points of different numbers get different rays. An average shows no pattern if each number weighs the
        same in it, as in `smooth` for a side of 4, and nearly in `smooth_glossy` for 2.
        """
        column, row = self._cell % side
        return row * side + column

    def spread_to(
        self, surface: Surface, place: Tensor, distance: Tensor, chosen: Tensor | None = None
    ) -> SparseWeights:
        """Weights (N, A) that interpolate values at the gather points to N other points of a surface.

        `place` (2, N) has the other points' image positions in pixels, also outside the image; `distance` (N,) is in
        meters from the camera. Points outside `chosen` (N,) bool get 0; None chooses all.
        """
        rows, columns = self._lists.shape[:2]
        limit = place.new_tensor([[columns], [rows]]) - 0.5
        inside = torch.minimum((place / self._stride).clamp_min(0.5), limit)
        return self._weights(_Places(inside, surface, distance * (2.0 / max(columns, rows))), chosen=chosen)

    def _weights(
        self,
        points: _Places,
        window: Sequence[int] = (0, 1),
        nearest: int = 4,
        width: float = 1.0,
        chosen: Tensor | None = None,
    ) -> SparseWeights:
        """Weights (N, A) of the gather points that fit the normal, plane and place of each of N points best.

        `window` has the offsets of the cells to search, along both axes. An odd number of offsets starts at the point's
        own cell, an even number at the upper left of the four cells whose middles surround the point. `nearest` gather
        points are kept for each point. At a distance of `width` cells, a weight is almost 0. Points outside `chosen`
        (N,) bool get 0.
        """
        lists, count = self._lists, points.place.shape[1]
        rows = torch.arange(count, device=lists.device) if chosen is None else chosen.nonzero()[:, 0]
        points = points if chosen is None else points.pick(rows)
        # Indices (W, N) of the window's cells around the points.
        x, y = (points.place - (0.0 if len(window) % 2 else 0.5)).floor().long()
        across = [(x + step).clamp(0, lists.shape[1] - 1) for step in window]
        down = [(y + step).clamp(0, lists.shape[0] - 1) * lists.shape[1] for step in window]
        near = torch.stack([row + column for row in down for column in across])
        held = (lists >= 0).sum(2).flatten()
        most = torch.zeros_like(rows)
        for cells in near:
            most = torch.maximum(most, held.index_select(0, cells))
        best = torch.zeros((len(rows), nearest), dtype=torch.int64, device=lists.device)
        weight = torch.zeros(best.shape, device=lists.device)
        # Points are grouped by the largest number of gather points in a near cell: few candidates are compared.
        for n in range(1, lists.shape[2] + 1):
            group = (most == n).nonzero()[:, 0]
            if len(group):
                cells = near[:, group].flatten()
                columns = (lists[:, :, i].flatten() for i in range(n))
                among = torch.cat([c.index_select(0, cells).view(len(near), -1) for c in columns])
                best[group], weight[group] = _best(self._gather_points, points.pick(group), among, nearest, width)
        weight = weight / weight.sum(1, keepdim=True).clamp_min(1e-20)
        return SparseWeights(rows, best, weight, (count, len(self.index)))


@dataclass(frozen=True)
class _Places(PointSet):
    """N points of an interpolation: image positions `place` (2, N) in cells, sizes `pitch` (N,) of a cell in meters."""

    place: Tensor
    surface: Surface
    pitch: Tensor


def _best(gather_points: _Places, points: _Places, among: Tensor, nearest: int, width: float) -> tuple[Tensor, Tensor]:
    """Indices (N, nearest) of the gather points nearest to N points in place and normal, and weights (N, nearest).

    `among` (C, N) has the indices of C candidates for each point, -1 for none. At `width` grid cells away a weight is almost 0.
    """
    index = among.clamp_min(0)

    def of(values: Tensor) -> Tensor:
        return values.index_select(0, index.flatten()).view(index.shape)

    plane = torch.zeros(index.shape, device=index.device)
    alike = torch.zeros_like(plane)
    for axis in range(3):
        normal = points.surface.normal[axis]
        plane += (of(gather_points.surface.position[axis]) - points.surface.position[axis]) * normal
        alike += of(gather_points.surface.normal[axis]) * normal
    weight = (-((plane / points.pitch) ** 2)).exp() * alike.clamp_min(0.0) ** 8 + 1e-6
    for axis in range(2):
        apart = (of(gather_points.place[axis]) - points.place[axis]).abs() / width
        weight *= (1.0 - apart).clamp_min(0.02 / width)
    weight = torch.where(among >= 0, weight, 0.0).T
    if weight.shape[1] == nearest:
        return index.T, weight
    weight, best = weight.contiguous().topk(nearest, 1)
    return index.T.gather(1, best), weight
