# SPDX-License-Identifier: Apache-2.0
"""The inner loop by least squares: damped Gauss-Newton steps in the box, on what the words claim of the pictures.

A claim is a residual, in steps that people notice. Residuals and parameters are few, so such a step is cheap, and worth
many gradient steps. The terms of similarity, and the pull to the artist's values, are followed by their gradient. The
region that slopes are trusted in is a rectangle (Voglis and Lagaris 2004), for the box is one. Slopes cost more
than steps; between the times that they are taken, they are mended by what the steps show, as in the secant
version of Levenberg-Marquardt (Madsen, Nielsen and Tingleff 2004, section 3.5).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Protocol

import torch
from torch import Tensor

from ..vector import project
from .assessment import Assessment, Slopes
from .descent import Descent
from .linear_model import LinearModel

_TAKEN = 2
"""Times that slopes are taken in one loop."""

_RADIUS, _SMALLEST = 0.35, 0.01
"""Of the region, as shares of each component's feasible range: at first, and where the loop ends."""

_GOOD, _BAD = 0.7, 0.2
"""Shares of the foretold decrease beyond which the region grows, and below which it shrinks."""

_PROGRESS = 1e-3
"""A foretold decrease that is not worth a picture."""


class ClaimObjective(Protocol):
    """Pictures of u, and what the words say of them."""

    @property
    def claim_weight(self) -> float:
        """Of a noticeable step by which a claim is missed."""

    def stiffness(self, chosen: Tensor) -> Tensor:
        """(n, n) curvature of the rest by the places of the n chosen components (N,) in their ranges, as far as it is known."""

    def assess(self, u: Tensor) -> Assessment:
        """What is judged at u (N,) in [0, 1]."""

    def slopes(self, u: Tensor, chosen: Tensor) -> Slopes:
        """How what is judged at u (N,) changes by the n chosen components (N,)."""


def solve(
    objective: ClaimObjective,
    u: Tensor,
    chosen: Tensor,
    lower: Tensor,
    upper: Tensor,
    steps: int,
    on_step: Callable[[int, float, Any], bool],
    first: LinearModel | None = None,
) -> Descent:
    """Minimizes the objective over the chosen components.

    Args:
        u: (N,) start, inside the box.
        chosen: (N,) bool, the components that may move.
        lower: (N,) lower corner of the feasible box.
        upper: (N,) upper corner.
        steps: The most points that are looked at after the start.
        on_step: Called with (step from 1, loss, picture) after each; True ends the loop.
        first: The model of the chosen components' shares of their ranges at the start, if there is one already.
    """
    if not chosen.any():
        return Descent(u.clone(), 0.0, 0.0)
    places = chosen.nonzero(as_tuple=True)[0]
    start, span = u[chosen], (upper - lower)[chosen]
    low, high = (lower[chosen] - start) / span, (upper[chosen] - start) / span

    def place(x: Tensor) -> Tensor:
        """u with the chosen components moved by x, in shares of their ranges."""
        return u.index_put((places,), start + span * x)

    def linear(x: Tensor) -> LinearModel:
        return linearize(objective, place(x), chosen, span)

    x, radius, taken, fresh = torch.zeros_like(start), _RADIUS, 1, True
    model = first or linear(x)
    loss = model.loss(x)
    found = Descent(u.clone(), loss, loss, repairs=int(not math.isfinite(loss)))
    while math.isfinite(found.loss) and found.steps < steps and radius > _SMALLEST:
        move = model.step((low - x).clamp_min(-radius), (high - x).clamp_max(radius))
        foretold = found.loss - model.loss(move)
        if foretold > _PROGRESS:
            with torch.no_grad():
                seen = objective.assess(project(place(x + move), lower, upper))
            loss = seen.loss(seen.values, seen.rest, objective.claim_weight)
            share = (found.loss - loss) / foretold if math.isfinite(loss) else -math.inf
            radius = _resized(radius, share, float(move.abs().max()))
            found.steps += 1
            if share > 0.0:
                model, x, fresh = model.moved(seen, move), x + move, False
                found.loss, found.u = loss, project(place(x), lower, upper)
            elif math.isfinite(loss):
                model = model.corrected(seen, move)
            else:
                found.repairs += 1
            if on_step(found.steps, found.loss, seen.picture):
                break
            if share >= _BAD or fresh:
                continue
        if fresh or taken == _TAKEN:
            break
        model, taken, fresh = linear(x), taken + 1, True
    return found


def linearize(objective: ClaimObjective, u: Tensor, chosen: Tensor, span: Tensor) -> LinearModel:
    """The model at a point, over its chosen components' shares of their ranges.

    Args:
        u: (N,) the point.
        chosen: (N,) bool, n components.
        span: (n,) their ranges.
    """
    here, values, rest = objective.slopes(u, chosen)
    return LinearModel(here, values * span, rest * span, objective.stiffness(chosen), objective.claim_weight)


def _resized(radius: float, share: float, length: float) -> float:
    """The region's next radius, after a step of a length that gave this share of what was foretold."""
    if share < _BAD:
        return 0.4 * length
    return max(radius, min(2.0 * length, 1.0)) if share > _GOOD else radius
