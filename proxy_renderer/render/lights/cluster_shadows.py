# SPDX-License-Identifier: Apache-2.0
"""The shadows of lights in clusters: as many rays for all of a cluster as for one light."""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import Tensor

from ...color.tensors import luminance
from ..geometry.vectors import dot
from ..geometry.visibility import RayGeometry, Surface, sphere_points
from .clusters import LightClusters, weights
from .shadows import ShadowFilter
from .types.light_source import LightSource

_RAYS = 4


class ClusterShadows:
    """Shadows of the clusters, traced again where one of their lights has moved."""

    def __init__(
        self, geometry: RayGeometry, smoothing: ShadowFilter, surface: Surface, clusters: LightClusters
    ) -> None:
        self._view, self._clusters = (geometry, smoothing, surface), clusters
        self._kept: dict[int, tuple[tuple[float, ...], Tensor]] = {}

    def of(self, row: int, lamps: Sequence[LightSource], signature: tuple[float, ...]) -> Tensor:
        """Share (N,) of a cluster's light that every surface sample sees."""
        kept = self._kept.get(row)
        if kept is None or kept[0] != signature:
            cluster = self._clusters.clusters[row]
            members = [lamps[i].detached() for i in cluster.members]
            kept = self._kept[row] = signature, _shadow(*self._view, members, weights(cluster, lamps))
        return kept[1]


def _shadow(
    geometry: RayGeometry,
    smoothing: ShadowFilter,
    surface: Surface,
    lamps: Sequence[LightSource],
    weights: Tensor,
) -> Tensor:
    """Share (N,) of the light of several lamps together that every surface sample sees.

    A few rays go to as many of the lamps, chosen by their weights. What they would bring is summed over neighbors on the same
    smooth surface, with and without shadows: the ratio of the two sums.

    Args:
        lamps: The lamps, detached; all cast shadows, and light all things.
        weights: (C,) positive: how often rays go to each lamp.
    """
    count, device = len(surface.material), weights.device
    chance = weights / weights.sum()
    generator = torch.Generator().manual_seed(12)
    strata = (torch.arange(_RAYS) + torch.rand((count, _RAYS), generator=generator)) / _RAYS
    chosen = torch.searchsorted(chance.cumsum(0), strata.to(device)).clamp_max(len(lamps) - 1)
    spots = sphere_points(_RAYS, count, generator).to(device)
    seen, whole = torch.zeros((2, count), device=device)
    for number, lamp in enumerate(lamps):
        sample, ray = (chosen == number).nonzero().T
        part = surface.pick(sample)
        direct = lamp.irradiance(part.position, part.normal)
        brought = direct.irradiance * luminance(lamp.color) / chance[number]
        lit = (brought > 0).nonzero()[:, 0]
        sample, ray, part, brought = sample[lit], ray[lit], part.pick(lit), brought[lit]
        ways = direct.toward[:, lit], direct.distance[lit], direct.solid_angle[lit]
        toward, distance = lamp.shadow_targets(*ways, spots[:, sample, ray])
        clear = geometry.clear(geometry.lifted(part), toward, distance * (1 - 1e-4), lamp.shadowless)
        facing = dot(part.facet, direct.toward[:, lit]) > 0
        whole.index_add_(0, sample, brought)
        seen.index_add_(0, sample, brought * clear * facing)
    seen, whole = smoothing(seen, radius=2), smoothing(whole, radius=2)
    return torch.where(whole > 0, seen / whole.clamp_min(1e-20), 1.0)
