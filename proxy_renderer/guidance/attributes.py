# SPDX-License-Identifier: Apache-2.0
"""The attributes that words ask for, as an encoder's heads see them in a picture."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import torch
import torch.nn.functional as F
from torch import Tensor

from . import regions

if TYPE_CHECKING:
    from .encoder import AttributeHeads, Encoder

_SURE = 0.1  # cross-entropy below which an attribute counts as there: p > 0.9
_FULL_FRAME = ("vignette", "brightness")  # attributes that a crop changes


class Attributes:
    """What the heads are to say.

    Args:
        encoder: The one whose heads are asked.
        heads: Its heads.
        targets: Attribute -> class that the words ask for; those that the heads do not know are left out.

    Attributes:
        encoder: As given.
        targets: Attribute -> index of the class.
    """

    def __init__(self, encoder: Encoder, heads: AttributeHeads, targets: Mapping[str, str]) -> None:
        self.encoder, self._heads = encoder, heads
        pairs = ((a, c, heads.names.get(a, [])) for a, c in targets.items())
        self.targets = {a: classes.index(c) for a, c, classes in pairs if c in classes}

    def look(
        self, display: Tensor, mask: Tensor, count: int, generator: torch.Generator
    ) -> tuple[Tensor, Tensor]:
        """Features of some views of the whole picture, and of one of the subject.

        Args:
            display: (H, W, 3) in [0, 1].
            mask: (H, W) subject coverage in [0, 1].
            count: Views of the whole.
            generator: Chooses the views.

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

    @torch.no_grad()
    def measure(self, display: Tensor, mask: Tensor) -> dict[str, float]:
        """Attribute -> probability of its class, in a picture (H, W, 3) with a subject (H, W).

        Args:
            display: (H, W, 3) in [0, 1].
            mask: (H, W) subject coverage in [0, 1].
        """
        logits = self._heads.read(*self.look(display, mask, 1, torch.Generator().manual_seed(0)))
        return {a: round(float(logits[a].softmax(-1)[0, c]), 3) for a, c in self.targets.items()}


def attributes(encoder: Encoder | None, targets: Mapping[str, str]) -> Attributes | None:
    """What an encoder's heads are to say.

    Args:
        encoder: The one whose heads are asked.
        targets: As for `Attributes`.

    Returns:
        None if it has no heads, or they are asked for nothing that they know.
    """
    if encoder is None or encoder.heads is None:
        return None
    asked = Attributes(encoder, encoder.heads, targets)
    return asked if asked.targets else None
