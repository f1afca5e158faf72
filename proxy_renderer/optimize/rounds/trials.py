# SPDX-License-Identifier: Apache-2.0
"""Where refinements start: the artist's scene, or what did best of several points in a coarse pass."""

from __future__ import annotations

from copy import copy
from dataclasses import replace

import torch
from torch import Tensor

from ...guidance.losses import claims_loss
from ...guidance.regions import Views
from ...planning.types import Plan
from ...render.proxy import Render
from ..least_squares import fixed_views
from ..shots import ShotState
from . import starts
from .confiner import Confined, Start, feasible_ranges
from .search import Search


def find_starts(search: Search) -> list[Start]:
    """The artist's scene; with variants or several starts, points drawn in the plan's ranges and tried in a coarse pass.

    Returns:
        One start for each variant: those of least loss among which the pictures differ most.
    """
    home = search.vector.encode({})
    number = starts.count(search.options)
    if number == 1:
        return [Start(home)]
    now = search.confine(home, Plan(), None)
    plan = starts.roam(search.vector.instances, now.plan) if search.several else now.plan
    ranges = feasible_ranges(plan, search.vector.instances, search.vector.values(home))
    box = search.vector.bounds(ranges)
    drawn = starts.draw_starts(search.vector, plan, now.u, box, number, search.options.seed)
    search.observer.stage(f"trying {number} starts")
    tried = []
    for point in drawn:
        tried.append(_try(search, point, now))
        if search.observer.stopped():
            break
    losses = [loss for _, loss, _ in tried]
    if not search.several:
        return [Start(tried[min(range(len(tried)), key=losses.__getitem__)][0])]
    chosen = starts.most_diverse([display for _, _, display in tried], losses, search.options.variants)
    own = search.vector.mark(k for k, e in plan.items() if e.priority is not None and k != "film/exposure")
    return [Start(tried[i][0], own if i else None) for i in chosen]


def _try(search: Search, point: Tensor, now: Confined) -> tuple[Tensor, float, Tensor]:
    """A coarse pass: a few steps on few views.

    Returns:
        The end point (N,), its loss on all views, and the first shot's picture (H, W, 3).
    """
    chosen = search.select(now, point, [_with_few_views(shot) for shot in search.shots])
    movable = search.vector.mark(chosen.keys) & (now.upper > now.lower)

    def stop_asked(step: int, loss: float, picture: Render) -> bool:
        """The coarse pass reports no progress."""
        return search.observer.stopped()

    here, seed = replace(now, u=point), search.options.seed
    u = search.method.descend(here, chosen, movable, starts.COARSE_STEPS, seed, stop_asked).u
    with torch.no_grad():
        pictures = [shot.draw(u) for shot in search.shots]
        weight = search.method.weights.claims
        losses = [_loss(shot, picture, weight) for shot, picture in zip(search.shots, pictures, strict=True)]
    return u, sum(losses) / len(losses), pictures[0].display


def _with_few_views(shot: ShotState) -> ShotState:
    """The same shot, judged on few views."""
    guidance = copy(shot.guidance)
    assert guidance is not None
    guidance.views = Views(1, 1, 1)
    return replace(shot, guidance=guidance)


def _loss(shot: ShotState, picture: Render, weight: float) -> float:
    """How far a picture is from the words: what the encoder is asked for, and claims, which count by a weight."""
    assert shot.guidance is not None
    terms = [*shot.guidance(picture.display, picture.mask, fixed_views()).values()]
    if residuals := shot.residuals(picture):
        terms.append(weight * claims_loss(residuals))
    return float(sum(terms))
