# SPDX-License-Identifier: Apache-2.0
"""The product's method with a part left out, to see what it is worth."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import torch
from torch import Tensor

from lab.heads.classes import HEADS
from lab.methods.attributes import WithHeads
from proxy_renderer.guidance.encoder import Encoder
from proxy_renderer.guidance.guide import Guidance, NoGuidance, Weights
from proxy_renderer.optimize.least_squares import Descent
from proxy_renderer.optimize.objective import RoundObjective
from proxy_renderer.optimize.rounds import selection
from proxy_renderer.optimize.rounds.confiner import Confined
from proxy_renderer.optimize.rounds.method import Method
from proxy_renderer.optimize.shots import ShotState
from proxy_renderer.optimize.vector import ParameterVector
from proxy_renderer.planning.advice import Advice
from proxy_renderer.planning.types import Plan
from proxy_renderer.render.proxy import Render
from proxy_renderer.schema import Instance
from proxy_renderer.schema.messages import Options


class Projection(Method):
    """No search: the nearest values in the words' ranges."""

    def descend(
        self,
        now: Confined,
        chosen: selection.Selection,
        steps: int,
        seed: int,
        follow: Callable[[int, float, Any], bool],
    ) -> Descent:
        """The round's projected point."""
        return Descent(now.u, 0.0, 0.0)


class BareRig(Projection):
    """The lights that the words need, set up, and nothing else: no other range is applied."""

    def plan(self, instances: Mapping[str, Instance], plan: Plan) -> Plan:
        """The rig's values as it sets them; all others are the artist's."""
        values = {k: (e.usual and e.start) or instances[k].value for k, e in plan.items()}
        return Plan({k: replace(e, lower=values[k], upper=values[k], start=None) for k, e in plan.items()})

    def select(
        self, now: Confined, vector: ParameterVector, shots: Sequence[ShotState], u: Tensor, options: Options
    ) -> selection.Selection:
        """Nothing: no value may move."""
        box = now.lower, now.upper
        return selection.Selection([], RoundObjective(shots, vector, now.plan, set(), box, self.weights))


class Middle(Method):
    """No search: the middle of the ranges."""

    def descend(
        self,
        now: Confined,
        chosen: selection.Selection,
        steps: int,
        seed: int,
        follow: Callable[[int, float, Any], bool],
    ) -> Descent:
        """The point with what may move in the middle of its range."""
        return Descent(torch.where(chosen.movable(now), (now.lower + now.upper) / 2, now.u), 0.0, 0.0)


class WithoutEncoder(Method):
    """Claims alone."""

    def guidance(self, encoder: Encoder, advice: Advice, start: Render, every_word: bool = False) -> Guidance:
        """None."""
        return NoGuidance()


class EveryWord(Method):
    """The encoder is asked for all words, those that measures cover too."""

    every_word = True


class WithoutClaims(Method):
    """The encoder alone, and its attribute heads, which guess what claims measure."""

    weights = replace(Weights(), claims=0.0)

    def guidance(self, encoder: Encoder, advice: Advice, start: Render, every_word: bool = False) -> Guidance:
        """The product's for every word, with a term for the heads."""
        return WithHeads(
            super().guidance(encoder, advice, start, every_word=True),
            encoder,
            {HEADS[name]: value for name, value in advice.goals.classes.items() if name in HEADS},
        )


class WithoutSharing(Method):
    """Parameters that do the same as a chosen one are not held."""

    def __init__(self) -> None:
        selection.ALIKE = math.inf  # this engine has no other method
