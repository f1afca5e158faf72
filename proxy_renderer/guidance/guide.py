# SPDX-License-Identifier: Apache-2.0
"""The paper's objective: similarities of regions to the words (equation 9), and the other terms of the loss."""

from dataclasses import dataclass
from typing import Protocol

import torch
import torch.nn.functional as F
from torch import Tensor

from ..planning.advice import Prompts
from . import regions
from .encoder import Encoder

_REGIONS = ("subject", "surroundings", "whole")  # fields of `Prompts`, `Weights` and `Views`


def positive_loss(features: Tensor, text: Tensor) -> Tensor:
    """Equation 3: 1 − s(I, p); s is the mean cosine of an image's unit features (views, D) and a phrase's (1, D)."""
    return 1.0 - (features @ text.T).mean()


def negative_loss(features: Tensor, texts: Tensor, margin: float) -> Tensor:
    """Equation 4: max(0, s(I, p⁻) − m) for the negative phrase of `texts` (phrases, D) most similar to `features`."""
    return F.relu((features @ texts.T).mean(0) - margin).max()


def direction_loss(features: Tensor, start: Tensor, text: Tensor, plain: Tensor, least: float = 0.1) -> Tensor:
    """1 − cos(ΔI, ΔT): the image should change in the direction in which the words differ from a plain caption (StyleGAN-NADA).

    An adversarial change, which makes the image similar to the words but like no real image, has another direction.
    `features` (views, D) are those of the image, `start` (D,) is the mean of the starting image's, `text` and `plain`
    (1, D) are those of the captions. If ΔI has the length `least`, the cosine counts half.
    """
    moved = features.mean(0) - start
    length = (moved.square().sum() + 1e-8).sqrt()
    return 1.0 - (moved @ F.normalize(text - plain, dim=1)[0]) / (length + least)


def border_loss(mask: Tensor) -> Tensor:
    """Mean of the subject's coverage (H, W) along the border of the image, which should not cut the subject off."""
    return torch.cat([mask[0], mask[-1], mask[1:-1, 0], mask[1:-1, -1]]).mean()


def claims_loss(residuals: list[Tensor]) -> Tensor:
    """Sum over claims of how far each is missed, in noticeable steps: quadratic up to one, linear beyond (Huber 1964)."""
    missed = torch.stack([(r.square().sum() + 1e-8).sqrt() for r in residuals])
    return F.huber_loss(missed, torch.zeros_like(missed), reduction="sum")


def hue_consistency_loss(where: Tensor, colors: Tensor, weights: Tensor) -> Tensor:
    """Squared deviation of each color's components from a common place in their ranges, so that the color keeps its hue.

    The range of a color is a box around the named color, and the corners of the box have other hues. `where` (N,) are
    the components' places in their ranges, in [0, 1], `weights` (N,) their weights, 0 for fixed components. `colors`
    (M, 3) are the indices of the components of M colors.
    """
    place, weight = where[colors], weights[colors]
    middle = (place * weight).sum(1, keepdim=True) / weight.sum(1, keepdim=True).clamp_min(1.0)
    return (weight * (place - middle).square()).sum()


def prior_loss(where: Tensor, home: Tensor, weight: Tensor) -> Tensor:
    """Pull home: sum of squared distances of the places `where` from `home`, (N,) each, with weights (N,) in [0, 1]."""
    return (weight * (where - home).square()).sum()


@dataclass(frozen=True)
class Weights:
    """Weights of the terms; those of equation 9 are the paper's."""

    subject: float = 1.0  # λ_fg
    surroundings: float = 1.0  # λ_bg
    whole: float = 0.25  # λ_full
    direction: float = 0.2  # change of the whole image in the direction of the words
    negative: float = 0.8  # λ_neg
    border: float = 0.5  # subject on the image's border
    claims: float = 0.5  # misses of claims, in noticeable steps
    prior: float = 0.5  # pull of values that no word names to the artist's
    hue: float = 10.0  # pull of a color's components to one place in their ranges


class Guidance(Protocol):
    """Judges an image by terms of the loss: `PromptGuidance`, `NoGuidance`, or a plug-in's."""

    views: regions.Views  # number of crops of each region

    def __call__(self, display: Tensor, mask: Tensor, generator: torch.Generator) -> dict[str, Tensor]:
        """Name -> weighted loss term of an image (H, W, 3) in [0, 1] with a soft subject mask (H, W), to be summed."""


class NoGuidance:
    """A guidance without terms, so that only claims count: for prompts whose words all have measures."""

    views = regions.Views()

    def __call__(self, display: Tensor, mask: Tensor, generator: torch.Generator) -> dict[str, Tensor]:
        """No terms. Arguments as for `Guidance`."""
        return {}


class PromptGuidance:
    """The objective for one prompt; `start` is the starting image (H, W, 3) and its subject mask (H, W).

    Margins of equation 4 are calibrated on `start`: similarities of unrelated images and phrases differ by encoder.
    """

    def __init__(self, encoder: Encoder, prompts: Prompts, start: tuple[Tensor, Tensor], weights: Weights) -> None:
        self.encoder, self.weights, self.views = encoder, weights, regions.Views()
        self.positive = {r: _texts(encoder, (getattr(prompts, r),)) for r in _REGIONS}
        self.negative = {r: _texts(encoder, getattr(prompts, f"{r}_negatives")) for r in _REGIONS}
        with torch.no_grad():
            features = self._features(*start, torch.Generator().manual_seed(0))
        self.plain = _texts(encoder, ("a picture of an object",))  # says nothing of its look
        self.start = features["whole"].mean(0)
        # mean similarity that this encoder finds between the starting image and each region's phrases; NaN without any
        phrases = {r: torch.cat([self.positive[r], self.negative[r]]) for r in _REGIONS}
        self.margins = {r: float((features[r] @ phrases[r].T).mean()) for r in _REGIONS}

    def __call__(self, display: Tensor, mask: Tensor, generator: torch.Generator) -> dict[str, Tensor]:
        """The weighted terms. Arguments as for `Guidance`."""
        w = self.weights
        terms: dict[str, Tensor] = {}
        features = self._features(display, mask, generator)
        for region in _REGIONS:
            if len(self.positive[region]):
                terms[region] = getattr(w, region) * positive_loss(features[region], self.positive[region])
            if len(self.negative[region]):
                loss = negative_loss(features[region], self.negative[region], self.margins[region])
                terms[f"{region} negative"] = w.negative * loss
        if len(self.positive["whole"]):
            words = self.positive["whole"]
            terms["direction"] = w.direction * direction_loss(features["whole"], self.start, words, self.plain)
        return terms

    def _features(self, display: Tensor, mask: Tensor, generator: torch.Generator) -> dict[str, Tensor]:
        """Image features (views, D) of each region, in one batch."""
        size, views = self.encoder.size, self.views
        batch = {
            "subject": regions.subject_views(display, mask, views.subject, generator, size),
            "surroundings": regions.surroundings_views(display, mask, views.surroundings, generator, size),
            "whole": regions.whole_views(display, views.whole, generator, size),
        }
        features = self.encoder.encode_images(torch.cat(list(batch.values())))
        return dict(zip(batch, features.split([len(v) for v in batch.values()]), strict=True))


def _texts(encoder: Encoder, texts: tuple[str, ...]) -> Tensor:
    """Unit features (B, D) of the phrases that are not empty; (0, D) if there are none."""
    spoken = [t for t in texts if t]
    with torch.no_grad():
        features = encoder.encode_texts(spoken or [""])
    return features[: len(spoken)]
