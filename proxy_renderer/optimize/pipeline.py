# SPDX-License-Identifier: Apache-2.0
"""From a prompt and exported scenes to values: Algorithm 1 of the paper, from each start. Comments name its lines; its θ is u.

Each round ends with a Cycles image. The rounds end when the image satisfies all claims of the words, or when a round has come
hardly nearer to them. If a round ends farther from the claims than an earlier one, the next starts from the best end so far, with
the plan's own ranges or with half the reach. The result is the best end of all rounds, with supporting parameters moved back toward
the artist's values as far as the claims allow.
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
from .rounds.confiner import Confined, RoundStart
from .rounds.search import Missed, Search
from .rounds.selection import Selection
from .shots import ShotState
from .vector import ParameterVector

CONVERGED = 0.005  # a round, other than the first, that lowers the loss by a smaller share is the last one
OPENING, WIDEST = 0.5, 1.0  # share of a range's width that each further round adds at both ends; largest sum
PATIENCE = 2  # number of rounds in a row that come no nearer to the words' claims, after which the loop ends
WORTH, WORTH_LIKE = 0.1, 0.05
"""Share of the distance from the claims. A round that satisfies no further claim and reduces the distance by a smaller share is the
last: an artist sees no difference. The second is for a reference image of the same scene, whose many places add up."""

_FAR = 0.05  # share of a component's whole range: smaller moves are not worth a Cycles image to take back
_KEPT = (0.0, 0.25, 0.5, 0.75)  # shares of their moves that supporting parameters keep, tried in this order
_SAME = 0.1  # noticeable steps by which a claim's distance from its aim may grow when they move back


def run(search: Search) -> Outcome:
    """Finds the values that make the scene, or several shots of one look, look like the prompt.

    On a CPU the same options give the same values, bit for bit. If several variants are wanted, the outcome with the
    least loss has all outcomes in `variants`. Raises VibeError if no word of the prompt is known, or if nothing that
    the words touch may change.
    """
    search.show_plan()
    outcomes = []
    for start in starts.find_starts(search):
        outcomes.append(refine(search, start))
        if outcomes[-1].stopped:
            break
    outcomes.sort(key=lambda outcome: outcome.loss)
    return replace(outcomes[0], variants=outcomes) if search.several else outcomes[0]


def refine(search: Search, start: RoundStart) -> Outcome:
    """Runs the rounds from one start."""
    ends: list[RoundEnd] = []
    here: RoundStart | None = start
    while here:  # 1: for r = 0 to R - 1
        began = time.monotonic()
        now = search.confine(here)  # 2: render, 3: parse, 4: compose, 5: confine, 7: project
        now = search.placed(now)
        chosen = search.select(now, now.u)  # 6: the update set S_K
        descent = search.descend(now, chosen)  # 8 to 15: T inner steps on S_K
        seconds = time.monotonic() - began
        # 16: the next θ is the end of the steps, of which Cycles renders an image
        ends.append(RoundEnd.seen(search, now, chosen, descent, seconds))
        if not start.near and nearest(ends) is ends[-1]:
            search.show(ends[-1].shots, ends[-1].u)
        here = next_round(search, ends)
    return outcome_of(search, start, ends, least_change(search, ends))  # 18


@dataclass
class Outcome:
    """The result of a vibe."""

    vector: ParameterVector  # the parameters of u
    u: Tensor  # (N,) the best end of a round; see `ParameterVector.values`
    plan: Plan  # of the best round
    ranges: dict[str, tuple[Values, Values]]  # key -> (lower, upper) in the best round, as in `Confined`
    optimized: set[str]  # keys that any round optimized
    goals: Goals  # the words' wishes
    prompts: Prompts  # the encoder's captions
    claims: tuple[Claim, ...]  # of words and reference image
    shots: Sequence[ShotState]  # with their proxies corrected at u
    loss: float  # at u, at the end of its round
    rounds: list[dict[str, Any]]  # one record per round, see `RoundEnd.seen`
    descent: Descent | None = None  # of the round that ended at u
    reference: Reference | None = None  # the image that replaces words, or adds to them
    stopped: bool = False  # whether the observer ended the loop
    variants: list[Outcome] = field(default_factory=list)  # all outcomes if there are several, best first


@dataclass(frozen=True)
class RoundEnd:
    """The end of a round, with the shots corrected by its Cycles image."""

    u: Tensor  # (N,) the point
    shots: Sequence[ShotState]  # with their proxies corrected at u
    missed: Missed  # distance of the corrected images from the words' claims
    confined: Confined  # the round's plan and ranges
    record: dict[str, Any]  # for the report, see `Outcome.rounds`
    descent: Descent  # the result of the inner steps, with the loss before the correction

    @classmethod
    def seen(cls, search: Search, now: Confined, chosen: Selection, descent: Descent, seconds: float) -> RoundEnd:
        """The end of a round at the point where its steps ended; Cycles renders an image there, if it can."""
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
        return cls(descent.u, shots, missed, replace(now, plan=chosen.with_reasons(now.plan)), record, descent)


def nearest(ends: Sequence[RoundEnd]) -> RoundEnd:
    """The end of a round that is nearest to the words' claims; of equally near ends the last."""
    return min(reversed(ends), key=lambda end: end.missed)


def next_round(search: Search, ends: Sequence[RoundEnd]) -> RoundStart | None:
    """The start of the round after the last of these ends; None if no further round is worth it, or none is left."""
    last, best, has_claims = ends[-1], nearest(ends), claims_words(ends[-1].shots)
    if len(ends) == search.rounds or not last.record["parameters"] or search.clock.stopped:
        return None
    if (has_claims and not last.missed.claims) or is_stuck(search, ends):
        return None

    # Ranges open while claims are missed. If wider ranges led astray, the plan's own ranges return.
    here = last.confined.here
    share, opening, astray = here.share, here.opening, best is not last
    too_wide = astray and opening > 0.0
    if has_claims and not here.near:
        opening = 0.0 if too_wide else min(opening + OPENING, WIDEST)
    if astray and not too_wide:
        share *= 0.5
    plan, number = last.confined.plan, here.number + 1
    return replace(here, u=best.u, shots=best.shots, number=number, earlier=plan, share=share, opening=opening)


def is_stuck(search: Search, ends: Sequence[RoundEnd]) -> bool:
    """True if another round is not worth its time, see `CONVERGED`, `PATIENCE` and `WORTH`."""
    if len(ends) == 1:
        return False
    last, best, before = ends[-1], nearest(ends), nearest(ends[:-1]).missed
    if last.descent.start_loss - last.descent.loss < CONVERGED * abs(last.descent.start_loss):
        return True
    if best is not last:
        return all(end.missed > best.missed for end in ends[-PATIENCE:])
    worth = WORTH_LIKE if search.reference and search.reference.same else WORTH
    gain = before.distance - last.missed.distance
    return last.missed.claims >= before.claims and gain < worth * before.distance


def claims_words(shots: Sequence[ShotState]) -> bool:
    """True if the words claim anything that can be measured in the images."""
    return any(shot.claims and shot.claims.words for shot in shots)


def least_change(search: Search, ends: Sequence[RoundEnd]) -> RoundEnd:
    """The best end of a round, eased (see `eased`) if a Cycles image confirms that this misses no more claims."""
    best = nearest(ends)
    if not claims_words(best.shots) or best.confined.here.near or search.clock.stopped:
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
    """The point u (N,) with supporting parameters moved back to the artist's values, as far as the claims allow.

    None if they cannot, or have hardly moved. The steps of a round may move them farther than the claims need: a dark
    car may need a little more light to stand out from its floor, and gets a white floor in glaring light, because no
    claim contradicts that. The proxies, corrected at u, predict the claims.
    """
    if search.pictured:  # with a reference image all values may move freely
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
    """Noticeable steps (1 + C,) by which images of u (N,) miss the aims of C claims; the first number is always 0."""
    found = [torch.zeros(())]
    with torch.no_grad():
        for shot in shots:
            viewed = shot.viewed(u)
            for _, value, lower, upper in viewed.aims(viewed.draw(u)):
                found.append(outside(value, lower, upper).norm().cpu())
    return torch.stack(found)


def outcome_of(search: Search, start: RoundStart, ends: Sequence[RoundEnd], best: RoundEnd) -> Outcome:
    """The result of a start: the `best` end of its rounds, and the records of all `ends`."""
    plan = best.confined.plan
    if start.near:
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
        loss=best.descent.loss,
        rounds=records,
        descent=best.descent,
        reference=search.reference,
        stopped=search.clock.stopped,
    )
