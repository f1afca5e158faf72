# SPDX-License-Identifier: Apache-2.0
"""What the picture is asked to be: the paper's objective (equations 3, 4 and 9) and its safeguards.

Similarity alone can be satisfied by pictures that a person would not call the prompt, so three
kinds of measured terms stand beside it: attribute heads, colors that the words name, and whether
the subject can be seen at all.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import torch
import torch.nn.functional as F
from torch import Tensor

from ..language.types import Lab, Prompts, Region
from ..render.color import srgb_to_lab
from . import regions

if TYPE_CHECKING:
    from .encoder import Encoder

_SURE = 0.1  # cross-entropy below which an attribute counts as there: p > 0.9
_CLOSE = 6.0  # a Lab distance that still is the named color
_FULL_FRAME = ("vignette", "brightness")  # attributes that a crop changes


@dataclass(frozen=True)
class Weights:
    """Weights of the terms; those of equation 9 are the paper's.

    Attributes:
        subject: λ_fg.
        surroundings: λ_bg.
        whole: λ_full.
        negative: λ_neg.
        color: Named colors; the paper's for the background's, used for the subject's too.
        attributes: Cross-entropy of the attribute heads.
        border: Subject on the picture's border.
        visibility: A subject that cannot be told from its surroundings, or cannot be seen.
        prior: Pull of what no word names to the artist's value.
    """

    subject: float = 1.0
    surroundings: float = 1.0
    whole: float = 0.25
    negative: float = 0.8
    color: float = 0.6
    attributes: float = 0.5
    border: float = 0.5
    visibility: float = 1.0
    prior: float = 0.5


class Guide:
    """The objective for one prompt.

    Args:
        encoder: Judges similarity.
        heads: Encoder whose attribute heads are asked (often the same); None for none.
        prompts: Phrases by region.
        targets: Attribute -> class that the words ask for.
        colors: "subject"/"surroundings" -> Lab.
        start: Display picture (H, W, 3) and mask (H, W) of the artist's scene: hinge margins are
            calibrated on it, because encoders differ in how alike they find everything.
        weights: Of the terms.
        views: How many crops of each region.
    """

    def __init__(
        self,
        encoder: Encoder,
        heads: Encoder | None,
        prompts: Prompts,
        targets: Mapping[str, str],
        colors: Mapping[Region, Lab],
        start: tuple[Tensor, Tensor],
        weights: Weights | None = None,
        views: regions.Views | None = None,
    ) -> None:
        self.encoder, self.weights, self.views = encoder, weights or Weights(), views or regions.Views()
        self.colors = colors
        self.heads = heads if heads is not None and heads.heads is not None else None
        names = self.heads.heads.names if self.heads is not None and self.heads.heads is not None else {}
        self.targets = {a: names[a].index(c) for a, c in targets.items() if c in names.get(a, [])}
        self.positive = {
            region: _texts(encoder, (text,))
            for region, text in zip(
                _REGIONS, (prompts.subject, prompts.surroundings, prompts.whole), strict=True
            )
        }
        negatives = (prompts.subject_negatives, prompts.surroundings_negatives, prompts.whole_negatives)
        self.negative = {r: _texts(encoder, texts) for r, texts in zip(_REGIONS, negatives, strict=True)}
        with torch.no_grad():
            features = self._features(*start, torch.Generator().manual_seed(0))
        self.margins = {r: self._margin(features[r], r) for r in _REGIONS}

    def __call__(self, display: Tensor, mask: Tensor, generator: torch.Generator) -> dict[str, Tensor]:
        """The weighted terms, whose sum is the loss.

        Args:
            display: (H, W, 3) in [0, 1].
            mask: (H, W) soft subject coverage.
            generator: Chooses crops and backgrounds.
        """
        w = self.weights
        terms: dict[str, Tensor] = {}
        features = self._features(display, mask, generator)
        for region, weight in zip(_REGIONS, (w.subject, w.surroundings, w.whole), strict=True):
            if len(self.positive[region]):
                terms[region] = weight * positive_loss(features[region], self.positive[region])
            if len(self.negative[region]):
                loss = negative_loss(features[region], self.negative[region], self.margins[region])
                terms[f"{region} negative"] = w.negative * loss
        if self.targets and self.heads is not None:
            seen = self._head_features(display, features["whole"], generator)
            terms["attributes"] = w.attributes * self._attribute_loss(seen)
        lab = srgb_to_lab(display)
        for region, target in self.colors.items():
            terms[f"{region} color"] = w.color * color_loss(
                lab, mask if region == "subject" else 1.0 - mask, target
            )
        terms["border"] = w.border * border_loss(mask)
        terms["visibility"] = w.visibility * visibility_loss(lab, mask)
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

    def _head_features(self, display: Tensor, whole: Tensor, generator: torch.Generator) -> Tensor:
        """Whole-picture features of the encoder that has the heads."""
        if self.heads is None or self.heads is self.encoder:
            return whole
        return self.heads.encode_images(
            regions.whole_views(display, self.views.whole, generator, self.heads.size)
        )

    def _attribute_loss(self, features: Tensor) -> Tensor:
        """Mean over the named attributes of how far each is from being there."""
        logits = self.heads.heads.logits(features)  # type: ignore[union-attr]
        losses = []
        for attribute, target in self.targets.items():
            seen = logits[attribute][:1] if attribute in _FULL_FRAME else logits[attribute]
            entropy = F.cross_entropy(seen, torch.full((len(seen),), target, device=seen.device))
            losses.append(F.relu(entropy - _SURE))
        return torch.stack(losses).mean()

    def _margin(self, features: Tensor, region: str) -> float:
        """How alike this encoder finds the starting picture and the region's phrases on average."""
        phrases = torch.cat([self.positive[region], self.negative[region]])
        return float((features @ phrases.T).mean()) if len(phrases) else 0.0


_REGIONS = ("subject", "surroundings", "whole")


def positive_loss(features: Tensor, text: Tensor) -> Tensor:
    """Equation 3: 1 − s(I, p), mean over views. features (views, D), text (1, D), both unit."""
    return 1.0 - (features @ text.T).mean()


def negative_loss(features: Tensor, texts: Tensor, margin: float) -> Tensor:
    """Equation 4: max(0, s(I, p⁻) − m), mean over views, of the phrase that fits most."""
    return F.relu((features @ texts.T).mean(0) - margin).max()


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
    lab: Tensor, mask: Tensor, contrast: float = 15.0, light: float = 25.0, burnt: float = 94.0
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


def prior_loss(where: Tensor, home: Tensor, weight: Tensor) -> Tensor:
    """Pull to the artist's values of what no word names.

    Args:
        where: (N,) position of each component within its feasible range, in [0, 1].
        home: (N,) position of the artist's value, likewise.
        weight: (N,) in [0, 1], 0 for components that words name.
    """
    return (weight * (where - home).square()).sum()


def _texts(encoder: Encoder, texts: tuple[str, ...]) -> Tensor:
    """Unit features (B, D) of the phrases that say something; (0, D) when there are none."""
    spoken = [t for t in texts if t]
    with torch.no_grad():
        features = encoder.encode_texts(spoken or [""])
    return features[: len(spoken)]
