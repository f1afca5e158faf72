# SPDX-License-Identifier: Apache-2.0
"""Lines 3 to 5 and 7 of Algorithm 1: the plan of a round, its ranges, and the box in u that they make."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import torch
from torch import Tensor

from ...claims.claim import Claim
from ...planning.advice import Advice, Advisor
from ...planning.types import Plan, PlanEntry
from ...schema import Instance, Values
from ...words.types import SceneDescription
from ..scene_facts import light_sizes
from ..shots import ShotState
from ..vector import ParameterVector, around, feasible_ranges, opened, project

_NEAR = 0.25  # share of a range, on either side of a variant's start, in which the variant stays


@dataclass(frozen=True)
class RoundStart:
    """A round before it is planned."""

    u: Tensor  # (N,) the point where the round begins
    shots: Sequence[ShotState]  # with the correction at u
    number: int = 0  # of the round, counted over all starts
    earlier: Plan = field(default_factory=Plan)  # the plan of the round before; empty for the first
    share: float = 1.0  # share of each component's feasible range by which the round may move from u
    opening: float = 0.0  # share of its width by which a range that words name opens at either end
    # for a variant: (components (N,) bool that stay near its start, the start (N,)), so that variants stay different
    near: tuple[Tensor, Tensor] | None = None
    turned: Mapping[str, PlanEntry] = field(default_factory=dict)  # a variant's own entries of the plan


@dataclass
class Confined:
    """A round with its plan and its feasible box: the result of lines 3 to 5 and 7 of Algorithm 1."""

    advice: Advice  # objects and attributes O, prompts p and negative prompts p⁻
    plan: Plan  # range and priority π_i of every parameter, by key
    ranges: dict[str, tuple[Values, Values]]  # key -> (l_i, u_i) in schema units, see `feasible_ranges`
    lower: Tensor  # (N,) lower corner of the feasible box in u
    upper: Tensor  # (N,) upper corner
    u: Tensor  # (N,) the point, projected into the box
    shots: Sequence[ShotState]  # they draw and judge images, corrected near u
    here: RoundStart  # the start that the round was planned from


@dataclass
class Confiner:
    """Plans the rounds of one vibe."""

    vector: ParameterVector
    shots: Sequence[ShotState]  # as loaded
    described: SceneDescription  # before any change
    advisor: Advisor
    replan: Callable[[Mapping[str, Instance], Plan], Plan]  # may change the advisor's plan, see `Method.plan`

    def __post_init__(self) -> None:
        self._widest: dict[str, float] = {}  # key of a light's size -> the largest size that fits in all shots
        for shot in self.shots:
            for own, size in light_sizes(shot.scene, shot.proxy.geometry).items():
                key = shot.names[own]
                self._widest[key] = min(self._widest.get(key, size), size)

    def advise(self, shots: Sequence[ShotState], u: Tensor, earlier: Plan) -> Advice:
        """The advice for the first shot at u (N,); its plan has entries for parameters of other shots, too.

        `earlier` is the plan of the round before, empty in the first, see `carry`.
        """
        advice = shots[0].advised(self.advisor, u, self.described)
        entries = {shots[0].names[own]: entry for own, entry in advice.plan.items()}
        for shot in shots[1:]:
            if not entries.keys() >= {*shot.names.values()}:
                plan = shot.advised(self.advisor, u, self.described).plan
                entries = {shot.names[own]: entry for own, entry in plan.items()} | entries
        instances = self.vector.instances
        plan = carry(Plan({key: entries[key] for key in instances}, advice.plan.notes), earlier)
        return replace(advice, plan=self.replan(instances, plan))

    def confined(
        self, advice: Advice, u: Tensor, here: RoundStart, shots: Sequence[ShotState], claims: Sequence[Claim]
    ) -> Confined:
        """The round planned by `advice`: plan, ranges, the box of the ranges, and u (N,) projected into the box."""
        vector, plan = self.vector, Plan({**advice.plan, **here.turned}, advice.plan.notes)
        ranges = feasible_ranges(plan, vector.instances, vector.values(u))
        if here.opening:
            # Ranges that words name open, but not those of materials: in a wider range a finish is not what its word says, and a
            # color has another hue.
            parameters = {key: vector.instances[key].parameter for key in plan}
            named = {k for k, e in plan.items() if e.is_named and not e.usual and parameters[k].group != "material"}
            measured = {f"film/{c.measure}" for c in claims if c.word and c.part == "picture"}
            whole = [key for key in named if parameters[key].family in measured]
            share = torch.where(vector.mark(named), here.opening, 0.0).masked_fill(vector.mark(whole), math.inf)
            wider = [vector.plain(end) for end in opened(*vector.bounds(ranges), share, vector.encode({}))]
            ranges |= {key: (wider[0][key], wider[1][key]) for key in named}
        for key, widest in self._widest.items():  # lights do not grow into surfaces
            (low,), (high,) = ranges[key]
            ranges[key] = (min(low, widest),), (min(high, widest),)
        lower, upper = vector.bounds(ranges)
        if here.near:
            some, point = here.near
            low_end, high_end = around(point, lower, upper, _NEAR)
            lower, upper = torch.where(some, low_end, lower), torch.where(some, high_end, upper)
        lower, upper = around(u, lower, upper, here.share)
        return Confined(advice, plan, ranges, lower, upper, project(u, lower, upper), shots, here)


def carry(plan: Plan, earlier: Plan) -> Plan:
    """The plan, with the earlier entry, no longer optimized, for parameters that only the `earlier` plan let move."""
    gone = {k: e for k, e in earlier.items() if e.prior < 1.0 and plan[k].prior == 1.0}
    held = {key: replace(entry, priority=None) for key, entry in gone.items()}
    return Plan({**plan, **held}, plan.notes)
