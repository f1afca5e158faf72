# SPDX-License-Identifier: Apache-2.0
"""The paper's baselines: one similarity for the whole picture, by Adam, without a plan.

`clip-only` is the paper's text: every parameter. `clip-authors` is what the authors' code does: camera and fog are frozen.
Both take all steps that they are given; the authors' code takes 240 in one go, that is `--rounds 1 --steps 240`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import torch
from torch import Tensor

from ..guidance import regions
from ..guidance.encoder import Encoder
from ..guidance.losses import positive_loss
from ..planning.types import Plan, PlanEntry
from ..schema import Instance
from ..schema.messages import Options
from .inner.adam import StepSettings

_FROZEN = {"clip-only": (), "clip-authors": ("camera", "volume")}
"""Name of a baseline -> the groups of parameters that it leaves alone."""

_RATE = 0.01
"""Its greatest step, as a share of a range. Ranges are whole here, not a plan's: .04 would turn a lamp by 29°."""

_ALL = 10**9


def plan_everything(instances: Mapping[str, Instance], baseline: str) -> Plan:
    """Every parameter is equally important and may go anywhere within its hard bounds, but for what is frozen.

    Args:
        instances: The scene's parameters by key.
        baseline: Its name.
    """
    frozen = _FROZEN[baseline]
    return Plan(
        {
            key: PlanEntry(i.lower, i.upper, None, "the baseline leaves it alone", prior=0.0)
            if i.parameter.group in frozen
            else PlanEntry(i.lower, i.upper, 0, "the baseline optimizes everything", prior=0.0)
            for key, i in instances.items()
        }
    )


def step_settings(options: Options) -> StepSettings:
    """How Adam steps: in the baselines with their own rate, and never ending before its time.

    Args:
        options: `baseline`, and `rate` in thousandths.
    """
    own = StepSettings(rate=_RATE, patience=_ALL) if options.baseline else StepSettings()
    return replace(own, rate=options.rate / 1000) if options.rate else own


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
