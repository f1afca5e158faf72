# SPDX-License-Identifier: Apache-2.0
"""From a prompt and exported scenes to values: Algorithm 1 of the paper, from each start. Comments name its lines; its θ is u.

Each round ends with a picture of Cycles. There is no other round when it shows all that the words claim. A round that ended
farther from them than an earlier one is taken back, and the next has the plan's own ranges again, or may go half as far. One
that came hardly nearer was the last. The best end of all is the result, with least change.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import torch
from torch import Tensor

from ..claims.claim import Claim, outside
from ..goals.resolve import Goals
from ..planning.advice import Prompts
from ..planning.types import Plan
from ..reference.like import Reference
from ..schema import Values
from .least_squares import Descent
from .rounds import starts
from .rounds.confiner import Confined, RoundStart, Start
from .rounds.search import Missed, Search
from .rounds.selection import Selection
from .shots import ShotState
from .vector import ParameterVector

CONVERGED = 0.005  # a round, other than the first, that lowers the loss by a smaller share is the last one

OPENING, WIDEST = 0.5, 1.0
"""Share of their ranges by which the ranges of a round are wider on either side than those of the one before, while
claims are missed; and the most that it comes to."""

PATIENCE = 2  # rounds that come no nearer to the words' claims, of which the second is the last

WORTH, WORTH_LIKE = 0.1, 0.05
"""A round that satisfies no further claim, and comes nearer to them by a smaller share, is the last: an artist sees no difference.
For a reference image of the same scene the share is smaller: its places are many, and all of them together are seen."""

_FAR = 0.05  # of a component's whole range: what has moved less is not worth a picture of Cycles
_KEPT = (0.0, 0.25, 0.5, 0.75)  # shares of its way that a support may keep, the least first
_SAME = 0.1  # noticeable steps by which a claim may be farther from what is sought


def run(search: Search) -> Outcome:
    """Finds the values that make the scene, or several shots of one look, look like the prompt.

    The same options give the same values, bit for bit, on a CPU. All outcomes are in the `variants` of that of least loss, where
    several are asked for. Raises VibeError if no word of the prompt is known, or nothing that the words touch may change.
    """
    search.show_plan()
    outcomes = []
    for start in starts.find_starts(search):
        outcomes.append(refine(search, start))
        if outcomes[-1].stopped:
            break
    outcomes.sort(key=lambda outcome: outcome.loss)
    return replace(outcomes[0], variants=outcomes) if search.several else outcomes[0]


def refine(search: Search, start: Start) -> Outcome:
    """The rounds from one start."""
    ends: list[RoundEnd] = []
    here: RoundStart | None = RoundStart.at(start)
    while here:  # 1: for r = 0 to R - 1
        began = time.monotonic()
        now = search.confine(here)  # 2: render, 3: parse, 4: compose, 5: confine, 7: project
        now = search.placed(now)
        chosen = search.select(now, now.u)  # 6: the update set S_K
        descent = search.descend(now, chosen)  # 8 to 15: T inner steps on S_K
        seconds = time.monotonic() - began
        # 16: the next θ is where the steps have led to, as Cycles has it
        ends.append(RoundEnd.seen(search, now, chosen, descent, seconds))
        if start.drawn is None and nearest(ends) is ends[-1]:
            search.show(ends[-1].shots, ends[-1].u)
        here = next_round(search, ends)
    return outcome_of(search, start, ends, least_change(search, ends))  # 18


@dataclass
class Outcome:
    """The result of a vibe."""

    vector: ParameterVector  # the parameters of u
    u: Tensor  # (N,) the best point that a round ended at; see `ParameterVector.values`
    plan: Plan  # that round's plan
    ranges: dict[str, tuple[Values, Values]]  # key -> that round's (lower, upper), as in `Confined`
    optimized: set[str]  # keys that some round optimized
    goals: Goals  # the words' wishes
    prompts: Prompts  # the encoder's captions
    claims: tuple[Claim, ...]  # of words and reference image
    shots: Sequence[ShotState]  # with their proxies corrected at u
    loss: float  # at u, when its round ended
    # one record per round: parameters, loss at start and end, its terms, how far its end was from the words' claims,
    # steps, seconds
    rounds: list[dict[str, Any]]
    descent: Descent | None = None  # of the round that ended at u
    reference: Reference | None = None  # the image that replaces words, or adds to them
    stopped: bool = False  # whether the observer ended the loop
    variants: list[Outcome] = field(default_factory=list)  # all, if several were asked for; least loss first


@dataclass(frozen=True)
class RoundEnd:
    """The end of a round, as Cycles has it."""

    u: Tensor  # (N,) the point
    shots: Sequence[ShotState]  # with their proxies corrected there
    missed: Missed  # distance of its images from the words' claims
    loss: float  # at the point, before that correction
    confined: Confined  # the round's plan and ranges
    record: dict[str, Any]  # for the report, see `Outcome.rounds`
    settled: bool  # whether the steps have hardly lowered the loss
    descent: Descent

    @classmethod
    def seen(
        cls, search: Search, now: Confined, chosen: Selection, descent: Descent, seconds: float
    ) -> RoundEnd:
        """The end of a round at the point that its steps have led to, of which Cycles renders a picture."""
        record = {
            "parameters": chosen.keys,
            "shared": chosen.shared,
            "loss": [descent.start_loss, descent.loss],
            **chosen.objective.account(descent.u),
            "steps": descent.steps,
            "repairs": descent.repairs,
            "advice": now.advice.source,
            "seconds": round(seconds, 3),
        }
        shots, missed = search.seen(now.shots, descent.u, now.here.number)
        record["missed"] = missed._asdict()
        settled = descent.start_loss - descent.loss < CONVERGED * abs(descent.start_loss)
        now = replace(now, plan=chosen.with_reasons(now.plan))
        return cls(descent.u, shots, missed, descent.loss, now, record, settled, descent)


def nearest(ends: Sequence[RoundEnd]) -> RoundEnd:
    """The end that shows most of the words' claims; of equals the last."""
    return min(reversed(ends), key=lambda end: end.missed)


def next_round(search: Search, ends: Sequence[RoundEnd]) -> RoundStart | None:
    """The round that follows the last one; None where that was the last."""
    last, best = ends[-1], nearest(ends)
    here = last.confined.here
    share, opening = here.share, here.opening
    has_claims = claims_words(last.shots)
    if len(ends) == search.rounds or not last.record["parameters"] or search.clock.stopped:
        return None
    if (has_claims and not last.missed.claims) or is_stuck(search, ends):
        return None

    # Ranges open while claims are missed; those of a round that went astray in wider ones are the plan's again.
    astray = best is not last
    too_wide = astray and opening > 0.0
    if has_claims and here.start.drawn is None:
        opening = 0.0 if too_wide else min(opening + OPENING, WIDEST)
    if astray and not too_wide:
        share *= 0.5
    return RoundStart(here.start, best.u, best.shots, here.number + 1, last.confined.plan, share, opening)


def is_stuck(search: Search, ends: Sequence[RoundEnd]) -> bool:
    """True if another round is worth nothing."""
    if len(ends) == 1:
        return False
    last, best, before = ends[-1], nearest(ends), nearest(ends[:-1]).missed
    if last.settled or best is not last:
        return last.settled or all(end.missed > best.missed for end in ends[-PATIENCE:])
    worth = WORTH_LIKE if search.reference and search.reference.same else WORTH
    gain = before.distance - last.missed.distance
    return last.missed.claims >= before.claims and gain < worth * before.distance


def claims_words(shots: Sequence[ShotState]) -> bool:
    """True if the words claim anything that can be measured in the images."""
    return any(shot.claims and shot.claims.words for shot in shots)


def least_change(search: Search, ends: Sequence[RoundEnd]) -> RoundEnd:
    """The best end; with least change, if that satisfies as many claims, which Cycles has to confirm."""
    best = nearest(ends)
    if not claims_words(best.shots) or best.confined.here.start.drawn is not None or search.clock.stopped:
        return best
    u = eased(search, best.shots, best.confined.plan, best.u)
    if u is None:
        return best
    shots, missed = search.seen(best.shots, u, ends[-1].confined.here.number)
    if missed.claims > best.missed.claims:
        return best
    search.show(shots, u)
    return replace(best, u=u, shots=shots, missed=missed)


def eased(search: Search, shots: Sequence[ShotState], plan: Plan, u: Tensor) -> Tensor | None:
    """A point with supports as near to the artist's values as the proxy's images allow.

    A round steps at once to where all claims are satisfied, and often past it: a dark car may need a little more light to be
    told from its floor, and gets a white floor in glaring light, for nothing that is claimed speaks against that.

    At u (N,) the shots are corrected; another point shows each claim as well. None if nothing is gained.
    """
    if search.pictured:  # of which all values are free alike
        return None
    vector = search.vector
    supports = vector.mark(key for key, e in plan.items() if e.priority is not None and e.prior > 0.0)
    moved = torch.where(supports, u - vector.encode({}), 0.0)
    if float(moved.abs().amax()) < _FAR:
        return None
    most = _distances(shots, u) + _SAME
    points = (u - (1.0 - kept) * moved for kept in _KEPT)
    return next((point for point in points if bool((_distances(shots, point) <= most).all())), None)


def _distances(shots: Sequence[ShotState], u: Tensor) -> Tensor:
    """(C,) noticeable steps between the images of u (N,) and what is sought of each claim, which lies inside of what satisfies it."""
    found = [torch.zeros(())]
    with torch.no_grad():
        for shot in shots:
            viewed = shot.viewed(u)
            for _, value, lower, upper in viewed.aims(viewed.draw(u)):
                found.append(outside(value, lower, upper).norm().cpu())
    return torch.stack(found)


def outcome_of(search: Search, start: Start, ends: Sequence[RoundEnd], best: RoundEnd) -> Outcome:
    """The result of the rounds from a start."""
    plan = best.confined.plan
    if start.drawn is not None:
        plan = starts.with_reasons(plan, search.vector, best.u)
    records = [end.record for end in ends]
    return Outcome(
        vector=search.vector,
        u=best.u,
        plan=plan,
        ranges=best.confined.ranges,
        optimized={key for record in records for key in record["parameters"]},
        goals=best.confined.advice.goals,
        prompts=best.confined.advice.prompts,
        claims=search.claims,
        shots=best.shots,
        loss=best.loss,
        rounds=records,
        descent=best.descent,
        reference=search.reference,
        stopped=search.clock.stopped,
    )
