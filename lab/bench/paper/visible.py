# SPDX-License-Identifier: Apache-2.0
"""Visibility of the subject: in the frame, off its surroundings, neither a black hole nor a white one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from scipy import ndimage

from lab.bench.paper.finished import FinishedPicture
from proxy_renderer.color.tensors import ciede2000

_LEAST, _PLAIN = 3.0, 12.0
"""CIEDE2000 across an outline: hardly seen, plain to see."""

_CRUSHED, _BURNT = 4.0, 98.5
"""L* at which black and white show nothing any more."""


@dataclass(frozen=True)
class SubjectVisibility:
    """Each in [0, 1], 1 for good.

    Attributes:
        outline: How much of the outline stands out.
        detail: Whether the subject shows anything inside of its outline; 1 for a silhouette that was asked for.
        frame: Whether it is in the picture, whole, and of a size like before.
    """

    outline: float
    detail: float
    frame: float

    @property
    def whole(self) -> float:
        """The product of all three: each can hide the subject."""
        return self.outline * self.detail * self.frame


def visibility(after: FinishedPicture, before: FinishedPicture, silhouette: bool) -> SubjectVisibility:
    """Visibility of the subject.

    Args:
        before: The artist's, for what its frame was.
        silhouette: Whether a dark, even shape is what the words want.
    """
    return SubjectVisibility(_outline(after), 1.0 if silhouette else _detail(after), _frame(after, before))


def _outline(shot: FinishedPicture) -> float:
    """Mean over the outline of how plainly the two sides differ, each side averaged over a few pixels."""
    solid = shot.mask > 0.5
    if not solid.any() or solid.all():
        return 0.0
    reach = max(2, round(0.015 * max(solid.shape)))
    lab = shot.lab
    sides = []
    for side in (solid, ~solid):
        inside = ndimage.binary_erosion(side, border_value=1)
        inside = inside if inside.any() else side
        weight = ndimage.uniform_filter(inside.astype(float), 2 * reach + 1)
        sums = np.stack([ndimage.uniform_filter(lab[..., i] * inside, 2 * reach + 1) for i in range(3)], -1)
        sides.append((sums / np.maximum(weight, 1e-9)[..., None], weight > 1e-6))
    edge = solid & ~ndimage.binary_erosion(solid, border_value=1) & sides[0][1] & sides[1][1]
    if not edge.any():
        return 0.0
    apart = ciede2000(*(torch.from_numpy(mean[edge]) for mean, _ in sides)).numpy()
    return float(np.clip((apart - _LEAST) / (_PLAIN - _LEAST), 0, 1).mean()) ** 0.5


def _detail(shot: FinishedPicture) -> float:
    """Spread of light within the subject, less what is black or white without anything in it."""
    light = shot.lab[..., 0][shot.region("subject")]
    if not len(light):
        return 0.0
    low, high = np.quantile(light, [0.05, 0.95])
    lost = float(((light < _CRUSHED) | (light > _BURNT)).mean())
    return float(np.clip((high - low) / 10.0, 0.25, 1.0) * (1.0 - max(lost - 0.3, 0.0)))


def _frame(after: FinishedPicture, before: FinishedPicture) -> float:
    """Less for a subject that is cut off where it was not, or of another size by far."""
    cut = max(_cut(after) - _cut(before), 0.0)
    sizes = [float(shot.mask.mean()) for shot in (after, before)]
    ratio = min(sizes) / max(max(sizes), 1e-9)
    return float(max(1.0 - 4.0 * cut, 0.0) * np.clip(ratio / 0.3, 0, 1))


def _cut(shot: FinishedPicture) -> float:
    """The share of the subject's outline that is the picture's border instead."""
    solid = shot.mask > 0.5
    border = np.concatenate([solid[0], solid[-1], solid[1:-1, 0], solid[1:-1, -1]]).sum()
    outline = (solid & ~ndimage.binary_erosion(solid, border_value=0)).sum()
    return float(border / max(outline, 1))
