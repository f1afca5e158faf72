# SPDX-License-Identifier: Apache-2.0
"""The terms of the objective: the paper's (equations 3 and 4), and what keeps similarity honest.

Similarity alone can be satisfied by pictures that a person would not call the prompt. So measured
terms stand beside it: colors that the words name, and whether the subject can be seen at all.
"""

from __future__ import annotations

import torch
import torch.nn.functional as F
from torch import Tensor

from . import regions

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


def color_loss(lab: Tensor, mask: Tensor, target: tuple[float, float, float]) -> Tensor:
    """How far a region's mean color is from a named one, 1 being opposite; 0 within a small distance.

    Args:
        lab: (H, W, 3).
        mask: (H, W) membership of the region.
        target: Lab.
    """
    difference = regions.mean(lab, mask) - lab.new_tensor(target)
    return F.relu((difference.square().sum() + 1e-6).sqrt() - _CLOSE) / 100.0


def border_loss(mask: Tensor) -> Tensor:
    """Mean subject coverage (H, W) along the picture's border: a subject should not be cut off."""
    edges = torch.cat([mask[0], mask[-1], mask[1:-1, 0], mask[1:-1, -1]])
    return edges.mean()


def visibility_loss(
    lab: Tensor, mask: Tensor, contrast: float = 15.0, light: float = 38.0, burnt: float = 94.0
) -> Tensor:
    """0 when a subject can be seen, growing to about 1 when it cannot.

    It must differ from what is right around it, either of the two must have light, and it must not
    be burnt out. A silhouette passes, and so does a lit subject in the dark.

    Args:
        lab: (H, W, 3) display picture.
        mask: (H, W) subject coverage.
        contrast: Least Lab distance between the subject and the ring around it.
        light: Least lightness L* of the brighter of the two.
        burnt: Greatest mean lightness of the subject.
    """
    if float(mask.detach().sum()) < 1.0:
        return lab.new_zeros(())
    width = 2 * max(min(mask.shape) // 16, 1) + 1
    grown = F.max_pool2d(mask[None, None], width, stride=1, padding=width // 2)[0, 0]
    inside = regions.mean(lab, mask)
    around = regions.mean(lab, (grown - mask).clamp_min(0.0).detach())
    distance = ((inside - around).square().sum() + 1e-6).sqrt()
    brighter = torch.maximum(inside[0], around[0])
    return (
        F.relu(1.0 - distance / contrast)
        + F.relu(1.0 - brighter / light)
        + F.relu(inside[0] - burnt) / (100.0 - burnt)
    )


def form_loss(lab: Tensor, mask: Tensor, least: float = 18.0) -> Tensor:
    """0 when the best-lit tenth of the subject has this lightness L*, 1 when all of it is black.

    A black thing that shows no shading at all is a hole in the picture.

    Args:
        lab: (H, W, 3) display picture.
        mask: (H, W) subject coverage.
        least: Mean lightness of that tenth.
    """
    inside = _lightness_inside(lab, mask)
    if len(inside) < _FEW:
        return lab.new_zeros(())
    return F.relu(1.0 - inside.topk(len(inside) // 10).values.mean() / least)


def shading_contrast_loss(lab: Tensor, mask: Tensor, least: float = 6.0) -> Tensor:
    """0 when the subject's lightness varies this much over its shape, 1 when it is one flat patch.

    Light from everywhere follows many words, "white", "bright" and "soft" among them, and shows no shape at all.

    Args:
        lab: (H, W, 3) display picture.
        mask: (H, W) subject coverage.
        least: Standard deviation of L*.
    """
    inside = _lightness_inside(lab, mask)
    if len(inside) < _FEW:
        return lab.new_zeros(())
    return F.relu(1.0 - (inside.var() + 1e-4).sqrt() / least)


def _lightness_inside(lab: Tensor, mask: Tensor) -> Tensor:
    """(N,) L* of the pixels that show nothing but the subject."""
    return lab[..., 0][mask.detach() > 0.9]


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
