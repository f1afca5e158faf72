# SPDX-License-Identifier: Apache-2.0
"""One round's inner steps (lines 8 to 15): what is judged at a point, its linear model, and damped Gauss-Newton steps in the box."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, Protocol

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor

from ..claims.claim import outside
from .vector import project

_DAMPING = 1e-3  # curvature of every component: of two equal moves, the shorter one (Levenberg 1944)
_ITERATIONS, _STILL = 200, 1e-5  # most of a step's search, and the share of all ranges that is no move
_NOTHING = 1e-3  # noticeable steps of all values together, for a component's whole range, that change nothing
_TELLING = 2  # values more than components that could do the same, at least, to say that they do
_TAKEN = 2  # times that slopes are taken in one loop
_RADIUS, _SMALLEST = 0.35, 0.01  # of the region, as shares of feasible ranges: at first, and at the end
_GOOD, _BAD = 0.7, 0.2  # shares of the predicted decrease beyond which it grows, and below which it shrinks
_TINY = 1e-12  # squared length of a move that is none
_PROGRESS = 1e-3  # a predicted decrease that is not worth a picture


@dataclass(frozen=True)
class Assessment:
    """The judgment of the images of a point."""

    values: Tensor  # (M,) of the claims' measures, in noticeable steps
    lower: Tensor  # (M,) of the interval that is sought, likewise
    upper: Tensor  # (M,) likewise
    claim: Tensor  # (M,) number of the claim that each belongs to, from 0
    rest: Tensor  # () the loss's other terms
    picture: Any  # the first shot's
    finish: Tensor | None = None  # (M,) bool: values of claims about a surface's finish; None if nobody asks

    def misses(self, values: Tensor) -> Tensor:
        """(claims,) noticeable steps by which values (M,) miss each claim."""
        count = int(self.claim.max()) + 1 if len(self.claim) else 0
        squares = outside(values, self.lower, self.upper).square()
        return values.new_zeros(count).index_add(0, self.claim, squares).sqrt()

    def loss(self, values: Tensor, rest: Tensor, weight: float) -> float:
        """The loss of values (M,) and a rest (): missed claims, quadratic up to one noticeable step and linear beyond (Huber 1964)."""
        misses = self.misses(values)
        return weight * float(F.huber_loss(misses, torch.zeros_like(misses), reduction="sum")) + float(rest)

    def detached(self) -> Assessment:
        """The same without gradients."""
        return replace(self, values=self.values.detach(), rest=self.rest.detach())


class Slopes(NamedTuple):
    """The judgment of a point, without gradients, and how its values (M, n) and rest (n,) change by n components of u."""

    here: Assessment
    values: Tensor
    rest: Tensor


@dataclass(frozen=True)
class LinearModel:
    """The loss near a point x."""

    here: Assessment  # the judgment of the point
    slopes: Tensor  # (M, n) of the values
    rest_slope: Tensor  # (n,) of the rest
    stiffness: Tensor  # (n, n) curvature of the rest
    weight: float  # of a noticeable step by which a claim is missed

    def loss(self, move: Tensor) -> float:
        """Predicted at x + move (n,)."""
        rest = self.here.rest + self.rest_slope @ move + 0.5 * move @ self.stiffness @ move
        return self.here.loss(self.here.values + self.slopes @ move, rest, self.weight)

    def step(self, low: Tensor, high: Tensor) -> Tensor:
        """(n,) the move of least predicted loss within [low, high], by accelerated projected gradients (Nesterov 1983).

        Far misses are weighed down to what Huber's loss has for them, so that one that cannot be satisfied does not rule the others.
        """
        far = self.here.misses(self.here.values).clamp_min(1.0)[self.here.claim]
        weights = self.weight / far
        scaled = self.slopes * weights.sqrt()[:, None]
        steepest = float(torch.linalg.matrix_norm(scaled, 2)) ** 2 if len(scaled) else 0.0
        curvature = self.stiffness + _DAMPING * torch.eye(len(self.stiffness))
        rate = 1.0 / (steepest + float(torch.linalg.matrix_norm(curvature, 2)))
        # NumPy views of the same memory: on so few numbers its calls cost a third of torch's
        ahead, missed = torch.zeros_like(self.rest_slope), torch.zeros_like(self.here.values)
        move = at = ahead.numpy()
        values, lower, upper, weight = (
            t.numpy() for t in (self.here.values, self.here.lower, self.here.upper, weights)
        )
        rest, least, most = self.rest_slope.numpy(), low.numpy(), high.numpy()
        for number in range(_ITERATIONS):
            there = values + (self.slopes @ ahead).numpy()
            missed.numpy()[:] = weight * (there - np.clip(there, lower, upper))
            slope = (self.slopes.T @ missed).numpy() + rest + (curvature @ ahead).numpy()
            earlier, move = move, np.minimum(np.maximum(at - rate * slope, least), most)
            if np.abs(move - earlier).max() < _STILL:
                break
            at = move + number / (number + 3) * (move - earlier)
            ahead = torch.from_numpy(at)
        return torch.from_numpy(move)

    def of(self, components: Tensor) -> LinearModel:
        """The model of some components (n,) bool; the others stay."""
        return replace(
            self,
            slopes=self.slopes[:, components],
            rest_slope=self.rest_slope[components],
            stiffness=self.stiffness[components][:, components],
        )

    def gains(self, move: Tensor, parts: Mapping[str, slice], low: Tensor, high: Tensor) -> dict[str, float]:
        """By parts: the fall of the loss if its components moved on alone from x + move (n,) within [low, high], by one damped Newton step."""
        values, held = self.here.values + self.slopes @ move, self.stiffness @ move
        far = self.here.misses(values).clamp_min(1.0)[self.here.claim]
        missed = outside(values, self.here.lower, self.here.upper)
        weights, pull, loss = self.weight / far * (missed != 0), self.rest_slope + held, self.loss(move)
        found = {}
        for name, part in parts.items():
            slopes, stiffness = self.slopes[:, part], self.stiffness[part, part]
            curvature = slopes.T @ (weights[:, None] * slopes) + stiffness
            slope = slopes.T @ (weights * missed) + pull[part]
            newton = torch.linalg.solve(curvature + _DAMPING * torch.eye(len(stiffness)), slope)
            there = move.clone()
            there[part] = (move[part] - newton).clamp(low[part], high[part])
            found[name] = max(loss - self.loss(there), 0.0)
        return found

    def alike(self, part: slice, other: slice) -> float:
        """The share of a part's effect on the values that another could have, in [0, 1]; 0 where that cannot be told from so few."""
        told = (self.slopes != 0).any(1)
        mine, theirs = self.slopes[told, part], self.slopes[told, other]
        length = float(mine.norm())
        if length < _NOTHING or len(theirs) < theirs.shape[1] + _TELLING:
            return 0.0
        rest = mine - theirs @ torch.linalg.lstsq(theirs, mine, driver="gelsd").solution
        return 1.0 - float(rest.norm()) / length

    def corrected(self, seen: Assessment, move: Tensor) -> LinearModel:
        """The model at x, whose nonzero slopes agree with what was seen at x + move (n,), not zero (Broyden 1965, Schubert 1970)."""
        along = move / move.square().sum()
        moved = (self.slopes != 0) * move  # (M, n)
        missing = seen.values - self.here.values - self.slopes @ move
        rest = seen.rest - self.here.rest - (self.rest_slope + 0.5 * self.stiffness @ move) @ move
        return replace(
            self,
            slopes=self.slopes + missing[:, None] * moved / moved.square().sum(1, True).clamp_min(_TINY),
            rest_slope=self.rest_slope + rest * along,
        )

    def moved(self, seen: Assessment, move: Tensor) -> LinearModel:
        """The model at x + move; arguments as for `corrected`."""
        there = self.corrected(seen, move)
        return replace(there, here=seen, rest_slope=there.rest_slope + self.stiffness @ move)


class ClaimObjective(Protocol):
    """Judges images of u."""

    claim_weight: float  # of a noticeable step by which a claim is missed

    def stiffness(self, chosen: Tensor) -> Tensor:
        """(n, n) known curvature of the rest by the places of the n chosen components (N,) in their ranges."""

    def assess(self, u: Tensor) -> Assessment:
        """The judgment of u (N,) in [0, 1]."""

    def slopes(self, u: Tensor, chosen: Tensor) -> Slopes:
        """The change of the judgment at u (N,) by the n chosen components (N,)."""


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
    """Minimizes the objective over the chosen components (N,) by a damped Gauss-Newton method in the box, from u (N,) inside it.

    A claim is a residual, in noticeable steps. Residuals and parameters are few, so such a step is cheap, and worth many gradient
    steps. The terms of similarity, and the pull to the artist's values, are followed by their gradient. The region that slopes are
    trusted in is a rectangle (Voglis and Lagaris 2004), for the box is one. Slopes cost more than steps; between the times that
    they are taken, they are corrected by what the steps show, as in the secant version of Levenberg-Marquardt (Madsen, Nielsen and
    Tingleff 2004, section 3.5).

    At most so many points are judged after the start; `on_step` is called with (step from 1, loss, picture) after each, and True ends
    the loop. `first` is the model over shares of the chosen ranges at the start, if there is one already.
    """
    if not chosen.any():
        return Descent(u.clone(), 0.0, 0.0)
    places = chosen.nonzero(as_tuple=True)[0]
    start, span = u[chosen], (upper - lower)[chosen]
    low, high = (lower[chosen] - start) / span, (upper[chosen] - start) / span

    def place(x: Tensor) -> Tensor:
        return u.index_put((places,), start + span * x)

    def linear(x: Tensor) -> LinearModel:
        return linearize(objective, place(x), chosen, span)

    x, radius, taken, fresh = torch.zeros_like(start), _RADIUS, 1, True
    model = first or linear(x)
    loss = model.loss(x)
    found = Descent(u.clone(), loss, loss, repairs=int(not math.isfinite(loss)))
    while math.isfinite(found.loss) and found.steps < steps and radius > _SMALLEST:
        move = model.step((low - x).clamp_min(-radius), (high - x).clamp_max(radius))
        predicted = found.loss - model.loss(move)
        if predicted > _PROGRESS:
            with torch.no_grad():
                seen = objective.assess(project(place(x + move), lower, upper))
            loss = seen.loss(seen.values, seen.rest, objective.claim_weight)
            share = (found.loss - loss) / predicted if math.isfinite(loss) else -math.inf
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
    found.known = model, places, low - x, high - x
    return found


def linearize(objective: ClaimObjective, u: Tensor, chosen: Tensor, span: Tensor) -> LinearModel:
    """The model at u (N,), over shares of the ranges (n,) of n chosen components (N,)."""
    here, values, rest = objective.slopes(u, chosen)
    return LinearModel(here, values * span, rest * span, objective.stiffness(chosen), objective.claim_weight)


def _resized(radius: float, share: float, length: float) -> float:
    """The region's next radius, after a step of a length that gave this share of the predicted decrease."""
    if share < _BAD:
        return 0.4 * length
    return max(radius, min(2.0 * length, 1.0)) if share > _GOOD else radius


@dataclass
class Descent:
    """The result of the inner steps."""

    u: Tensor  # (N,) the point of least loss on the fixed views
    loss: float  # its loss on them
    start_loss: float  # the loss of the start on them
    steps: int = 0  # steps taken, at most T
    repairs: int = 0  # times that a non-finite loss or gradient was rolled back
    # at the point: the model of the n components that could move, their numbers, and how far each could go down and up
    known: tuple[LinearModel, Tensor, Tensor, Tensor] | None = None


def fixed_views() -> torch.Generator:
    """The generator of the views that points are compared on."""
    return torch.Generator().manual_seed(12345)
