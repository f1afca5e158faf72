# SPDX-License-Identifier: Apache-2.0
"""What the loss is near a point, as its slopes say, the move that lowers it most, and which components serve."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import torch
from torch import Tensor

from ...claims.claim import outside
from ..vector import project
from .assessment import Assessment

_DAMPING = 1e-3
"""Curvature that every component gets: of two moves that do the same, the shorter one (Levenberg 1944)."""

_ITERATIONS, _STILL = 200, 1e-5
"""Of a step's search, at most, and the share of all ranges below which one no longer moves anything."""

_NOTHING = 1e-3
"""Noticeable steps of all values together, for a component's whole range: so little changes nothing."""

_TELLING = 2
"""Values more than components that could do the same, at least, to say that they do."""


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
            if float((move - earlier).abs().max()) < _STILL:
                break
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

    def gains(self, move: Tensor, parts: Mapping[str, slice], low: Tensor, high: Tensor) -> dict[str, float]:
        """How much lower the loss would be, if some components moved on alone from x + move: by one damped Newton step.

        Args:
            move: (n,).
            low: (n,) least that may be moved.
            high: (n,) most.

        Returns:
            By the parts' names.
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
        """The share of what components do to the values that others could do, in [0, 1].

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
