# SPDX-License-Identifier: Apache-2.0
"""Algorithm 1 of the paper: parse, compose, confine, select, project, inner steps, stabilize.

Every round is anchored: it works with a proxy that Cycles has corrected where the round starts.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from torch import Tensor

from ..guidance.encoder import Encoder
from ..planning.advice import Advisor
from ..prompt.types import Parsed, Plan, Prompts
from ..schema import Values
from ..schema.messages import Options
from . import starts
from .anchoring import AnchorState
from .inner import StepSettings, descend
from .progress import Observer
from .search import Search, Start
from .shots import ShotInput, ShotState
from .vector import ParameterVector

STRIDE = 0.05
"""A projection that moves no value by more than this share of its whole range is not worth another anchor."""

CONVERGED = 0.005
"""A round, other than the first, that lowers the loss by a smaller share is the last one."""


@dataclass
class Outcome:
    """The result of a vibe.

    Attributes:
        vector: The parameters of u.
        u: (N,) the final point, θ^(R); see `ParameterVector.values`.
        plan: The last round's plan.
        ranges: Key -> the last round's (lower, upper) in schema units, azimuths turned as the values are.
        optimized: Keys that some round optimized.
        parsed: The prompt, understood.
        prompts: What the encoder was asked.
        rounds: One record per round: parameters, loss at start and end, its terms, steps, seconds.
        shots: The shots, each with its proxy and guidance.
        anchors: For each shot, the corrections that hold at u.
        loss: Of the last round, at u.
        stopped: Whether the observer ended the loop.
        variants: All variants, if several were asked for; the one of least loss first.
    """

    vector: ParameterVector
    u: Tensor
    plan: Plan
    ranges: dict[str, tuple[Values, Values]]
    optimized: set[str]
    parsed: Parsed
    prompts: Prompts
    shots: list[ShotState]
    anchors: list[AnchorState]
    loss: float
    rounds: list[dict[str, Any]] = field(default_factory=list)
    stopped: bool = False
    variants: list[Outcome] = field(default_factory=list)

    def recall(self) -> None:
        """Corrects the proxies as they were at u."""
        for shot, anchor in zip(self.shots, self.anchors, strict=True):
            shot.anchoring.recall(anchor)


def run(
    views: Sequence[ShotInput],
    prompt: str,
    options: Options,
    encoder: Encoder,
    heads: Encoder | None,
    observer: Observer,
    advisor: Advisor | None = None,
) -> Outcome:
    """Finds the values that make the scene look like the prompt.

    Args:
        views: The exported scene; or several shots that are to share one look.
        prompt: What the artist typed.
        options: Budget, seed, locks; the same options give the same values, bit for bit, on a CPU.
        encoder: Judges similarity.
        heads: Encoder whose attribute heads guide beside it; None for none.
        observer: Follows the loop, and may end it.
        advisor: Parses, composes and confines; None for the offline planner.

    Returns:
        The outcome of least loss; all of them are in its `variants`, where several were asked for.

    Raises:
        VibeError: If no word of the prompt is known, or nothing that the words touch may change.
    """
    search = Search(views, prompt, options, encoder, heads, observer, advisor)
    outcomes = []
    for start in search.find_starts():
        outcomes.append(refine(search, start))
        if outcomes[-1].stopped:
            break
    outcomes.sort(key=lambda outcome: outcome.loss)
    best = outcomes[0]
    best.recall()
    best.variants = outcomes if search.several else []
    return best


def refine(search: Search, start: Start) -> Outcome:
    """The rounds of Algorithm 1 from one start.

    Where the paper writes θ, this is u: θ on perceptual scales. Comments name the algorithm's lines.

    Args:
        search: What all starts share.
        start: Where to start.
    """
    u, plan, loss = start.u, Plan(), math.inf
    rounds: list[dict[str, Any]] = []
    for number in range(search.rounds):  # 1: r = 0 … R - 1
        started = time.monotonic()
        confined = search.confine(u, plan, start)  # 2 to 5 and 7: render, parse, compose, confine, project
        u, plan = confined.u, confined.plan
        search.renew(u, search.number, slack=STRIDE)
        chosen, objective = search.objective(confined, u)  # 6: S_K
        movable = search.vector.mark(chosen) & (confined.upper > confined.lower)
        seed = search.options.seed * 1000 + search.number
        follow = search.clock.follow(search.number)
        steps = search.options.steps
        descent = descend(
            objective, u, movable, confined.lower, confined.upper, steps, seed, StepSettings(), follow
        )  # 8 to 15
        u, loss = descent.u, descent.loss  # 16
        search.number += 1
        rounds.append(
            {
                "parameters": chosen,
                "loss": [descent.start_loss, descent.loss],
                **objective.account(u),
                "steps": descent.steps,
                "repairs": descent.repairs,
                "advice": confined.advice.source,
                "seconds": round(time.monotonic() - started, 3),
            }
        )
        gained = descent.start_loss - descent.loss
        if search.clock.stopped or not chosen or (number and gained < CONVERGED * abs(descent.start_loss)):
            break
    search.number += search.rounds - len(rounds)
    search.renew(u, search.number - 1)
    if start.drawn is not None:
        plan = starts.with_reasons(plan, search.vector, u)
    return Outcome(  # 18
        vector=search.vector,
        u=u,
        plan=plan,
        ranges=confined.ranges,
        optimized={key for record in rounds for key in record["parameters"]},
        parsed=confined.advice.parsed,
        prompts=confined.advice.prompts,
        shots=search.shots,
        anchors=[shot.anchoring.newest for shot in search.shots],
        loss=loss,
        rounds=rounds,
        stopped=search.clock.stopped,
    )
