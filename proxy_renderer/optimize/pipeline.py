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
from .search import Confined, Missed, Search, Start
from .shots import ShotInput, ShotState
from .vector import ParameterVector

STRIDE = 0.05
"""A projection that moves no value by more than this share of its whole range is not worth another anchor."""

CONVERGED = 0.005
"""A round, other than the first, that lowers the loss by a smaller share is the last one."""

PATIENCE = 2
"""Rounds that come no nearer to what the words claim, after which there is no other one."""


@dataclass
class Outcome:
    """The result of a vibe.

    Attributes:
        vector: The parameters of u.
        u: (N,) the best point that a round ended at; see `ParameterVector.values`.
        plan: That round's plan.
        ranges: Key -> that round's (lower, upper) in schema units, azimuths turned as the values are.
        optimized: Keys that some round optimized.
        parsed: The prompt, understood.
        prompts: What the encoder was asked.
        rounds: One record per round: parameters, loss at start and end, its terms, how far its end was from what the
            words claim, steps, seconds.
        shots: The shots, each with its proxy and guidance.
        anchors: For each shot, the corrections that hold at u.
        loss: At u, when its round ended.
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


@dataclass(frozen=True)
class RoundEnd:
    """Where a round ended, seen by Cycles.

    Attributes:
        u: (N,) the point.
        loss: At it.
        confined: The round's plan and ranges.
        missed: How far its picture is from what the words claim.
        anchors: For each shot, the corrections that hold there.
    """

    u: Tensor
    loss: float
    confined: Confined
    missed: Missed
    anchors: list[AnchorState]


def refine(search: Search, start: Start) -> Outcome:
    """The rounds of Algorithm 1 from one start.

    Where the paper writes θ, this is u: θ on perceptual scales. Comments name the algorithm's lines. A round begins
    with a picture of Cycles of where the one before ended. The best of these ends is the result, and there is no other
    round when it shows all that the words claim, or when none has come nearer to it for a while.

    Args:
        search: What all starts share.
        start: Where to start.
    """
    u, plan, loss = start.u, Plan(), math.inf
    rounds: list[dict[str, Any]] = []
    ends: list[RoundEnd] = []
    last: Confined | None = None
    for number in range(search.rounds):  # 1: r = 0 … R - 1
        started = time.monotonic()
        if last:  # before a model is asked for another plan
            search.renew(u, search.number)
            ends.append(_end(search, u, loss, last, rounds[-1]))
            if _settled(search, ends):
                break
        confined = search.confine(u, plan, start)  # 2 to 5 and 7: render, parse, compose, confine, project
        last, plan = confined, confined.plan
        search.renew(confined.u, search.number, slack=STRIDE)
        chosen, objective = search.objective(confined, confined.u)  # 6: S_K
        movable = search.vector.mark(chosen) & (confined.upper > confined.lower)
        box = confined.lower, confined.upper
        seed = search.options.seed * 1000 + search.number
        follow = search.clock.follow(search.number)
        steps = search.options.steps
        descent = descend(
            objective, confined.u, movable, *box, steps, seed, StepSettings(), follow
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
    if last and len(ends) < len(rounds):
        search.renew(u, search.number - 1)
        ends.append(_end(search, u, loss, last, rounds[-1]))
    search.number += search.rounds - len(rounds)
    return _outcome(search, start, min(reversed(ends), key=lambda end: end.missed), rounds)  # 18


def _end(search: Search, u: Tensor, loss: float, confined: Confined, record: dict[str, Any]) -> RoundEnd:
    """A round's end at u (N,), where the proxies are corrected; its record says how far it is from the words."""
    missed = search.missed(u)
    record["missed"] = missed._asdict()
    return RoundEnd(u, loss, confined, missed, [shot.anchoring.newest for shot in search.shots])


def _settled(search: Search, ends: list[RoundEnd]) -> bool:
    """Whether a round's end shows all that the words claim, or the last few came no nearer than an earlier one."""
    if search.claims_words and ends[-1].missed.claims == 0:
        return True
    nearest = min(end.missed for end in ends)
    return all(end.missed > nearest for end in ends[-PATIENCE:])


def _outcome(search: Search, start: Start, best: RoundEnd, rounds: list[dict[str, Any]]) -> Outcome:
    plan = best.confined.plan
    if start.drawn is not None:
        plan = starts.with_reasons(plan, search.vector, best.u)
    return Outcome(
        vector=search.vector,
        u=best.u,
        plan=plan,
        ranges=best.confined.ranges,
        optimized={key for record in rounds for key in record["parameters"]},
        parsed=best.confined.advice.parsed,
        prompts=best.confined.advice.prompts,
        shots=search.shots,
        anchors=best.anchors,
        loss=best.loss,
        rounds=rounds,
        stopped=search.clock.stopped,
    )
