# SPDX-License-Identifier: Apache-2.0
"""The confiner, lines 2 to 5 and 7 of Algorithm 1: what advice says is made ranges of all parameters, and a box of u."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import torch
from torch import Tensor

from ...claims.claim import Claim
from ...planning.advice import Advice, Advisor
from ...planning.types import Plan, PlanEntry
from ...prompt.types import SceneDescription
from ...schema import Instance, Values
from .. import context, headroom
from ..plan import carry, feasible_ranges
from ..shots import ShotState
from ..vector import ParameterVector, around, opened, project
from . import starts


@dataclass
class Start:
    """Where a refinement starts.

    Attributes:
        u: (N,) the point.
        drawn: (N,) bool, the components that were drawn at random; they stay near u. None for the artist's scene.
    """

    u: Tensor
    drawn: Tensor | None = None


@dataclass
class Confined:
    """A round, confined: lines 3 to 5 and 7 of Algorithm 1.

    Attributes:
        advice: Objects and attributes O, prompts p and negative prompts p⁻.
        plan: Range and priority π_i of every parameter, by key.
        ranges: Key -> (l_i, u_i) in schema units, azimuths turned to where the values are.
        lower: (N,) lower corner of the feasible box in u.
        upper: (N,) upper corner.
        u: (N,) the point, projected into the box.
        opening: By how much ranges are wider than the plan's, since claims are missed; 0 in the first round.
    """

    advice: Advice
    plan: Plan
    ranges: dict[str, tuple[Values, Values]]
    lower: Tensor
    upper: Tensor
    u: Tensor
    opening: float = 0.0


@dataclass(frozen=True)
class RoundReach:
    """How far a round may go.

    Attributes:
        share: From where it begins, of each component's feasible range.
        opening: By how much ranges that words name are wider than the plan's on either side, likewise.
    """

    share: float = 1.0
    opening: float = 0.0


UNBOUND = RoundReach()
"""A round may go as far as its plan says, and no farther."""


class Confiner:
    """Of one vibe.

    Args:
        vector: The parameters of u.
        shots: One or several; plans are made for the first.
        described: The scene, before any change.
        advisor: Understands words and picture, and plans.
        replan: Makes the plan of a round from the scene's parameters and the advisor's plan, see `Method.plan`.

    Attributes:
        advisor: As given.
    """

    def __init__(
        self,
        vector: ParameterVector,
        shots: Sequence[ShotState],
        described: SceneDescription,
        advisor: Advisor,
        replan: Callable[[Mapping[str, Instance], Plan], Plan],
    ) -> None:
        self._vector, self._shots, self.advisor, self._replan = vector, shots, advisor, replan
        self._described, self._widest = described, _sizes(shots)

    def advise(self, u: Tensor, earlier: Plan) -> Advice:
        """The advice for the first shot at u (N,); its plan has entries of the others for what only they have.

        Args:
            u: (N,) the point.
            earlier: The plan of the round before; empty for the first.
        """
        advice: Advice | None = None
        entries: dict[str, PlanEntry] = {}
        for shot in self._shots:
            if advice and all(key in entries for key in shot.names.values()):
                continue
            picture = shot.draw(u)
            now = context.described_now(self._described, shot.proxy, shot.vector.values(u), picture)
            asked = self.advisor.advise(picture.display, shot.vector.instances, now)
            unplaced = {key: entry for key, entry in asked.plan.items() if key not in asked.placed}
            mine = asked.plan | headroom.nearer(shot.scene, shot.proxy.geometry, unplaced)
            entries = {shot.names[own]: entry for own, entry in mine.items()} | entries
            advice = advice or asked
        assert advice is not None
        instances = self._vector.instances
        plan = carry(Plan({key: entries[key] for key in instances}, advice.plan.notes), earlier)
        return replace(advice, plan=self._replan(instances, plan))

    def confined(
        self, advice: Advice, u: Tensor, start: Start | None, reach: RoundReach, claims: Sequence[Claim]
    ) -> Confined:
        """The round of a plan: its ranges, their box, and u projected into it.

        Args:
            u: (N,) the point.
            start: Where this refinement started; None for the artist's scene.
            reach: How far from u the round may go.
        """
        ranges = self._ranges(advice.plan, u, reach.opening, claims)
        lower, upper = self._vector.bounds(ranges)
        if start and start.drawn is not None:
            lower, upper = starts.corral(start.u, lower, upper, start.drawn)
        lower, upper = around(u, lower, upper, reach.share)
        return Confined(advice, advice.plan, ranges, lower, upper, project(u, lower, upper), reach.opening)

    def middle(self, now: Confined) -> Tensor:
        """(N,) another start: what is relevant stands in the middle of its range."""
        movable = self._vector.mark(key for key, entry in now.plan.items() if entry.priority is not None)
        return torch.where(movable & (now.upper > now.lower), (now.lower + now.upper) / 2, now.u)

    def _ranges(
        self, plan: Plan, u: Tensor, opening: float, claims: Sequence[Claim]
    ) -> dict[str, tuple[Values, Values]]:
        """The plan's ranges at u (N,), those that words name opened; lamps stay so small that they touch nothing."""
        vector = self._vector
        ranges = feasible_ranges(plan, vector.instances, vector.values(u))
        if opening:
            named = {key for key, entry in plan.items() if self._opens(key, entry)}
            measured = {claim.measure for claim in claims if claim.word and claim.part == "picture"}
            whole = [key for key in named if self._family(key) in {f"film/{name}" for name in measured}]
            share = torch.where(vector.mark(named), opening, 0.0).masked_fill(vector.mark(whole), math.inf)
            low, high = map(vector.plain, opened(*vector.bounds(ranges), share, vector.encode({})))
            ranges |= {key: (low[key], high[key]) for key in named}
        for key, widest in self._widest.items():
            low_end, high_end = ((min(end[0], widest),) for end in ranges[key])
            ranges[key] = low_end, high_end
        return ranges

    def _opens(self, key: str, entry: PlanEntry) -> bool:
        """Whether a range may open while claims are missed: one that words name, but no finish, which is what its word says."""
        parameter = self._vector.instances[key].parameter
        finish = parameter.group == "material" and parameter.kind != "color"
        return entry.is_named and not (entry.usual or finish)

    def _family(self, key: str) -> str:
        return self._vector.instances[key].parameter.family


def _sizes(shots: Sequence[ShotState]) -> dict[str, float]:
    """Key of a lamp's size -> the most that it may be in any shot."""
    widest: dict[str, float] = {}
    for shot in shots:
        for own, size in headroom.sizes(shot.scene, shot.proxy.geometry).items():
            key = shot.names[own]
            widest[key] = min(widest.get(key, size), size)
    return widest
