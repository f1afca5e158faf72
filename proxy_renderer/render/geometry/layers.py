# SPDX-License-Identifier: Apache-2.0
"""The camera's rays, followed through transparent surfaces to what they end on."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from .camera import View
from .visibility import Hits, RayGeometry

_FAINT = 0.004
"""Share of a ray below which it is not followed, and a hit does not count."""
_MOST_LAYERS = 8


@dataclass(frozen=True)
class HitLayers:
    """What rays pass through and end on, nearest first.

    Attributes:
        ray: (N,) index of the ray.
        number: (N,) how many surfaces it has met before.
        hits: (N,) what it meets there.
        weight: (N,) the share of the ray that is seen there; the shares of a ray sum to 1.
    """

    ray: Tensor
    number: Tensor
    hits: Hits
    weight: Tensor

    def strongest(self, count: int) -> Hits:
        """For every ray (count,) the hit that it shows most of."""
        return self.hits.pick(last_of(self.ray, torch.argsort(self.weight, stable=True), count))

    def nearest(self, count: int) -> Hits:
        """For every ray (count,) the first hit that counts."""
        index = torch.arange(len(self.ray), device=self.ray.device).flip(0)
        return self.hits.pick(last_of(self.ray, index, count))


def follow(geometry: RayGeometry, view: View, origin: Tensor, toward: Tensor) -> HitLayers:
    """Follows the camera's rays (3, N) from its near to its far plane, through transparent surfaces."""
    index = torch.arange(origin.shape[1], device=geometry.device)
    left = torch.ones(len(index), device=geometry.device)
    near, far = view.span(toward)
    hits = geometry.nearest(origin + toward * near, toward, "camera")
    hits = _before(far, Hits(hits.triangle, hits.u, hits.v, hits.distance + near))
    if geometry.opacity is None:
        return HitLayers(index, torch.zeros_like(index), hits, left)
    collected: list[tuple[Tensor, Hits, Tensor]] = []
    for number in range(_MOST_LAYERS):
        alpha = geometry.opacity.at(geometry.surface(hits, toward[:, index]), by_camera=number == 0)
        alpha = torch.where(hits.hit, alpha, 1.0)
        rest = left * (1 - alpha)
        ends = (rest < _FAINT) | (number == _MOST_LAYERS - 1)
        share = torch.where(ends, left, left * alpha)
        counts = share >= _FAINT
        collected.append((index[counts], hits.pick(counts), share[counts]))
        # What is too faint to count is given to what comes after it.
        rest = torch.where(counts, rest, left)
        onward = ~ends
        if not bool(onward.any()):
            break
        index, left = index[onward], rest[onward]
        further = geometry.onward(hits.pick(onward), origin[:, index], toward[:, index], "camera")
        hits = _before(far[index], further)
    numbers = [torch.full_like(rays, i) for i, (rays, _, _) in enumerate(collected)]
    rays, met, shares = zip(*collected, strict=True)
    merged = Hits(*(torch.cat(p) for p in zip(*(h.parts for h in met), strict=True)))
    return HitLayers(torch.cat(rays), torch.cat(numbers), merged, torch.cat(shares))


def _before(far: Tensor, hits: Hits) -> Hits:
    """Hits (N,) with those beyond distances (N,) turned into misses."""
    inside = hits.distance <= far
    distance = torch.where(inside, hits.distance, torch.inf)
    return Hits(torch.where(inside, hits.triangle, -1), hits.u, hits.v, distance)


def last_of(group: Tensor, order: Tensor, count: int) -> Tensor:
    """The member (count,) of every group that comes last in an order.

    Args:
        group: (N,) int64 in [0, count); every group must have a member.
        order: (N,) a permutation of the N members.
    """
    rank = torch.arange(len(order), device=order.device)
    last = torch.zeros(count, dtype=torch.int64, device=order.device)
    # Not by assignment: which of several writes to one place wins is not defined.
    return order[last.scatter_reduce(0, group[order], rank, "amax")]
