# SPDX-License-Identifier: Apache-2.0
"""Algorithm 1 of the paper: parse, compose, confine, select, project, inner steps, stabilise.

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
    """What a vibe found.

    Attributes:
        vector: The parameters of u.
        u: The values found, see `ParameterVector.values`.
        plan: The last round's plan.
        ranges: The last round's (lower, upper) by key, azimuths turned as the values are.
        optimized: Keys that some round optimized.
        parsed: The prompt, understood.
        prompts: What the encoder was asked.
        rounds: One record per round: parameters, loss at start and end, its terms, steps, seconds.
        shots: What drew and judged it.
        anchors: For each shot, the corrections that hold at u.
        loss: Of the last round, at u.
        stopped: Whether the observer ended the loop.
        variants: All that were found, if several were asked for; the best first.
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
        The best of what was found; all of it is in its `variants`, where several were asked for.

    Raises:
        VibeError: If no word of the prompt is known, or nothing that the words touch may change.
    """
    search = Search(views, prompt, options, encoder, heads, observer, advisor)
    found = []
    for start in search.find_starts():
        found.append(refine(search, start))
        if found[-1].stopped:
            break
    found.sort(key=lambda outcome: outcome.loss)
    best = found[0]
    best.recall()
    best.variants = found if search.several else []
    return best


def refine(search: Search, start: Start) -> Outcome:
    """The rounds of Algorithm 1 from one start."""
    u, plan, loss = start.u, Plan(), math.inf
    rounds: list[dict[str, Any]] = []
    for number in range(search.rounds):
        started = time.monotonic()
        now = search.confine(u, plan, start)
        u, plan = now.u, now.plan
        search.renew(u, search.number, slack=STRIDE)
        chosen, objective = search.objective(now, u)
        movable = search.vector.mark(chosen) & (now.upper > now.lower)
        seed = search.options.seed * 1000 + search.number
        follow = search.clock.follow(search.number)
        steps = search.options.steps
        found = descend(objective, u, movable, now.lower, now.upper, steps, seed, StepSettings(), follow)
        u, loss = found.u, found.loss
        search.number += 1
        rounds.append(
            {
                "parameters": chosen,
                "loss": [found.start_loss, found.loss],
                **objective.account(u),
                "steps": found.steps,
                "repairs": found.repairs,
                "advice": now.advice.source,
                "seconds": round(time.monotonic() - started, 3),
            }
        )
        gained = found.start_loss - found.loss
        if search.clock.stopped or not chosen or (number and gained < CONVERGED * abs(found.start_loss)):
            break
    search.number += search.rounds - len(rounds)
    search.renew(u, search.number - 1)
    if start.drawn is not None:
        plan = starts.with_reasons(plan, search.vector, u)
    return Outcome(
        vector=search.vector,
        u=u,
        plan=plan,
        ranges=now.ranges,
        optimized={key for record in rounds for key in record["parameters"]},
        parsed=now.advice.parsed,
        prompts=now.advice.prompts,
        shots=search.shots,
        anchors=[shot.anchoring.newest for shot in search.shots],
        loss=loss,
        rounds=rounds,
        stopped=search.clock.stopped,
    )
