# SPDX-License-Identifier: Apache-2.0
"""The attributes that words ask for, as an encoder's heads see them in a picture."""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy

import torch
import torch.nn.functional as F
from torch import Tensor

from lab.heads import AttributeHeads, heads_of
from proxy_renderer.guidance import regions
from proxy_renderer.guidance.encoder import Encoder
from proxy_renderer.guidance.guide import Guidance

_WEIGHT = 0.5  # of the term
_SURE = 0.1  # cross-entropy below which an attribute counts as there: p > 0.9
_FULL_FRAME = ("vignette", "brightness")  # attributes that a crop changes


class Attributes:
    """Answers wanted of the heads.

    Args:
        encoder: The one whose heads are asked.
        targets: Attribute -> class that the words ask for; those that the heads do not know are left out.

    Attributes:
        encoder: As given.
        targets: Attribute -> index of the class.
    """

    def __init__(self, encoder: Encoder, heads: AttributeHeads, targets: Mapping[str, str]) -> None:
        self.encoder, self._heads = encoder, heads
        pairs = ((a, c, heads.names.get(a, [])) for a, c in targets.items())
        self.targets = {a: classes.index(c) for a, c, classes in pairs if c in classes}

    def look(self, display: Tensor, mask: Tensor, count: int, generator: torch.Generator) -> tuple[Tensor, Tensor]:
        """Features of some views of the whole picture, and of one of the subject.

        Args:
            display: (H, W, 3) in [0, 1].
            mask: (H, W) subject coverage in [0, 1].

        Returns:
            (count, D) unit features of the whole, the full frame first, and (1, D) of the subject.
        """
        whole = regions.whole_views(display, count, generator, self.encoder.size)
        subject = regions.subject_views(display, mask, 1, generator, self.encoder.size)
        features = self.encoder.encode_images(torch.cat([whole, subject]))
        return features[:count], features[count:]

    def loss(self, whole: Tensor, subject: Tensor) -> Tensor:
        """Mean over the attributes of how far each is from being there, as far as its head can tell, by features.

        Args:
            whole: (views, D) unit features of the whole picture, the full frame first.
            subject: (views, D) unit features of the framed subject.

        Returns:
            A scalar, at least 0.
        """
        logits, losses = self._heads.read(whole, subject), []
        for attribute, target in self.targets.items():
            scores = logits[attribute][:1] if attribute in _FULL_FRAME else logits[attribute]
            entropy = F.cross_entropy(scores, torch.full((len(scores),), target, device=scores.device))
            losses.append(self._heads.skill[attribute] * F.relu(entropy - _SURE))
        return torch.stack(losses).mean()


class WithHeads:
    """A guidance, and a term for the attributes that words ask for.

    Args:
        encoder: The one whose heads are asked.
        targets: Attribute -> class that the words ask for.

    Attributes:
        views: How many crops of each region it looks at.
    """

    def __init__(self, guidance: Guidance, encoder: Encoder, targets: Mapping[str, str]) -> None:
        heads = heads_of(encoder)
        self._guidance = guidance
        self._wanted = Attributes(encoder, heads, targets) if heads else None

    @property
    def views(self) -> regions.Views:
        """Those of the other terms."""
        return self._guidance.views

    @views.setter
    def views(self, views: regions.Views) -> None:
        self._guidance = copy(self._guidance)
        self._guidance.views = views

    def __call__(self, display: Tensor, mask: Tensor, generator: torch.Generator) -> dict[str, Tensor]:
        """The weighted terms. Arguments as for `Guidance`."""
        terms = self._guidance(display, mask, generator)
        if self._wanted and self._wanted.targets:
            seen = self._wanted.look(display, mask, self.views.whole, generator)
            terms["attributes"] = _WEIGHT * self._wanted.loss(*seen)
        return terms
