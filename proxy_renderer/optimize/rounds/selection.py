# SPDX-License-Identifier: Apache-2.0
"""The update set S_K of a round (equation 7; Algorithm 1, line 6): the parameters that serve the claims most, without duplicates.

Many parameters have the same effect on an image: exposure and the power of a light, or the color of a light and the film's gain.
The claims cannot tell their values apart (the paper's scale ambiguity). So parameters are chosen one after the other, by what each
can add to those before it, as in orthogonal matching pursuit (Pati, Rezaiifar and Krishnaprasad 1993). A parameter that has the
same effect as a chosen one, and can add hardly anything to it, is held for the round.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import torch
from torch import Tensor

from ...guidance.guide import Weights
from ...planning.types import LEFT_ALONE, Plan
from ...schema import VibeError
from ...schema.messages import Options
from ..least_squares import LinearModel, linearize
from ..objective import RoundObjective
from ..shots import ShotState
from ..vector import ParameterVector
from .confiner import Confined

_HALF = 1.5  # added to a parameter's priority number for each halving of its gain
_MISSED = 3.0  # added to `_HALF`, times `RoundStart.opening`: while claims stay missed, gain counts more than words
_FAINTEST = 2.0**-20  # least share of the largest gain that is counted
_WORTH = 1.0  # noticeable steps that supporting parameters have to gain to be candidates at all
ALIKE = 0.9  # share of a parameter's effect on the claims, reproduced by another, above which both are alike
_NOTHING_NEW = 0.1  # share of its gain alone that is left next to an alike one, up to which it is held


@dataclass(frozen=True)
class Selection:
    """The parameters that a round optimizes, and its objective."""

    keys: list[str]  # S_K, the most useful first
    objective: RoundObjective  # differentiable in all candidates
    shared: dict[str, str] = field(default_factory=dict)  # held key -> key of S_K with the same effect on the claims
    model: LinearModel | None = None  # at the point where S_K was chosen, over its components; None if it is not known

    def movable(self, now: Confined) -> Tensor:
        """(N,) bool, True for the components of S_K whose range in the round has a width."""
        return self.objective.vector.mark(self.keys) & (now.upper > now.lower)

    def with_reasons(self, plan: Plan) -> Plan:
        """The plan, in which the reasons of held parameters say why they are held."""
        why = {key: f"held: {other} does the same to what is claimed" for key, other in self.shared.items()}
        held = {key: replace(plan[key], reason=f"{plan[key].reason}; {text}") for key, text in why.items()}
        return Plan({**plan, **held}, plan.notes)


def select(
    now: Confined, vector: ParameterVector, shots: Sequence[ShotState], u: Tensor, options: Options, weights: Weights
) -> Selection:
    """S_K (equation 7), at most `top_k` parameters, chosen at u (N,); VibeError if words name none that may change."""
    plan, lower, upper = now.plan, now.lower, now.upper
    movable = relevant(plan, vector, upper > lower)
    # A moved camera means tracing all rays again, so it only moves if words name it.
    probed = {k for k in movable if vector.instances[k].parameter.group != "camera" or plan[k].is_named}
    pictured = bool(now.advice.goals.pictured)
    objective = RoundObjective(shots, vector, plan, probed, (lower, upper), weights, pictured)
    if not probed:  # the words only link lights
        return Selection([], objective)

    # The model at u over all candidates, in shares of their ranges, and the slice of each key's components
    wide = vector.mark(probed) & (upper > lower)
    before, span = wide.cumsum(0), (upper - lower)[wide]
    model = linearize(objective, u, wide, span)
    low, high = (lower - u)[wide] / span, (upper - u)[wide] / span
    parts = {}
    for key in sorted(probed):
        end = int(before[vector.slices[key].stop - 1])
        parts[key] = slice(end - int(wide[vector.slices[key]].sum()), end)

    candidates = needed(plan, model, parts, low, high)
    keys, shared = choose(plan, options.top_k, model, candidates, low, high, _HALF + _MISSED * now.here.opening)
    return Selection(keys, objective, shared, model.of(vector.mark(keys)[wide]))


def relevant(plan: Plan, vector: ParameterVector, wide: Tensor) -> set[str]:
    """The keys that a round may change; `wide` (N,) bool marks the components whose range has a width.

    If words name none of these keys but link lights, the result is empty; if they do not, VibeError is raised.
    """
    found = {k for k, e in plan.items() if e.priority is not None and wide[vector.slices[k]].any()}
    if all(plan[key].prior > 0.0 and not plan[key].any_hue for key in found):
        if vector.links:
            return set()
        left_alone = [note for note in plan.notes if note.startswith(LEFT_ALONE)]
        problem = " ".join(["Nothing that the words name may change in this scene.", *left_alone])
        raise VibeError(problem, "Unlock something, allow more groups, or use other words.")
    return found


def needed(
    plan: Plan, model: LinearModel, parts: Mapping[str, slice], low: Tensor, high: Tensor
) -> Mapping[str, slice]:
    """The parts (key -> slice) that words name, or all parts if the others lower the predicted loss enough."""
    named = {key: part for key, part in parts.items() if plan[key].is_named}
    free = torch.zeros(len(low), dtype=torch.bool)
    for part in named.values():
        free[part] = True
    alone = model.loss(model.step(torch.where(free, low, 0.0), torch.where(free, high, 0.0)))
    together = model.loss(model.step(low, high))
    return named if named and alone - together < _WORTH * model.weight else parts


def choose(
    plan: Plan, k: int, model: LinearModel, parts: Mapping[str, slice], low: Tensor, high: Tensor, half: float = _HALF
) -> tuple[list[str], dict[str, str]]:
    """Keys of the K most important parameters, and a mapping: key of a held one -> the chosen one with the same effect.

    The gain of a parameter is how far it can still lower the loss next to those chosen before. The smallest priority
    number comes first, to which each halving of the gain adds `half`. So a parameter at the right end of its range, or
    without effect on the loss, makes room for one that helps. A color counts as one parameter.
    """
    move, free = torch.zeros_like(low), torch.zeros(len(low), dtype=torch.bool)
    left = dict(parts)
    keys: list[str] = []
    shared: dict[str, str] = {}
    gains = alone = model.gains(move, left, low, high)
    most = max(alone.values(), default=0.0)

    def rank(key: str) -> tuple[float, str]:
        share = gains[key] / most if most > 0.0 else 1.0
        return (plan[key].priority or 0) - half * math.log2(max(share, _FAINTEST)), key

    while left and len(keys) < k:
        keys.append(best := min(left, key=rank))
        part = left.pop(best)
        free[part] = True
        move = model.step(torch.where(free, low, 0.0), torch.where(free, high, 0.0))
        gains = model.gains(move, left, low, high)
        same = [key for key, other in left.items() if model.alike(other, part) > ALIKE]
        shared |= {key: best for key in same if gains[key] <= _NOTHING_NEW * alone[key]}
        left = {key: other for key, other in left.items() if key not in shared}
    return keys, shared
