# SPDX-License-Identifier: Apache-2.0
"""Gradients of moving outlines, which point samples cannot have by themselves.

As in nvdiffrast (Laine et al. 2020, section 3.6), a pair of neighboring pixels with a near surface in
one and something farther in the other blends by where the outline passes between them. The picture
is antialiased already, so only the derivative is added: (a - a.detach()) * (near - far), zero in value.
The outline moves with the projection of the near surface's point; along the contour's normal this is
exact to first order, for creases as well as for smooth outlines.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from ..geometry.camera import View
from ..geometry.layers import last_of
from ..geometry.samples import Samples
from ..geometry.visibility import Surface

_WINDOW = 2  # pixels around a pair from which the contour's direction is estimated


@dataclass(frozen=True)
class Silhouettes:
    """All pairs of pixels that an outline separates.

    Attributes:
        pixel: (2, E) pixel with the near and with the far surface.
        sample: (2, E) a sample of the near surface in the one, of the far one in the other.
        points: (3, E) world positions on the near surface.
        motion: (2, E) what one pixel of the point's motion adds to the near surface's coverage.
    """

    pixel: Tensor
    sample: Tensor
    points: Tensor
    motion: Tensor

    @staticmethod
    def of(samples: Samples, surface: Surface) -> Silhouettes:
        """Finds the pairs among the samples of a view, whose first ones meet the surface."""
        width, height = samples.size
        depth = samples.center_hits.distance.view(height, width)
        owner = samples.owner.view(height, width)
        pairs = [_pairs(depth, owner, axis) for axis in (0, 1)]
        near, far = (torch.cat([p[i] for p in pairs]) for i in (0, 1))
        nearest, farthest = _extreme_samples(samples)
        sample = torch.stack((nearest[near], farthest[far]))
        keep = sample[0] < samples.surfaces
        near, far, sample = near[keep], far[keep], sample[:, keep]
        normal = _contour_normals(depth, near, far)
        step = torch.stack(((far % width) - (near % width), (far // width) - (near // width))).to(
            normal.dtype
        )
        motion = normal * (normal * step).sum(0).clamp_min(0.0)
        return Silhouettes(torch.stack((near, far)), sample, surface.position[:, sample[0]], motion)

    def term(self, view: View, values: Tensor, pixels: int) -> Tensor:
        """The zero-valued picture (C, P) whose gradient is that of the outlines.

        Args:
            values: (C, N) what the samples have.
        """
        place = view.project(self.points)
        moved = ((place - place.detach()) * self.motion).sum(0)
        values = values.detach()
        contrast = values[:, self.sample[0]] - values[:, self.sample[1]]
        share = contrast * (moved * 0.5)
        zero = torch.zeros((len(values), pixels), device=values.device)
        return zero.index_add(1, self.pixel[0], share).index_add(1, self.pixel[1], share)


def _pairs(depth: Tensor, owner: Tensor, axis: int) -> tuple[Tensor, Tensor]:
    """Near and far pixel (E,) of neighbors along an axis between which the object or the depth jumps."""
    n = depth.shape[axis] - 1
    index = torch.arange(depth.numel(), device=depth.device).view(depth.shape)
    a, b = depth.narrow(axis, 0, n), depth.narrow(axis, 1, n)
    i, j = index.narrow(axis, 0, n), index.narrow(axis, 1, n)
    low, high = torch.minimum(a, b), torch.maximum(a, b)
    # A smooth surface continues its slope over the neighbors; an outline does not.
    before = torch.minimum(_shifted(depth, axis, -1, n), a) / torch.maximum(_shifted(depth, axis, -1, n), a)
    after = torch.minimum(_shifted(depth, axis, 2, n), b) / torch.maximum(_shifted(depth, axis, 2, n), b)
    bent = torch.minimum(before.nan_to_num(1.0), after.nan_to_num(1.0))
    jump = (owner.narrow(axis, 0, n) != owner.narrow(axis, 1, n)) | (low < high * (0.985 * bent))
    jump &= low.isfinite()
    near = torch.where(a < b, i, j)[jump]
    far = torch.where(a < b, j, i)[jump]
    return near, far


def _shifted(depth: Tensor, axis: int, by: int, count: int) -> Tensor:
    index = (torch.arange(count, device=depth.device) + by).clamp(0, depth.shape[axis] - 1)
    return depth.index_select(axis, index)


def _extreme_samples(samples: Samples) -> tuple[Tensor, Tensor]:
    """For every pixel the index (P,) of its nearest and of its farthest sample."""
    order = torch.argsort(samples.hits.distance, descending=True, stable=True)
    pixels = len(samples.first)
    return last_of(samples.pixel, order, pixels), last_of(samples.pixel, order.flip(0), pixels)


def _contour_normals(depth: Tensor, near: Tensor, far: Tensor) -> Tensor:
    """Unit normals (2, E) of outlines in the picture, away from the near surface."""
    height, width = depth.shape
    flat = depth.flatten()
    edge = torch.minimum((flat[near] + flat[far]) / 2, flat[near] * 1.5)
    x, y = near % width, near // width
    total = torch.zeros((2, len(near)), device=depth.device)
    for dy in range(-_WINDOW, _WINDOW + 1):
        for dx in range(-_WINDOW, _WINDOW + 1):
            at = (y + dy).clamp(0, height - 1) * width + (x + dx).clamp(0, width - 1)
            sign = torch.where(flat[at] < edge, -1.0, 1.0)
            total[0] += sign * dx
            total[1] += sign * dy
    return total / total.norm(dim=0).clamp_min(1e-6)
