# SPDX-License-Identifier: Apache-2.0
"""The paper's baseline: one similarity for the whole picture, every parameter, no plan."""

from __future__ import annotations

from collections.abc import Mapping

import torch
from torch import Tensor

from ..guidance import regions
from ..guidance.encoder import Encoder
from ..guidance.losses import positive_loss
from ..prompt.types import Plan, PlanEntry
from ..schema import Instance


def plan_everything(instances: Mapping[str, Instance]) -> Plan:
    """Every parameter is equally important and may go anywhere within its hard bounds."""
    reason = "the baseline optimizes everything"
    return Plan({k: PlanEntry(i.lower, i.upper, 0, reason, prior=0.0) for k, i in instances.items()})


class GlobalGuidance:
    """L_pos(I, t) alone (equation 3), on as many views as the product's whole-picture term has.

    Args:
        encoder: Judges similarity.
        prompt: The raw text t.
        views: How many crops.
    """

    def __init__(self, encoder: Encoder, prompt: str, views: regions.Views) -> None:
        self.encoder, self.views = encoder, views
        with torch.no_grad():
            self.text = encoder.encode_texts([prompt])

    def __call__(self, display: Tensor, mask: Tensor, generator: torch.Generator) -> dict[str, Tensor]:
        """The one term; the mask is not looked at."""
        views = regions.whole_views(display, self.views.whole, generator, self.encoder.size)
        return {"whole": positive_loss(self.encoder.encode_images(views), self.text)}

    def measure(self, display: Tensor, mask: Tensor) -> dict[str, float]:
        """Nothing: the baseline does not know what the words ask for. Arguments as for `Guidance.measure`."""
        return {}
