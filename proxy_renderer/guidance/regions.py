# SPDX-License-Identifier: Apache-2.0
"""The subject without its surroundings, and the reverse (equation 8): one region, one phrase."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from . import augment

_EVERY_PLAIN = 2
"""Step between the views of a subject that stand on the mean color of its surroundings; the first one does."""


@dataclass(frozen=True)
class Views:
    """How many views of each region a step looks at."""

    subject: int = 3
    surroundings: int = 2
    whole: int = 3


def mean(values: Tensor, mask: Tensor) -> Tensor:
    """Mean over a region.

    Args:
        values: (H, W, C).
        mask: (H, W) soft membership of the region; all 0 gives 0.

    Returns:
        (C,).
    """
    weight = mask[..., None]
    return (values * weight).sum((0, 1)) / weight.sum((0, 1)).clamp_min(1e-6)


def subject_views(display: Tensor, mask: Tensor, count: int, generator: torch.Generator, size: int) -> Tensor:
    """I ⊙ M, framed by the subject, each view on another plain background.

    Half of the backgrounds are random colors, so that nothing can be said about the subject by
    changing what is behind it (CLIP-Mesh); the others are the mean color of the surroundings, so
    that it is judged in the light that it stands in.

    Args:
        display: (H, W, 3) in [0, 1].
        mask: (H, W) soft subject coverage.
        size: Side of the views, pixels.

    Returns:
        (count, 3, size, size), differentiable in picture and mask.
    """
    box = _frame(mask)
    display, mask = display[box], mask[box]
    backgrounds = torch.rand(count, 3, generator=generator).to(display)
    backgrounds[::_EVERY_PLAIN] = mean(display, 1.0 - mask).detach()
    layers = torch.cat([display * mask[..., None], mask[..., None]], -1).permute(2, 0, 1)[None]
    cut = augment.warp(layers, augment.keeping(mask, count, generator), size)
    return cut[:, :3] + (1.0 - cut[:, 3:]) * backgrounds[:, :, None, None]


def surroundings_views(
    display: Tensor, mask: Tensor, count: int, generator: torch.Generator, size: int
) -> Tensor:
    """I ⊙ (1 − M), the hole filled with the mean color of what remains.

    Args:
        display: As for `subject_views`.
        mask: As for `subject_views`.
        count: As for `subject_views`.
        generator: As for `subject_views`.
        size: As for `subject_views`.

    Returns:
        (count, 3, size, size), differentiable in picture and mask.
    """
    rest = (1.0 - mask)[..., None]
    filled = display * rest + mask[..., None] * mean(display, 1.0 - mask)
    corners = augment.keeping(1.0 - mask, count, generator)
    return augment.warp(filled.permute(2, 0, 1)[None], corners, size)


def whole_views(display: Tensor, count: int, generator: torch.Generator, size: int) -> Tensor:
    """The full frame first, then count - 1 random large crops of it: (count, 3, size, size).

    Args:
        display: (H, W, 3) in [0, 1].
        count: How many views, at least 1.
        size: Side of the views, pixels.
    """
    picture = display.permute(2, 0, 1)[None]
    full = augment.whole(picture, size)
    if count == 1:
        return full
    return torch.cat([full, augment.warp(picture, augment.quads(count - 1, generator), size)])


def _frame(mask: Tensor, margin: float = 0.15) -> tuple[slice, slice]:
    """The square-ish window around the subject, with some room; the whole picture if it is empty."""
    solid = mask.detach() > 0.5
    rows, columns = solid.any(1).nonzero(), solid.any(0).nonzero()
    if not len(rows):
        return slice(None), slice(None)
    center = [(int(axis[0]) + int(axis[-1]) + 1) / 2 for axis in (rows, columns)]
    half = max(int(axis[-1]) - int(axis[0]) + 1 for axis in (rows, columns)) * (0.5 + margin)
    low = [max(int(c - half), 0) for c in center]
    high = [min(int(c + half) + 1, n) for c, n in zip(center, mask.shape, strict=True)]
    return slice(low[0], high[0]), slice(low[1], high[1])
