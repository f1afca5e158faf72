# SPDX-License-Identifier: Apache-2.0
"""The method of a search: the product's own, whose hooks plug-ins override (`lab/methods`)."""

import os
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from typing import Any

from torch import Tensor

from ...claims.claim import Claim
from ...guidance.encoder import Encoder
from ...guidance.guide import Guidance, NoGuidance, PromptGuidance, Weights
from ...planning.advice import NO_PROMPTS, Advice
from ...planning.types import Plan
from ...render.proxy import Render
from ...schema import Instance, VibeError
from ...schema.messages import Options
from ..least_squares import Descent, solve
from ..shots import ShotState
from ..vector import ParameterVector
from .confiner import Confined
from .selection import Selection, select

VARIABLE = "VIBE_METHOD"  # a plug-in, MODULE:CLASS, that the engine uses in place of the product's method


class Method:
    """The product's method: least squares on the words' claims, over the parameters that serve the claims most."""

    weights = Weights()  # of the terms of the loss
    every_word = False  # whether the encoder also guides on words that have a measure

    def plan(self, instances: Mapping[str, Instance], plan: Plan) -> Plan:
        """The plan of a round (lines 3 to 5), made of the advisor's `plan`; `instances`: key -> scene's parameter."""
        return plan

    def claims(self, claims: tuple[Claim, ...]) -> tuple[Claim, ...]:
        """The claims that images are measured by, made of the `claims` of the words and the reference image."""
        return claims

    def guidance(self, encoder: Encoder, advice: Advice, start: Render, every_word: bool = False) -> Guidance:
        """Guidance on words without a measure, or on `every_word`, calibrated on the artist's image `start`."""
        prompts = advice.prompts if every_word or self.every_word else advice.unmeasured
        if prompts == NO_PROMPTS:  # claims cover all words
            return NoGuidance()
        return PromptGuidance(encoder, prompts, (start.display, start.mask), self.weights)

    def select(
        self, now: Confined, vector: ParameterVector, shots: Sequence[ShotState], u: Tensor, options: Options
    ) -> Selection:
        """S_K, the parameters to optimize (line 6), chosen at u (N,), and the objective that is minimized over S_K."""
        return select(now, vector, shots, u, options, self.weights)

    def descend(
        self, now: Confined, chosen: Selection, steps: int, seed: int, follow: Callable[[int, float, Any], bool]
    ) -> Descent:
        """Lines 8 to 15: steps from the round's point over the components of S_K; for `follow` see `solve`."""
        return solve(chosen.objective, now.u, chosen.movable(now), now.lower, now.upper, steps, follow, chosen.model)


def load_method() -> Method:
    """The plug-in that the environment names, or the product's method; raises VibeError if there is no such plug-in."""
    name = os.environ.get(VARIABLE, "")
    if not name:
        return Method()
    module, _, its_class = name.partition(":")
    try:
        method: Method = getattr(import_module(module), its_class)()
    except (ImportError, AttributeError, ValueError) as error:
        remedy = f"Set {VARIABLE} to MODULE:CLASS, or to nothing."
        raise VibeError(f"The method {name!r} cannot be loaded: {error}.", remedy) from error
    return method
