# SPDX-License-Identifier: Apache-2.0
"""Several starts: drawn in the plan's ranges, tried in a coarse pass, and chosen by loss and by how different their images are."""

from collections.abc import Mapping
from copy import copy
from dataclasses import replace

import torch
import torch.nn.functional as F
from torch import Tensor

from ...color.tensors import lab_from_srgb
from ...guidance.guide import claims_loss
from ...guidance.regions import Views
from ...planning.ranges import within
from ...planning.types import Plan, PlanEntry
from ...schema import Instance
from ..least_squares import fixed_views
from ..vector import ParameterVector, feasible_ranges
from .confiner import Confined, RoundStart
from .search import Search

VARIED = "left open by the words: varied, so that the variants differ"
_PER_VARIANT = 3  # starts that are tried for each variant: some have a high loss, some look alike
_ROAM: dict[str, tuple[float, float, bool]] = {  # least and largest change; True if both are factors
    "light/azimuth": (-75.0, 75.0, False),
    "light/elevation": (-15.0, 20.0, False),
    "light/size": (0.3, 3.0, True),
    "light/angle": (0.3, 3.0, True),
    "world/rotation": (-75.0, 75.0, False),
}
"""Parameters that may differ between variants if the words leave them open. Lights turn together, by the same share."""
_OF_RIGS = 0.45  # share of these changes for a rig's lights, so that they still fit their word
_CELLS = 16  # rows and columns of the grid whose cells are compared


def find_starts(search: Search) -> list[RoundStart]:
    """The starts of the search: one, or one for each variant.

    One start is the artist's scene, or with the option `starts` the best of so many random points. The first of several
    variants starts at the plan's own point, the others at random points whose images differ most after a few steps.
    """
    home, options = search.vector.encode({}), search.options
    number = max(options.starts, _PER_VARIANT * options.variants if search.several else 1)
    artist = RoundStart(home, search.shots)
    if number == 1:
        return [artist]
    now = search.confine(artist)
    plan = roam(search.vector.instances, now.plan) if search.several else now.plan
    box = search.vector.bounds(feasible_ranges(plan, search.vector.instances, search.vector.values(home)))
    drawn = draw_starts(search.vector, plan, now.u, box, number, options.seed)
    search.observer.stage(f"trying {number} starts")
    tried = []
    for point in drawn:
        here = RoundStart(point, now.shots, turned=turned(now.plan, search.vector, point))
        there = search.confiner.confined(now.advice, point, here, now.shots, search.claims)
        tried.append(_coarse_pass(search, point, there))
        if search.observer.stopped():
            break
    losses = [loss for _, loss, _ in tried]
    if not search.several:
        return [RoundStart(tried[losses.index(min(losses))][0], now.shots)]
    best, *others = most_diverse([display for _, _, display in tried], losses, options.variants)
    own = search.vector.mark(k for k, e in plan.items() if e.priority is not None and k != "film/exposure")
    starts = [RoundStart(tried[best][0], now.shots)]
    for place, i in enumerate(others, 1):
        u = tried[i][0]
        turn = turned(now.plan, search.vector, u)
        starts.append(RoundStart(u, now.shots, place * search.rounds, near=(own, u), turned=turn))
    return starts


def _coarse_pass(search: Search, point: Tensor, now: Confined) -> tuple[Tensor, float, Tensor]:
    """The end (N,) of a few steps with few crops, its loss with all crops, and the first shot's image (H, W, 3)."""
    few = []
    for shot in now.shots:
        guidance = copy(shot.guidance)
        assert guidance is not None
        guidance.views = Views(1, 1, 1)
        few.append(replace(shot.viewed(point), guidance=guidance))
    chosen = search.select(now, point, few)
    here, seed, loss = replace(now, u=point), search.options.seed, 0.0
    u = search.method.descend(here, chosen, 8, seed, lambda *_: search.observer.stopped()).u
    with torch.no_grad():
        for shot in now.shots:
            assert shot.guidance is not None
            image = shot.draw(u)
            loss += float(sum(shot.guidance(image.display, image.mask, fixed_views()).values()))
            if residuals := shot.missed(u):
                loss += float(search.method.weights.claims * claims_loss(residuals))
    return u, loss / len(now.shots), now.shots[0].draw(u).display


def draw_starts(
    vector: ParameterVector, plan: Plan, u: Tensor, box: tuple[Tensor, Tensor], number: int, seed: int
) -> list[Tensor]:
    """The point u (N,), and random points (N,) of the box, which differ from u in parameters that the plan optimizes.

    All components of a color are at the same place in their ranges, because other combinations are other hues.
    Parameters of one name that `roam` has opened share a place, too.
    """
    generator = torch.Generator().manual_seed(seed)
    keys = [key for key, entry in plan.items() if entry.priority is not None]
    starts = [u]
    for _ in range(number - 1):
        point = u.clone()
        places: dict[str, Tensor] = {}
        for key in keys:
            part, instance = vector.slices[key], vector.instances[key]
            group = instance.parameter.name if plan[key].reason == VARIED else key
            place = places.setdefault(group, torch.rand((), generator=generator, dtype=torch.float64))
            point[part] = box[0][part] + place * (box[1][part] - box[0][part])
        starts.append(point)
    return starts


def roam(instances: Mapping[str, Instance], plan: Plan) -> Plan:
    """The plan, with ranges for lighting parameters that the words leave open; if there is a rig, only for its own."""
    roaming = Plan(dict(plan), plan.notes)
    of_rig = any(entry.varies for entry in plan.values())
    for key, entry in plan.items():
        instance = instances[key]
        reach = _ROAM.get(instance.parameter.family)
        left_open = entry.varies if of_rig else entry.prior == 1.0
        if reach is None or instance.locked or not left_open:
            continue
        *ends, factors = reach
        value, share = instance.value[0], _OF_RIGS if entry.varies else 1.0
        low, high = ((value * end if factors else value + share * end) for end in ends)
        low, high = max(low, instance.lower[0]), min(high, instance.upper[0])
        roaming[key] = PlanEntry((low,), (high,), 99, VARIED, prior=0.0)  # after those that words name
    return roaming


def turned(plan: Plan, vector: ParameterVector, u: Tensor) -> dict[str, PlanEntry]:
    """Key -> entry for a rig's lights in a variant that starts at u (N,): the range has the plan's width around u."""
    values, found = vector.values(u), {}
    for key, entry in plan.items():
        if entry.varies:
            instance, half = vector.instances[key], (entry.upper[0] - entry.lower[0]) / 2.0
            ends = ((values[key][0] + side * half,) for side in (-1.0, 1.0))
            lower, upper = (within(end, instance.lower, instance.upper) for end in ends)
            found[key] = replace(entry, lower=lower, upper=upper, reason=VARIED, start=values[key])
    return found


def with_reasons(plan: Plan, vector: ParameterVector, u: Tensor) -> Plan:
    """The plan, with the reason `VARIED` for parameters that no word names and whose values at u (N,) have changed."""
    values, instances = vector.values(u), vector.instances
    roaming = (key for key, entry in plan.items() if instances[key].parameter.family in _ROAM and entry.prior == 1.0)
    varied = {key: replace(plan[key], reason=VARIED) for key in roaming if values[key] != instances[key].value}
    return Plan({**plan, **varied}, plan.notes)


def distance(a: Tensor, b: Tensor) -> float:
    """Difference of two images (H, W, 3): mean Lab distance of the cells of a coarse grid, which ignores fine detail."""
    labs = (lab_from_srgb(display.detach()).permute(2, 0, 1) for display in (a, b))
    first, other = (F.adaptive_avg_pool2d(lab, _CELLS) for lab in labs)
    return float((first - other).norm(dim=0).mean())


def most_diverse(pictures: list[Tensor], losses: list[float], number: int) -> list[int]:
    """Indices of up to `number` images (H, W, 3) that differ most: the first, and others of the half of least loss."""
    ranked = sorted(range(len(losses)), key=losses.__getitem__)
    good = ranked[: max(-(-len(ranked) // 2), number)]
    chosen = [0]
    while len(chosen) < min(number, len(pictures)):
        left = [i for i in good if i not in chosen] or [i for i in ranked if i not in chosen]
        chosen.append(max(left, key=lambda i: min(distance(pictures[i], pictures[j]) for j in chosen)))
    return chosen
