# SPDX-License-Identifier: Apache-2.0
"""Many lights: the strongest are traced each, the others in clusters of such that light the visible points alike.

A cluster shares shadow rays, and one of its lights stands for all of them in bounced light (Walter et al., "Lightcuts", 2005).
Which lights are alike is read from the matrix of what each sends to visible points, unshadowed (Hašan et al., "Matrix
row-column sampling for the many-light problem", 2007). What each sends directly, and its highlight, stay its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import torch
from torch import Tensor

from ...color.tensors import luminance
from ..geometry.visibility import Surface
from .light_source import LightSource

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
