# SPDX-License-Identifier: Apache-2.0
"""What the loss is near a point, as its slopes say, the move that lowers it most, and which components serve."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import torch
import torch.nn.functional as F
from torch import Tensor

from ...claims.claim import outside
from ..vector import project

_DAMPING = 1e-3
"""Curvature that every component gets: of two moves that do the same, the shorter one (Levenberg 1944)."""

_ITERATIONS = 200

_NOTHING = 1e-3
"""Noticeable steps of all values together, for a component's whole range: so little changes nothing."""

_TELLING = 2
"""Values more than components that could do the same, at least, to say that they do."""

_NEAR = 5.0
"""Noticeable steps inside of an end of what is wanted, from where one step does not lose it."""


@dataclass(frozen=True)
class Assessment:
    """What is judged in the pictures of a point.

    Attributes:
        values: (M,) what the claims' measures give, in steps that people notice.
        lower: (M,) of what is wanted, likewise.
        upper: (M,) likewise.
        claim: (M,) number of the claim that each belongs to, from 0.
        rest: () the loss's other terms.
        picture: The first shot's.
    """

    values: Tensor
    lower: Tensor
    upper: Tensor
    claim: Tensor
    rest: Tensor
    picture: Any

    def misses(self, values: Tensor) -> Tensor:
        """(claims,) by how many noticeable steps values (M,) miss each claim."""
        count = int(self.claim.max()) + 1 if len(self.claim) else 0
        squares = values.new_zeros(count).index_add(
            0, self.claim, outside(values, self.lower, self.upper).square()
        )
        return squares.sqrt()

    def loss(self, values: Tensor, rest: Tensor, weight: float) -> float:
        """Claims that are missed, quadratic up to one noticeable step and linear beyond (Huber 1964), and the rest.

        Args:
            values: (M,) as `values`.
            rest: () as `rest`.
            weight: Of a noticeable step.
        """
        misses = self.misses(values)
        return weight * float(F.huber_loss(misses, torch.zeros_like(misses), reduction="sum")) + float(rest)


@dataclass(frozen=True)
class LinearModel:
    """The loss near a point x.

    Attributes:
        here: What is judged at the point.
        slopes: (M, n) of the values.
        rest_slope: (n,) of the rest.
        stiffness: (n, n) curvature of the rest.
        weight: Of a noticeable step by which a claim is missed.
    """

    here: Assessment
    slopes: Tensor
    rest_slope: Tensor
    stiffness: Tensor
    weight: float

    def loss(self, move: Tensor) -> float:
        """Foretold at x + move (n,)."""
        rest = self.here.rest + self.rest_slope @ move + 0.5 * move @ self.stiffness @ move
        return self.here.loss(self.here.values + self.slopes @ move, rest, self.weight)

    def step(self, low: Tensor, high: Tensor) -> Tensor:
        """(n,) the move of least foretold loss within [low, high], by accelerated projected gradients (Nesterov 1983).

        Far misses are weighed down to what Huber's loss has for them, so that one that cannot be mended does not
        rule the others.
        """
        far = self.here.misses(self.here.values).clamp_min(1.0)[self.here.claim]
        weights = self.weight / far
        scaled = self.slopes * weights.sqrt()[:, None]
        steepest = float(torch.linalg.matrix_norm(scaled, 2)) ** 2 if len(scaled) else 0.0
        curvature = self.stiffness + _DAMPING * torch.eye(len(self.stiffness))
        rate = 1.0 / (steepest + float(torch.linalg.matrix_norm(curvature, 2)))
        move = ahead = torch.zeros_like(self.rest_slope)
        for number in range(_ITERATIONS):
            values = self.here.values + self.slopes @ ahead
            missed = outside(values, self.here.lower, self.here.upper)
            slope = self.slopes.T @ (weights * missed) + self.rest_slope + curvature @ ahead
            earlier, move = move, project(ahead - rate * slope, low, high)
            ahead = move + number / (number + 3) * (move - earlier)
        return move

    def of(self, components: Tensor) -> LinearModel:
        """The model of some components (n,) bool; the others stay."""
        return replace(
            self,
            slopes=self.slopes[:, components],
            rest_slope=self.rest_slope[components],
            stiffness=self.stiffness[components][:, components],
        )

    def gain(self, move: Tensor, part: slice, low: Tensor, high: Tensor) -> float:
        """How much lower the loss would be, if components moved on alone from x + move: by one damped Newton step.

        Args:
            move: (n,).
            part: The components.
            low: (n,) least that may be moved.
            high: (n,) most.
        """
        values = self.here.values + self.slopes @ move
        far = self.here.misses(values).clamp_min(1.0)[self.here.claim]
        missed = outside(values, self.here.lower, self.here.upper)
        slopes, weights = self.slopes[:, part], self.weight / far * (missed != 0)
        damping = _DAMPING * torch.eye(slopes.shape[1])
        curvature = slopes.T @ (weights[:, None] * slopes) + self.stiffness[part, part] + damping
        slope = slopes.T @ (weights * missed) + self.rest_slope[part] + (self.stiffness @ move)[part]
        there = move.clone()
        there[part] = (move[part] - torch.linalg.solve(curvature, slope)).clamp(low[part], high[part])
        return max(self.loss(move) - self.loss(there), 0.0)

    def alike(self, part: slice, other: slice) -> float:
        """The share of what components do to the values that others could do, in [0, 1].

        Args:
            part: The components.
            other: Others.

        Returns:
            0 also where the components do nothing, or where too few values are known to tell.
        """
        told = (self.slopes != 0).any(1)
        mine, theirs = self.slopes[told, part], self.slopes[told, other]
        length = float(mine.norm())
        if length < _NOTHING or len(theirs) < theirs.shape[1] + _TELLING:
            return 0.0
        rest = mine - theirs @ torch.linalg.lstsq(theirs, mine, driver="gelsd").solution
        return 1.0 - float(rest.norm()) / length

    def corrected(self, seen: Assessment, move: Tensor) -> LinearModel:
        """The model at x, whose slopes agree with what was seen at x + move (Broyden 1965).

        Args:
            seen: At x + move.
            move: (n,), not zero.
        """
        along = move / move.square().sum()
        missing = seen.values - self.here.values - self.slopes @ move
        rest = seen.rest - self.here.rest - (self.rest_slope + 0.5 * self.stiffness @ move) @ move
        return replace(
            self,
            slopes=self.slopes + missing[:, None] * along,
            rest_slope=self.rest_slope + rest * along,
        )

    def moved(self, seen: Assessment, move: Tensor) -> LinearModel:
        """The model at x + move; arguments as for `corrected`."""
        there = self.corrected(seen, move)
        return replace(there, here=seen, rest_slope=there.rest_slope + self.stiffness @ move)


def linearize(
    assess: Callable[[Tensor], Assessment],
    place: Callable[[Tensor], Tensor],
    x: Tensor,
    stiffness: Tensor,
    weight: float,
    strides: Tensor | None = None,
) -> LinearModel:
    """The model at x: a backward pass for each value that a step might bring out of what is wanted, and one for the rest.

    Where moves are given, slopes are differences of pictures, one for each component: a picture that says hundreds of
    things is dearer to go through backward hundreds of times.

    Args:
        assess: What is judged at a point u.
        place: The point u of x.
        x: (n,).
        stiffness: (n, n) curvature of the rest.
        weight: Of a noticeable step by which a claim is missed.
        strides: (n,) moves at which differences are taken; None for backward passes.
    """
    if strides is not None:
        return LinearModel(*_differences(assess, place, x, strides), stiffness, weight)
    point = x.clone().requires_grad_()
    found = assess(place(point))
    near = (found.values < found.lower + _NEAR) | (found.values > found.upper - _NEAR)

    def slope(value: Tensor) -> Tensor:
        if not value.requires_grad:
            return torch.zeros_like(x)
        (gradient,) = torch.autograd.grad(value, point, retain_graph=True, allow_unused=True)
        return torch.zeros_like(x) if gradient is None else torch.nan_to_num(gradient, 0.0, 0.0, 0.0)

    rows = [
        slope(value) if asked else torch.zeros_like(x)
        for value, asked in zip(found.values, near, strict=True)
    ]
    slopes = torch.stack(rows) if rows else x.new_zeros((0, len(x)))
    seen = replace(found, values=found.values.detach(), rest=found.rest.detach())
    return LinearModel(seen, slopes, slope(found.rest), stiffness, weight)


@torch.no_grad()
def _differences(
    assess: Callable[[Tensor], Assessment], place: Callable[[Tensor], Tensor], x: Tensor, strides: Tensor
) -> tuple[Assessment, Tensor, Tensor]:
    """What is judged at x, and slopes of the values (M, n) and of the rest (n,), by a picture for each component."""
    here = assess(place(x))
    columns, rest = [], []
    for move in strides.diag():
        there, stride = assess(place(x + move)), move.sum()
        columns.append((there.values - here.values) / stride)
        rest.append((there.rest - here.rest) / stride)
    slopes = torch.nan_to_num(torch.stack(columns, 1), 0.0, 0.0, 0.0)
    return here, slopes, torch.nan_to_num(torch.stack(rest), 0.0, 0.0, 0.0)
