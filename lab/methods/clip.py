# SPDX-License-Identifier: Apache-2.0
"""The paper's baselines: one similarity for the whole picture, by Adam, without a plan.

Both take all steps that they are given; the authors' code takes 240 in one go, that is `--rounds 1 --steps 240`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import torch
from torch import Tensor

from lab.methods.adam import Adam, StepSettings
from proxy_renderer.claims.claim import Claim
from proxy_renderer.guidance import regions
from proxy_renderer.guidance.encoder import Encoder
from proxy_renderer.guidance.guide import Guidance, Weights, positive_loss
from proxy_renderer.optimize.objective import RoundObjective
from proxy_renderer.optimize.rounds.confiner import Confined
from proxy_renderer.optimize.rounds.selection import Selection, relevant
from proxy_renderer.optimize.shots import ShotState
from proxy_renderer.optimize.vector import ParameterVector
from proxy_renderer.planning.advice import Advice
from proxy_renderer.planning.types import Plan, PlanEntry
from proxy_renderer.render.proxy import Render
from proxy_renderer.schema import Instance
from proxy_renderer.schema.messages import Options


class ClipOnly(Adam):
    """The paper's text: every parameter.

    Attributes:
        frozen: Groups of parameters that it leaves alone.
    """

    weights = replace(Weights(), claims=0.0, prior=0.0, hue=0.0)
    settings = StepSettings(rate=0.01, patience=10**9)  # ranges are whole here: .04 would turn a light by 29°
    frozen: tuple[str, ...] = ()

    def plan(self, instances: Mapping[str, Instance], plan: Plan) -> Plan:
        """Every parameter is equally important and may go anywhere within its hard bounds, but for what is frozen."""
        return Plan({key: self._entry(instance) for key, instance in instances.items()})

    def _entry(self, i: Instance) -> PlanEntry:
        if i.parameter.group in self.frozen:
            return PlanEntry(i.lower, i.upper, None, "the baseline leaves it alone", prior=0.0)
        return PlanEntry(i.lower, i.upper, 0, "the baseline optimizes everything", prior=0.0)

    def claims(self, claims: tuple[Claim, ...]) -> tuple[Claim, ...]:
        """None: the baseline does not know what the words ask for."""
        return ()

    def guidance(self, encoder: Encoder, advice: Advice, start: Render, every_word: bool = False) -> Guidance:
        """L_pos(I, t) alone."""
        return GlobalGuidance(encoder, advice.goals.parsed.prompt, regions.Views())

    def select(
        self, now: Confined, vector: ParameterVector, shots: Sequence[ShotState], u: Tensor, options: Options
    ) -> Selection:
        """All that can move."""
        keys = relevant(now.plan, vector, now.upper > now.lower)
        box = now.lower, now.upper
        return Selection(sorted(keys), RoundObjective(shots, vector, now.plan, keys, box, self.weights))


class ClipAuthors(ClipOnly):
    """The authors' code: camera and fog are frozen."""

    frozen = ("camera", "volume")


class LightLayers(ClipOnly):
    """Coefficients of exact layers of light, as in the Eurographics 2026 short paper egs20261021 ("OLAT basis coefficients").

    There each lamp, glowing mesh and world is rendered by Cycles alone, and gradient descent finds their powers and colors
    under a similarity of the sum. Here the anchors correct the proxy light by light, so its layers are Cycles' own at the
    anchor. Added lights of a rig, which take the place of the paper's dome, are among them.
    """

    coefficients = (
        "light/power",
        "light/strength",
        "light/color",
        "world/strength",
        "world/color",
        "material/emission",
    )

    def _entry(self, i: Instance) -> PlanEntry:
        if i.parameter.family in self.coefficients:
            return PlanEntry(i.lower, i.upper, 0, "a coefficient of its layer", prior=0.0)
        return PlanEntry(i.lower, i.upper, None, "no layer has it", prior=0.0)


class GlobalGuidance:
    """L_pos(I, t) alone (equation 3), on as many views as the product's whole-picture term has."""

    def __init__(self, encoder: Encoder, prompt: str, views: regions.Views) -> None:
        self.encoder, self.views = encoder, views
        with torch.no_grad():
            self.text = encoder.encode_texts([prompt])

    def __call__(self, display: Tensor, mask: Tensor, generator: torch.Generator) -> dict[str, Tensor]:
        """The one term; the mask is not looked at."""
        views = regions.whole_views(display, self.views.whole, generator, self.encoder.size)
        return {"whole": positive_loss(self.encoder.encode_images(views), self.text)}
