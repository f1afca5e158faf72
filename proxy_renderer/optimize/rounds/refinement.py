# SPDX-License-Identifier: Apache-2.0
"""The rounds of Algorithm 1 of the paper: parse, compose, confine, select, project, inner steps, stabilize.

Every round is anchored: it works with a proxy that Cycles has corrected where the round starts.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from torch import Tensor

from ...claims.claim import Claim
from ...goals.resolve import Goals
from ...planning.captions import Prompts
from ...planning.types import Plan
from ...reference.like import Reference
from ...schema import Values
from ..anchoring import AnchorState
from ..shots import ShotState
from ..vector import ParameterVector
from . import starts
from .confiner import UNBOUND, Confined, RoundReach, Start
from .easing import eased
from .key_start import with_key_turned
from .search import Missed, Search

STRIDE = 0.05
"""A projection that moves no value by more than this share of its whole range is not worth another anchor."""

CONVERGED = 0.005
"""A round, other than the first, that lowers the loss by a smaller share is the last one."""

OPENING, WIDEST = 0.5, 1.0
"""Share of their ranges by which the ranges of a round are wider on either side than those of the one before, while
claims are missed; and the most that it comes to. After a round that went astray in wider ranges they are the plan's again."""

PATIENCE = 2
"""Rounds that come no nearer to what the words claim, after which one begins elsewhere, or none."""

ALIKE = 0.05
"""A round for a picture of this very scene that comes nearer to it by a smaller share is the last one: its places are many, and some
that paint keeps from the picture's color are missed to the end."""


@dataclass
class Outcome:
    """The result of a vibe.

    Attributes:
        vector: The parameters of u.
        u: (N,) the best point that a round ended at; see `ParameterVector.values`.
        plan: That round's plan.
        ranges: Key -> that round's (lower, upper) in schema units, azimuths turned as the values are.
        optimized: Keys that some round optimized.
        goals: What the words wish for.
        prompts: What the encoder was asked.
        claims: What the words, and a picture, claim of ours.
        rounds: One record per round: parameters, loss at start and end, its terms, how far its end was from what the
            words claim, steps, seconds.
        shots: The shots, each with its proxy and guidance.
        anchors: For each shot, the corrections that hold at u.
        loss: At u, when its round ended.
        reference: The picture in the place of words, or beside them.
        stopped: Whether the observer ended the loop.
        variants: All variants, if several were asked for; the one of least loss first.
    """

    vector: ParameterVector
    u: Tensor
    plan: Plan
    ranges: dict[str, tuple[Values, Values]]
    optimized: set[str]
    goals: Goals
    prompts: Prompts
    claims: tuple[Claim, ...]
    shots: list[ShotState]
    anchors: list[AnchorState]
    loss: float
    rounds: list[dict[str, Any]] = field(default_factory=list)
    reference: Reference | None = None
    stopped: bool = False
    variants: list[Outcome] = field(default_factory=list)

    def recall(self) -> None:
        """Corrects the proxies as they were at u."""
        recall(self.shots, self.anchors)


def recall(shots: Sequence[ShotState], anchors: Sequence[AnchorState]) -> None:
    """Corrects the proxies as they once were.

    Args:
        anchors: For each, the corrections of that time.
    """
    for shot, anchor in zip(shots, anchors, strict=True):
        shot.anchoring.recall(anchor)


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


class Refinement:
    """The rounds from one start.

    Where the paper writes θ, this is u: θ on perceptual scales. Comments name the algorithm's lines. A round begins
    with a picture of Cycles of where the one before ended. There is no other round when it shows all that the words
    claim. A round that ended farther from them than an earlier one is taken back, and the next has the plan's own ranges again,
    or may go half as far. When that does not help either, one round begins in the middle of all ranges. The best end of all is the result,
    with least change.
    """

    def __init__(self, search: Search, start: Start) -> None:
        self._search, self._start = search, start
        self._u, self._loss, self._reach = start.u, math.inf, UNBOUND
        self._last: Confined | None = None
        self._rounds: list[dict[str, Any]] = []
        self._ends: list[RoundEnd] = []
        self._settled = self._elsewhere = False
        # Variants stay near their own start; the middle of ranges as wide as a picture's is no better than any other point.
        self._tried_elsewhere = start.drawn is not None or search.reference is not None

    def run(self) -> Outcome:
        """Carries them out."""
        for _ in range(self._search.rounds):  # 1: r = 0 … R - 1
            if self._rounds and not self._goes_on():
                break
            if not self._round():
                break
        if len(self._ends) < len(self._rounds):
            self._see_end()
        best = self._eased(_nearest(self._ends))
        self._search.number += self._search.rounds - len(self._rounds)
        return self._outcome(best)  # 18

    def _eased(self, best: RoundEnd) -> RoundEnd:
        """The best end with least change, if Cycles confirms it; see `easing`."""
        search = self._search
        if (
            best.missed.claims
            or not search.claims_words
            or self._start.drawn is not None
            or search.clock.stopped
        ):
            return best
        recall(search.shots, best.anchors)
        u = eased(search, best.confined.plan, best.u)
        if u is None:
            return best
        end = self._seen(u, best.loss, best.confined)
        if end.missed.claims:
            return best
        search.show(u)
        return end

    def _goes_on(self) -> bool:
        """Sees how the last round ended, before a model is asked for another plan; chooses where the next one begins."""
        self._see_end()
        if self._search.claims_words and self._ends[-1].missed.claims == 0:
            return False
        nearest = _nearest(self._ends)
        astray = nearest is not self._ends[-1]
        share, opening = self._reach.share, self._reach.opening
        widely = astray and opening > 0.0
        if self._search.claims_words and self._start.drawn is None:
            opening = 0.0 if widely else min(opening + OPENING, WIDEST)
        stuck = (
            self._settled
            or self._is_as_alike_as_it_gets()
            or all(end.missed > nearest.missed for end in self._ends[-PATIENCE:])
        )
        self._elsewhere = stuck and self._search.claims_words and not self._tried_elsewhere
        if stuck and not self._elsewhere:
            return False
        if astray:
            self._u, share = nearest.u, share * (1.0 if widely else 0.5)
            recall(self._search.shots, nearest.anchors)
        if self._elsewhere:
            self._tried_elsewhere, share = True, 1.0
        self._reach = RoundReach(share, opening)
        return True

    def _is_as_alike_as_it_gets(self) -> bool:
        """Whether the last round has brought a picture of this very scene hardly nearer."""
        reference = self._search.reference
        if not (reference and reference.same) or len(self._ends) < 2:
            return False
        before = _nearest(self._ends[:-1]).missed.distance
        return before - self._ends[-1].missed.distance < ALIKE * before

    def _see_end(self) -> None:
        """Has Cycles show where the last round ended; its record says how far that is from the words."""
        assert self._last is not None
        self._ends.append(self._seen(self._u, self._loss, self._last))
        self._rounds[-1]["missed"] = self._ends[-1].missed._asdict()
        if self._start.drawn is None and _nearest(self._ends) is self._ends[-1]:
            self._search.show(self._u)

    def _seen(self, u: Tensor, loss: float, confined: Confined) -> RoundEnd:
        """An end at u (N,), of which Cycles renders a picture."""
        self._search.renew(u, self._search.number - 1)
        missed = self._search.missed(u)
        return RoundEnd(u, loss, confined, missed, [shot.anchoring.newest for shot in self._search.shots])

    def _round(self) -> bool:
        """Lines 2 to 16; returns whether another round may be worth it."""
        search, started = self._search, time.monotonic()
        plan = self._last.plan if self._last else Plan()
        now = search.confine(self._u, plan, self._start, self._reach)  # 2 to 5 and 7
        if self._elsewhere:
            now = replace(now, u=search.confiner.middle(now))
        elif not self._rounds and search.reference and search.reference.same:
            goal = search.reference.display
            scene, box = search.shots[0].scene, (now.lower, now.upper)
            now = replace(now, u=with_key_turned(scene, search.vector, now.u, *box, goal))
        search.renew(now.u, search.number, slack=STRIDE)
        chosen = search.select(now, now.u)  # 6: S_K
        self._last = replace(now, plan=chosen.with_reasons(now.plan))
        descent = search.descend(now, chosen)  # 8 to 15
        self._u, self._loss = descent.u, descent.loss  # 16
        search.number += 1
        self._rounds.append(
            {
                "parameters": chosen.keys,
                "shared": chosen.shared,
                "loss": [descent.start_loss, descent.loss],
                **chosen.objective.account(descent.u),
                "steps": descent.steps,
                "repairs": descent.repairs,
                "advice": now.advice.source,
                "seconds": round(time.monotonic() - started, 3),
            }
        )
        gained = descent.start_loss - descent.loss
        self._settled = len(self._rounds) > 1 and gained < CONVERGED * abs(descent.start_loss)
        return bool(chosen.keys) and not search.clock.stopped

    def _outcome(self, best: RoundEnd) -> Outcome:
        search, plan = self._search, best.confined.plan
        if self._start.drawn is not None:
            plan = starts.with_reasons(plan, search.vector, best.u)
        return Outcome(
            vector=search.vector,
            u=best.u,
            plan=plan,
            ranges=best.confined.ranges,
            optimized={key for record in self._rounds for key in record["parameters"]},
            goals=best.confined.advice.goals,
            prompts=best.confined.advice.prompts,
            claims=search.claims,
            shots=search.shots,
            anchors=best.anchors,
            loss=best.loss,
            rounds=self._rounds,
            reference=search.reference,
            stopped=search.clock.stopped,
        )


def _nearest(ends: list[RoundEnd]) -> RoundEnd:
    """The end that shows most of what the words claim; of equals the last."""
    return min(reversed(ends), key=lambda end: end.missed)
