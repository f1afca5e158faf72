# SPDX-License-Identifier: Apache-2.0
"""Soft shadows: a few rays per sample to points on the lamp, smoothed where the surface is smooth; of many lights in clusters.

The strongest lights are traced each, the others in clusters of such that light the visible points alike. A cluster shares
shadow rays, as many as for one light, and one of its lights stands for all of them in bounced light (Walter et al.,
"Lightcuts", 2005). Which lights are alike is read from the matrix of what each sends to visible points, unshadowed (Hašan et
al., "Matrix row-column sampling for the many-light problem", 2007). What each sends directly, and its highlight, stay its own.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import torch
from torch import Tensor

from ...color.tensors import luminance
from ..geometry.samples import Samples
from ..geometry.vectors import dot, overlap
from ..geometry.visibility import RayGeometry, Surface, sphere_points
from .light_source import DirectIrradiance, LightSource

EXACT = 16  # so many lights are traced each: half the strongest and as many clusters, where there are more
_POINTS = 256
_K_MEANS_ROUNDS = 12


@dataclass(frozen=True)
class LightCluster:
    """Lights that share their shadows."""

    members: tuple[int, ...]  # their indices, the strongest first, which stands for all
    powers: tuple[float, ...]  # what each sends per unit of its color, relative to the first


class LightClusters:
    """All lights of a view, each in one cluster; a cluster's index is its row of indirect light, `row` has each light's."""

    def __init__(self, clusters: Sequence[LightCluster]) -> None:
        self.clusters = tuple(clusters)
        self.row = {member: row for row, c in enumerate(self.clusters) for member in c.members}

    def __len__(self) -> int:
        return len(self.clusters)

    def hold(self, lamps: Sequence[LightSource]) -> bool:
        """True if they are of as many lights, and none that moves shares its shadows with others."""
        alone = (len(self.clusters[self.row[i]].members) == 1 for i, lamp in enumerate(lamps) if lamp.moving)
        return len(lamps) == len(self.row) and all(alone)

    def sources(self, lamps: Sequence[LightSource]) -> list[LightSource]:
        """The light that stands for each cluster, in the color of all."""
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
        """Clusters lights by what they send to a surface; few of them, and those that move, stay alone."""
        if len(lamps) <= EXACT or not len(surface.material):
            return LightClusters([LightCluster((i,), (1.0,)) for i in range(len(lamps))])
        chosen = torch.linspace(0, len(surface.material) - 1, _POINTS).long()
        some = surface.pick(chosen.to(surface.material.device))
        still = [lamp.detached() for lamp in lamps]
        sent = torch.stack([lamp.irradiance(some.position, some.normal).irradiance for lamp in still])
        colors = torch.stack([lamp.color.detach() for lamp in lamps])
        matrix = (sent[:, :, None] * colors[:, None]).flatten(1)  # (L, 3 P)
        strength = matrix.norm(dim=1)
        order = strength.argsort(descending=True).tolist()
        # A light that lights some objects only has shadows of its own, and joins no other.
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


def weights(cluster: LightCluster, lamps: Sequence[LightSource]) -> Tensor:
    """Relative number (C,) of shadow rays to each member: by its light on visible points, above 0 for all."""
    bright = luminance(torch.stack([lamps[i].color.detach() for i in cluster.members]))[:, 0]
    power = (bright * bright.new_tensor(cluster.powers)).clamp_min(0.0)
    return power + 0.1 * power.mean() + 1e-12


def k_means(points: Tensor, count: int) -> Tensor:
    """The cluster (P,) of each point of (D, P), the same every time; at most `count`, which start far from each other."""
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


_MOST_RAYS = 4
_SHARP = 1e-3  # solid angle below which one ray is enough
_CLUSTER_RAYS = 4


def shadow(
    geometry: RayGeometry, smoothing: ShadowFilter, lamp: LightSource, direct: DirectIrradiance, moving: bool
) -> Tensor:
    """Share (N,) of a lamp that every surface sample sees; a gradient loop that moves it gets fewer rays, more smoothing."""
    surface = smoothing.surface
    linked = lamp.lights(surface.object)
    if not lamp.light.shadow:
        return linked.to(torch.float32)
    count = len(surface.material)
    solid = float(direct.solid_angle.max()) if count else 0.0
    rays = 1 if solid < _SHARP else (2 if moving else _MOST_RAYS)
    facing, reached = dot(surface.facet, direct.toward) > 0, direct.frontal > 0
    # Out of a spot's cone nothing is in shadow: smoothing would carry that over the cone's rim.
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
    """A cross-bilateral box filter over the picture: neighbors on the same smooth surface, kept for the view, share rays."""

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
        self._same: dict[tuple[int, int], Tensor] = {}
        self._weight: dict[int, Tensor] = {}

    def __call__(self, visible: Tensor, radius: int) -> Tensor:
        """The shares (N,) averaged over so many pixels to each side; samples of edges stay as they are."""
        value = torch.zeros(self._inside.shape, device=visible.device)
        value[self._inside] = visible[self._chosen]
        value = value.view(self._size)
        total = value.clone()
        for step in _steps(radius):
            to, of = self._shifted(*step)
            total[to] += value[of] * self._alike(*step)
        if radius not in self._weight:  # how many pixels (H, W) are averaged
            weight = self._weight[radius] = torch.ones(self._size, device=self._grid.device)
            for step in _steps(radius):
                weight[self._shifted(*step)[0]] += self._alike(*step)
        smooth = visible.clone()
        smooth[self._plain] = (total / self._weight[radius]).flatten()[self._plain_pixel]
        return smooth

    def _alike(self, dy: int, dx: int) -> Tensor:
        """(h, w) bool: pixels, those at the border aside, whose neighbor shares rays with them."""
        if (dy, dx) not in self._same:
            to, of = self._shifted(dy, dx)
            normal, depth = self._grid[:3], self._grid[3]
            alike = dot(normal[:, to[0], to[1]], normal[:, of[0], of[1]]) > 0.95
            most = 8.0 * math.hypot(dx, dy) / max(self._size)
            self._same[dy, dx] = alike & ((depth[to] - depth[of]).abs() < depth[to] * most)
        return self._same[dy, dx]

    def _shifted(self, dy: int, dx: int) -> tuple[tuple[slice, slice], tuple[slice, slice]]:
        """The pixels that have a neighbor at an offset, and these neighbors."""
        (rows, of_rows), (columns, of_columns) = map(overlap, (dy, dx), self._size)
        return (rows, columns), (of_rows, of_columns)


def _steps(radius: int) -> list[tuple[int, int]]:
    side = range(-radius, radius + 1)
    return [(dy, dx) for dy in side for dx in side if dx or dy]


def cluster_shadow(
    geometry: RayGeometry, smoothing: ShadowFilter, lamps: Sequence[LightSource], weights: Tensor
) -> Tensor:
    """Share (N,) of the light of several lamps together that every surface sample sees.

    A few rays go to as many of the lamps, chosen by their weights (C,) > 0. Their light is summed over neighbors on the
    same smooth surface, with and without shadows: the ratio of the two sums. All lamps cast shadows, and light all objects.
    """
    surface, device = smoothing.surface, weights.device
    count = len(surface.material)
    chance = weights / weights.sum()
    generator = torch.Generator().manual_seed(12)
    jitter = torch.rand((count, _CLUSTER_RAYS), generator=generator)
    strata = (torch.arange(_CLUSTER_RAYS) + jitter) / _CLUSTER_RAYS
    chosen = torch.searchsorted(chance.cumsum(0), strata.to(device)).clamp_max(len(lamps) - 1)
    spots = sphere_points(_CLUSTER_RAYS, count, generator).to(device)
    seen, whole = torch.zeros((2, count), device=device)
    for number, lamp in enumerate(lamps):
        sample, ray = (chosen == number).nonzero().T
        part = surface.pick(sample)
        direct = lamp.irradiance(part.position, part.normal)
        brought = direct.irradiance * luminance(lamp.color) / chance[number]
        index = (brought > 0).nonzero()[:, 0]
        sample, ray, part, brought = sample[index], ray[index], part.pick(index), brought[index]
        direct = direct.pick(index)
        toward, distance = lamp.shadow_targets(direct, spots[:, sample, ray])
        clear = geometry.clear(geometry.lifted(part), toward, distance * (1 - 1e-4), lamp.shadowless)
        facing = dot(part.facet, direct.toward) > 0
        whole.index_add_(0, sample, brought)
        seen.index_add_(0, sample, brought * clear * facing)
    seen, whole = smoothing(seen, radius=2), smoothing(whole, radius=2)
    return torch.where(whole > 0, seen / whole.clamp_min(1e-20), 1.0)
