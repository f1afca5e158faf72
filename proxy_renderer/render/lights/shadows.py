# SPDX-License-Identifier: Apache-2.0
"""Soft shadows by a few rays per sample to points on a light, smoothed over smooth surfaces; many lights share rays in clusters.

With more than `EXACT` lights, the strongest are traced one by one, the others in clusters of lights that light the visible points
alike. A cluster needs as many shadow rays as one light, and one of its lights stands for all in bounced light (Walter et al.,
"Lightcuts", 2005). Which lights are alike is read from the matrix of unshadowed light that each sends to visible points (Hašan et
al., "Matrix row-column sampling for the many-light problem", 2007). Every light has its own unshadowed light and highlight.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import torch
from torch import Tensor

from ...color.tensors import luminance
from ..geometry.samples import Samples
from ..geometry.vectors import dot, overlap
from ..geometry.visibility import RayGeometry, Surface, sphere_points
from .light_source import DirectIrradiance, LightSource

EXACT = 16  # lights traced one by one; of more, the strongest EXACT // 2, the rest in EXACT // 2 clusters
_POINTS = 256
_K_MEANS_ROUNDS = 12
_MOST_RAYS = 4
_SHARP = 1e-3  # solid angle below which one ray is enough
_CLUSTER_RAYS = 4


@dataclass(frozen=True)
class LightCluster:
    """Lights that share their shadows."""

    members: tuple[int, ...]  # indices of the lights; the first, the strongest, stands for all
    powers: tuple[float, ...]  # irradiance that each sends per unit of its color, relative to the first


class LightClusters:
    """All lights of a view, each in one cluster; `row`: light's index -> its cluster's, the row in indirect light."""

    def __init__(self, clusters: Sequence[LightCluster]) -> None:
        self.clusters = tuple(clusters)
        self.row = {member: row for row, c in enumerate(self.clusters) for member in c.members}

    def __len__(self) -> int:
        return len(self.clusters)

    def hold(self, lamps: Sequence[LightSource]) -> bool:
        """True if these clusters fit the lights: there are as many lights, and those that move share no cluster."""
        alone = (len(self.clusters[self.row[i]].members) == 1 for i, lamp in enumerate(lamps) if lamp.moving)
        return len(lamps) == len(self.row) and all(alone)

    def sources(self, lamps: Sequence[LightSource]) -> list[LightSource]:
        """For each cluster, the light that stands for it, with the color that all its lights have together."""
        sources = []
        for cluster in self.clusters:
            first = lamps[cluster.members[0]]
            if len(cluster.members) > 1:
                colors = torch.stack([lamps[i].color for i in cluster.members])
                first = replace(first, color=colors.new_tensor(cluster.powers) @ colors)
            sources.append(first)
        return sources

    @staticmethod
    def of(lamps: Sequence[LightSource], moving: Sequence[bool], surface: Surface) -> LightClusters:
        """Clusters of lights that light a surface alike. Lights that move, the strongest, and few lights stay alone."""
        if len(lamps) <= EXACT or not len(surface.material):
            return LightClusters([LightCluster((i,), (1.0,)) for i in range(len(lamps))])
        some = surface.pick(torch.linspace(0, len(surface.material) - 1, _POINTS).long().to(surface.material.device))
        still = [lamp.detached() for lamp in lamps]
        sent = torch.stack([lamp.irradiance(some.position, some.normal).irradiance for lamp in still])
        colors = torch.stack([lamp.color.detach() for lamp in lamps])
        matrix = (sent[:, :, None] * colors[:, None]).flatten(1)  # (L, 3 P)
        strength = matrix.norm(dim=1)
        order = strength.argsort(descending=True).tolist()
        # A light without shadows, or with objects that it does not light, joins no cluster.
        may_join = [x.light.shadow and not x.light.unlit for x in lamps]
        shared = [i for i in order if may_join[i] and not moving[i]][EXACT // 2 :]
        groups = [(i,) for i in order if i not in set(shared)]
        if shared:
            unit = matrix[shared] / strength[shared].clamp_min(1e-20)[:, None]
            labels = k_means(unit.T, min(EXACT // 2, len(shared))).tolist()
            for label in sorted(set(labels)):
                groups.append(tuple(i for i, k in zip(shared, labels, strict=True) if k == label))
        mean = sent.mean(1).clamp_min(1e-20)
        return LightClusters([LightCluster(g, tuple((mean[list(g)] / mean[g[0]]).tolist())) for g in groups])


def k_means(points: Tensor, count: int) -> Tensor:
    """Cluster number (P,), below `count`, of each of P points (D, P); deterministic, starts from centers far apart."""
    centers = points[:, :1]
    for _ in range(count - 1):
        away = torch.cdist(points.T, centers.T).amin(1)
        centers = torch.cat((centers, points[:, away.argmax()][:, None]), 1)
    label = torch.zeros(points.shape[1], dtype=torch.int64, device=points.device)
    for _ in range(_K_MEANS_ROUNDS if count > 1 else 0):
        label = torch.cdist(points.T, centers.T).argmin(1)
        member = torch.nn.functional.one_hot(label, count).to(points.dtype)
        centers = (points @ member) / member.sum(0).clamp_min(1.0)
    return label


def shadow(
    geometry: RayGeometry, smoothing: ShadowFilter, lamp: LightSource, direct: DirectIrradiance, moving: bool
) -> Tensor:
    """Share (N,) of a light that each surface sample sees; a large light that is `moving` in a loop gets fewer rays."""
    surface = smoothing.surface
    linked = lamp.lights(surface.object)
    if not lamp.light.shadow:
        return linked.to(torch.float32)
    count = len(surface.material)
    solid = float(direct.solid_angle.max()) if count else 0.0
    rays = 1 if solid < _SHARP else (2 if moving else _MOST_RAYS)
    facing, reached = dot(surface.facet, direct.toward) > 0, direct.frontal > 0
    # Outside a spot's cone, samples count as unshadowed: else smoothing would darken the cone's rim.
    visible = (facing & ~reached).to(torch.float32)
    index = (facing & reached & linked).nonzero()[:, 0]
    origin = geometry.lifted(surface)[:, index]
    spots = sphere_points(rays, count, torch.Generator().manual_seed(11)).to(visible.device)[:, index]
    part = direct.pick(index)
    total = torch.zeros(len(index), device=visible.device)
    for k in range(rays):
        toward, distance = lamp.shadow_targets(part, spots[:, :, k])
        total += geometry.clear(origin, toward, distance * (1 - 1e-4), lamp.shadowless)
    visible[index] = total / rays
    return smoothing(visible, radius=1 if rays == 1 else 2) * linked


class ShadowFilter:
    """A cross-bilateral box filter, which averages shadows of neighbors on a smooth surface; built once per view."""

    def __init__(self, samples: Samples, surface: Surface) -> None:
        self.surface = surface
        width, height = samples.size
        first, n = samples.first, samples.surfaces
        self._size, self._inside = (height, width), first < n
        self._chosen = chosen = first[self._inside]
        self._plain = chosen[samples.weight[chosen] > 0.999]
        self._plain_pixel = samples.pixel[self._plain]
        fields = torch.cat((surface.normal, samples.hits.distance[None, :n]))
        grid = torch.zeros((4, width * height), device=fields.device)
        grid[:, self._inside] = fields[:, chosen]
        self._grid = grid.view(4, height, width)
        self._neighbors: dict[int, tuple[list[tuple[Any, Any, Tensor]], Tensor]] = {}  # by radius, see `_alike`

    def __call__(self, visible: Tensor, radius: int) -> Tensor:
        """The shares `visible` (N,), averaged over `radius` pixels to each side; samples of edges stay as they are."""
        value = torch.zeros(self._inside.shape, device=visible.device)
        value[self._inside] = visible[self._chosen]
        value = value.view(self._size)
        if radius not in self._neighbors:
            self._neighbors[radius] = self._alike(radius)
        neighbors, weight = self._neighbors[radius]
        total = value.clone()
        for to, of, alike in neighbors:
            total[to] += value[of] * alike
        smooth = visible.clone()
        smooth[self._plain] = (total / weight).flatten()[self._plain_pixel]
        return smooth

    def _alike(self, radius: int) -> tuple[list[tuple[Any, Any, Tensor]], Tensor]:
        """Neighbors on the same smooth surface, one tuple for each offset, and how many pixels (H, W) are averaged.

        A tuple has slices of the pixels, slices of their neighbors, and (h, w) bool: both on one smooth surface.
        """
        neighbors, weight = [], torch.ones(self._size, device=self._grid.device)
        for dy, dx in itertools.product(range(-radius, radius + 1), repeat=2):
            if dy or dx:
                to, of = zip(*map(overlap, (dy, dx), self._size), strict=True)
                there, other = self._grid[:, *to], self._grid[:, *of]
                most = 8.0 * math.hypot(dx, dy) / max(self._size)
                alike = (dot(there[:3], other[:3]) > 0.95) & ((there[3] - other[3]).abs() < there[3] * most)
                weight[to] += alike
                neighbors.append((to, of, alike))
        return neighbors, weight


def cluster_shadow(
    geometry: RayGeometry, smoothing: ShadowFilter, cluster: LightCluster, lamps: Sequence[LightSource]
) -> Tensor:
    """Share (N,) of the total light of a cluster that each surface sample sees.

    A sample has a few rays, each to a light that is drawn with a chance proportional to its light on visible points, plus a tenth
    of the mean. The light along these rays is summed over neighbors on the same smooth surface, with and without shadows. The
    share is the ratio of the two sums. All these lights must cast shadows, and light all objects.
    """
    members = [lamps[i].detached() for i in cluster.members]
    bright = luminance(torch.stack([lamp.color for lamp in members]))[:, 0]
    power = (bright * bright.new_tensor(cluster.powers)).clamp_min(0.0)
    weights = power + 0.1 * power.mean() + 1e-12
    chance = weights / weights.sum()
    surface, device = smoothing.surface, chance.device
    count = len(surface.material)
    generator = torch.Generator().manual_seed(12)
    strata = (torch.arange(_CLUSTER_RAYS) + torch.rand((count, _CLUSTER_RAYS), generator=generator)) / _CLUSTER_RAYS
    chosen = torch.searchsorted(chance.cumsum(0), strata.to(device)).clamp_max(len(members) - 1)
    spots = sphere_points(_CLUSTER_RAYS, count, generator).to(device)
    seen, whole = torch.zeros((2, count), device=device)
    for number, lamp in enumerate(members):
        sample, ray = (chosen == number).nonzero().T
        part = surface.pick(sample)
        direct = lamp.irradiance(part.position, part.normal)
        brought = direct.irradiance * luminance(lamp.color) / chance[number]
        index = (brought > 0).nonzero()[:, 0]
        sample, ray, brought = sample[index], ray[index], brought[index]
        part, direct = part.pick(index), direct.pick(index)
        toward, distance = lamp.shadow_targets(direct, spots[:, sample, ray])
        clear = geometry.clear(geometry.lifted(part), toward, distance * (1 - 1e-4), lamp.shadowless)
        facing = dot(part.facet, direct.toward) > 0
        whole.index_add_(0, sample, brought)
        seen.index_add_(0, sample, brought * clear * facing)
    seen, whole = smoothing(seen, radius=2), smoothing(whole, radius=2)
    return torch.where(whole > 0, seen / whole.clamp_min(1e-20), 1.0)
