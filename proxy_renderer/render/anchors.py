# SPDX-License-Identifier: Apache-2.0
"""A coarse grid of anchors among the samples, and how what is known there is carried to all samples."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from .samples import Samples, last_of
from .visibility import Surface

_ANCHORS_ACROSS = 96


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
    def forward(ctx, values, matrix, transposed):
        ctx.transposed = transposed
        return matrix @ values

    @staticmethod
    def backward(ctx, gradient):
        return ctx.transposed @ gradient.contiguous(), None, None


class Anchors:
    """Samples on a coarse grid, one for each material seen in each cell.

    Args:
        samples, surface: What the view sees.
        across: Cells along the picture's longer side.

    Attributes:
        index: (A,) the samples.
        smooth: Evens out noise over neighboring anchors.
        smooth_glossy: The same over the nearest only, for what turns with the view.
        spread: Carries from anchors to all surface samples.
    """

    def __init__(self, samples: Samples, surface: Surface, across: int = _ANCHORS_ACROSS) -> None:
        width, height = samples.size
        n = samples.surfaces
        self._stride = max(1, round(max(samples.size) / across))
        columns, rows = -(-width // self._stride), -(-height // self._stride)
        place = samples.place[:, :n] / self._stride
        cell = place[1].long().clamp(0, rows - 1) * columns + place[0].long().clamp(0, columns - 1)
        # The one that lies nearest to its cell's middle.
        order = torch.argsort((place % 1.0 - 0.5).abs().sum(0), descending=True, stable=True)
        # Behind a transparent surface the same material may look elsewhere.
        kind = (cell * 4096 + surface.material) * 8 + samples.layer[:n].clamp_max(7)
        _, group = torch.unique(kind, return_inverse=True)
        self.index = last_of(group, order, int(group.max()) + 1 if n else 0)
        most = 3 * (1 + int(samples.layer[:n].max())) if n else 3
        self._lists = _cell_lists(cell[self.index], columns, rows, min(most, 9))
        points = _Places(place, surface, samples.hits.distance[:n] * (2.0 / max(columns, rows)))
        self._anchors = points.pick(self.index)
        near = range(-3, 4)
        self.smooth = _spread(self._anchors, self._anchors, self._lists, near, nearest=40, width=3.5)
        near = range(-1, 2)
        self.smooth_glossy = _spread(self._anchors, self._anchors, self._lists, near, nearest=9, width=1.6)
        self.spread = _spread(self._anchors, points, self._lists, (0, 1), nearest=4, width=1.0)

    def spread_to(self, surface: Surface, place: Tensor, distance: Tensor) -> Spread:
        """Carries from anchors to other points: what the picture shows of them, or of things near by.

        Args:
            surface: N points.
            place: (2, N) picture positions in pixels, which may lie outside.
            distance: (N,) from the camera.
        """
        rows, columns = self._lists.shape[:2]
        limit = place.new_tensor([[columns], [rows]]) - 0.5
        inside = torch.minimum((place / self._stride).clamp_min(0.5), limit)
        points = _Places(inside, surface, distance * (2.0 / max(columns, rows)))
        return _spread(self._anchors, points, self._lists, (0, 1), nearest=4, width=1.0)


@dataclass(frozen=True)
class _Places:
    """Points between which light is carried: place (2, N) in cells, surface, and size (N,) of a cell there."""

    place: Tensor
    surface: Surface
    pitch: Tensor

    def pick(self, index: Tensor) -> _Places:
        return _Places(self.place[:, index], self.surface.pick(index), self.pitch[index])


def _cell_lists(cell: Tensor, columns: int, rows: int, most: int) -> Tensor:
    """(rows, columns, most) anchors of every cell, -1 where there are fewer."""
    order = torch.argsort(cell, stable=True)
    count = torch.bincount(cell, minlength=columns * rows)
    rank = torch.arange(len(cell), device=cell.device) - (count.cumsum(0) - count)[cell[order]]
    lists = torch.full((columns * rows, most), -1, dtype=torch.int64, device=cell.device)
    keep = rank < most
    lists[cell[order][keep], rank[keep]] = order[keep]
    return lists.view(rows, columns, most)


def _spread(
    anchors: _Places, points: _Places, lists: Tensor, window: Sequence[int], nearest: int, width: float
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
    fit = (-((plane / points.pitch[:, None]) ** 2)).exp() * alike.clamp_min(0.0) ** 8
    weight = (fit + 1e-6) * (1.0 - apart.abs()).clamp_min(0.02 / width).prod(0)
    weight = torch.where(candidates >= 0, weight, 0.0)
    weight, best = weight.topk(min(nearest, weight.shape[1]), 1)
    weight = weight / weight.sum(1, keepdim=True).clamp_min(1e-20)
    to = torch.arange(len(index), device=index.device)[:, None].expand_as(best)
    shape = len(index), anchors.place.shape[1]
    return Spread(to.flatten(), index.gather(1, best).flatten(), weight.flatten(), shape)
