# SPDX-License-Identifier: Apache-2.0
"""One round's inner steps (lines 8 to 15): assessments of points, their linear model, and damped Gauss-Newton steps in the box."""

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

_DAMPING = 1e-3  # curvature added to each component: of two equally good moves the shorter (Levenberg 1944)
_ITERATIONS, _STILL = 200, 1e-5  # of `LinearModel.step`: most iterations; largest change at which it ends
_NOTHING = 1e-3  # noticeable steps, over its whole range, below which a parameter has no effect on the values
_TELLING = 2  # to compare two parameters, there must be so many more values than components
_TAKEN = 2  # most times that slopes are computed in one `solve`
_RADIUS, _SMALLEST = 0.35, 0.01  # trust region's radius in shares of feasible ranges: first; least
_GOOD, _BAD = 0.7, 0.2  # shares of the predicted decrease above which the region grows, or below shrinks
_TINY = 1e-12  # least squared length of a move that is divided by
_PROGRESS = 1e-3  # predicted decrease up to which a step is not worth rendering


@dataclass(frozen=True)
class Assessment:
    """The M values of all claims in the images of a point u, the aims of the claims, and the loss's other terms."""

    values: Tensor  # (M,) of the claims' measures, in noticeable steps
    lower: Tensor  # (M,) lower ends of the aims, in noticeable steps
    upper: Tensor  # (M,) upper ends
    claim: Tensor  # (M,) number, from 0, of the claim that each value belongs to
    rest: Tensor  # () sum of the loss's other terms
    picture: Any  # the first shot's image
    finish: Tensor | None = None  # (M,) bool: whether a claim is about a surface's finish; None if unknown

    def misses(self, values: Tensor) -> Tensor:
        """(claims,) noticeable steps by which values (M,) miss each claim's aim."""
        count = int(self.claim.max()) + 1 if len(self.claim) else 0
        squares = outside(values, self.lower, self.upper).square()
        return values.new_zeros(count).index_add(0, self.claim, squares).sqrt()

    def loss(self, values: Tensor, rest: Tensor, weight: float) -> float:
        """The loss of values (M,) and rest (): Huber's loss of the misses, linear beyond one step, plus the rest."""
        misses = self.misses(values)
        return weight * float(F.huber_loss(misses, torch.zeros_like(misses), reduction="sum")) + float(rest)

    def detached(self) -> Assessment:
        """The same assessment without gradients."""
        return replace(self, values=self.values.detach(), rest=self.rest.detach())


class Slopes(NamedTuple):
    """The assessment of a point, and derivatives of its values and rest with respect to n components of u."""

    here: Assessment  # without gradients
    values: Tensor  # (M, n) derivatives of the values
    rest: Tensor  # (n,) derivatives of the rest


@dataclass(frozen=True)
class LinearModel:
    """Predicts the loss near a point x of n components: the claims' values are linear, the rest is quadratic."""

    here: Assessment  # at x
    slopes: Tensor  # (M, n) derivatives of the values
    rest_slope: Tensor  # (n,) derivatives of the rest
    stiffness: Tensor  # (n, n) curvature of the rest
    weight: float  # of a claim that is missed by one noticeable step, in the loss

    def loss(self, move: Tensor) -> float:
        """The predicted loss at x + move (n,)."""
        rest = self.here.rest + self.rest_slope @ move + 0.5 * move @ self.stiffness @ move
        return self.here.loss(self.here.values + self.slopes @ move, rest, self.weight)

    def step(self, low: Tensor, high: Tensor) -> Tensor:
        """(n,) the move of least predicted loss within [low, high], by accelerated projected gradients (Nesterov 1983).

        A claim that is missed by more than one noticeable step gets the smaller weight of Huber's loss: a claim that
        cannot be satisfied does not dominate the others.
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
        values, lower, upper = (t.numpy() for t in (self.here.values, self.here.lower, self.here.upper))
        weight, rest, least, most = (t.numpy() for t in (weights, self.rest_slope, low, high))
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

    def of(self, some: Tensor) -> LinearModel:
        """The model over the components marked in `some` (n,) bool; the others are fixed."""
        parts = self.slopes[:, some], self.rest_slope[some], self.stiffness[some][:, some]
        return LinearModel(self.here, *parts, self.weight)

    def gains(self, move: Tensor, parts: Mapping[str, slice], low: Tensor, high: Tensor) -> dict[str, float]:
        """Key -> predicted decrease of the loss, from x + move (n,), by one damped Newton step of this parameter alone.

        `parts`: key -> slice of the parameter's components; `low` and `high` (n,) bound the move.
        """
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
        """Share, in [0, 1], of the effect of the components `part` on the values that `other` can reproduce.

        0 if the effect is hardly noticeable, or too few values depend on the components to compare them.
        """
        told = (self.slopes != 0).any(1)
        mine, theirs = self.slopes[told, part], self.slopes[told, other]
        length = float(mine.norm())
        if length < _NOTHING or len(theirs) < theirs.shape[1] + _TELLING:
            return 0.0
        rest = mine - theirs @ torch.linalg.lstsq(theirs, mine, driver="gelsd").solution
        return 1.0 - float(rest.norm()) / length

    def corrected(self, seen: Assessment, move: Tensor) -> LinearModel:
        """The model at x with slopes that agree with `seen`, at x + move (n,) ≠ x (Broyden 1965, Schubert 1970)."""
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
    """The objective of `solve`: assesses points u, and gives slopes and curvature there."""

    claim_weight: float  # of a claim that is missed by one noticeable step, in the loss

    def stiffness(self, chosen: Tensor) -> Tensor:
        """Curvature (n, n) of the rest over the n components chosen (N,) bool, as places in [0, 1] of their ranges."""

    def assess(self, u: Tensor) -> Assessment:
        """The assessment of u (N,) in [0, 1]."""

    def slopes(self, u: Tensor, chosen: Tensor) -> Slopes:
        """The assessment at u (N,), and its derivatives with respect to the n components chosen (N,) bool."""


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
    """Minimizes the objective over the components chosen (N,) bool in a box, from u (N,), by damped Gauss-Newton steps.

    Residuals are the claims' misses, in noticeable steps. Residuals and parameters are few, so a Gauss-Newton step is
    cheap, and worth many gradient steps. For the terms of similarity only the gradient is known; the pull to the
    artist's values has a curvature, too. The trust region is a rectangle (Voglis and Lagaris 2004), for the box is one.
    Slopes cost more than steps. They are computed rarely, and corrected by the result of each step, as in the secant
    version of Levenberg-Marquardt (Madsen, Nielsen and Tingleff 2004, section 3.5).

    Args:
        steps: The most points that are rendered and assessed after the start.
        on_step: Called with (step from 1, loss, image) after each point; True ends the loop.
        first: The model at the start, over shares of the chosen ranges, if it is known already.
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
            length = float(move.abs().max())
            if share < _BAD:
                radius = 0.4 * length
            elif share > _GOOD:
                radius = max(radius, min(2.0 * length, 1.0))
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
    """Linear model at u (N,) of n components chosen (N,) bool; moves are in units of `span` (n,), their ranges."""
    here, values, rest = objective.slopes(u, chosen)
    return LinearModel(here, values * span, rest * span, objective.stiffness(chosen), objective.claim_weight)


@dataclass
class Descent:
    """The result of the inner steps."""

    u: Tensor  # (N,) the point of least loss on the fixed views
    loss: float  # at u
    start_loss: float  # at the start
    steps: int = 0  # number of steps, at most T
    repairs: int = 0  # times that a non-finite loss was rolled back
    # at u: the model of the n components that could move, their indices (n,), and how far each can still go
    # down and up (n,), in shares of its range
    known: tuple[LinearModel, Tensor, Tensor, Tensor] | None = None


def fixed_views() -> torch.Generator:
    """A generator with a fixed seed, so that all points are compared on the same random crops of the image."""
    return torch.Generator().manual_seed(12345)
