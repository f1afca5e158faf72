# SPDX-License-Identifier: Apache-2.0
"""k-means clustering that gives the same clusters every time."""

from __future__ import annotations

import torch
from torch import Tensor

_ROUNDS = 12


def k_means(points: Tensor, count: int) -> Tensor:
    """The cluster (P,) of each point.

    Args:
        points: (D, P).
        count: How many clusters at most. They start at points that are far from each other.
    """
    centers = points[:, :1]
    for _ in range(count - 1):
        away = torch.cdist(points.T, centers.T).amin(1)
        centers = torch.cat((centers, points[:, away.argmax()][:, None]), 1)
    label = torch.zeros(points.shape[1], dtype=torch.int64, device=points.device)
    for _ in range(_ROUNDS if count > 1 else 0):
        label = torch.cdist(points.T, centers.T).argmin(1)
        member = torch.nn.functional.one_hot(label, count).to(points.dtype)
        centers = (points @ member) / member.sum(0).clamp_min(1.0)
    return label
