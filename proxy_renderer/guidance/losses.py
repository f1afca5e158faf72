# SPDX-License-Identifier: Apache-2.0
"""The terms of the objective: the paper's (equations 3 and 4), and what keeps similarity honest.

Similarity alone can be satisfied by pictures that a person would not call the prompt. So measured
terms stand beside it: colors that the words name, and whether the subject can be seen at all.
"""

from __future__ import annotations

import torch
import torch.nn.functional as F
from torch import Tensor

_FEW = 10  # pixels that say nothing of a subject
_CLOSE = 6.0  # a Lab distance that still is the named color


def positive_loss(features: Tensor, text: Tensor) -> Tensor:
    """Equation 3: 1 − s(I, p), mean over views.

    Args:
        features: (views, D) unit features of views of a picture.
        text: (1, D) unit features of a phrase.

    Returns:
        A scalar in [0, 2].
    """
    return 1.0 - (features @ text.T).mean()


def negative_loss(features: Tensor, texts: Tensor, margin: float) -> Tensor:
    """Equation 4: max(0, s(I, p⁻) − m), mean over views, of the phrase that fits most.

    Args:
        features: (views, D) unit features of views of a picture.
        texts: (phrases, D) unit features of what it must not look like.
        margin: m, the similarity that is allowed.
    """
    return F.relu((features @ texts.T).mean(0) - margin).max()


def direction_loss(
    features: Tensor, start: Tensor, text: Tensor, plain: Tensor, least: float = 0.1
) -> Tensor:
    """1 − cos(ΔI, ΔT): the picture should change in the direction in which the words differ from a plain caption.

    What makes the picture like the words by making it unlike any picture goes another way (StyleGAN-NADA).

    Args:
        features: (views, D) unit features of the picture.
        start: (D,) mean unit features of the starting picture.
        text: (1, D) unit features of the words.
        plain: (1, D) unit features of a caption without any look.
        least: Length of ΔI below which its direction says little.
    """
    moved = features.mean(0) - start
    length = (moved.square().sum() + 1e-8).sqrt()
    return 1.0 - (moved @ F.normalize(text - plain, dim=1)[0]) / (length + least)


def border_loss(mask: Tensor) -> Tensor:
    """Mean subject coverage (H, W) along the picture's border: a subject should not be cut off."""
    edges = torch.cat([mask[0], mask[-1], mask[1:-1, 0], mask[1:-1, -1]])
    return edges.mean()


def claims_loss(residuals: list[Tensor]) -> Tensor:
    """Sum over claims of how far each is missed, quadratic up to one noticeable step and linear beyond (Huber 1964).

    Args:
        residuals: Of each claim, (n,) in steps that people notice.
    """
    missed = torch.stack([(r.square().sum() + 1e-8).sqrt() for r in residuals])
    return F.huber_loss(missed, torch.zeros_like(missed), reduction="sum")


def hue_consistency_loss(where: Tensor, colors: Tensor, weights: Tensor) -> Tensor:
    """Keeps a color's hue: its components should stand at the same place in their ranges.

    A range is a box around the named color; its corners are other hues.

    Args:
        where: (N,) position of each component within its feasible range, in [0, 1].
        colors: (M, 3) indices of the components of each color.
        weights: (N,) how much it counts; 0 for components that are fixed.
    """
    place, weight = where[colors], weights[colors]
    middle = (place * weight).sum(1, keepdim=True) / weight.sum(1, keepdim=True).clamp_min(1.0)
    return (weight * (place - middle).square()).sum()


def prior_loss(where: Tensor, home: Tensor, weight: Tensor) -> Tensor:
    """Pull to the artist's values of what no word names.

    Args:
        where: (N,) position of each component within its feasible range, in [0, 1].
        home: (N,) position of the artist's value, likewise.
        weight: (N,) in [0, 1], 0 for components that words name.
    """
    return (weight * (where - home).square()).sum()
