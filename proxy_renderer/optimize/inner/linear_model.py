# SPDX-License-Identifier: Apache-2.0
"""What the loss is near a point, as its slopes say, and the move that lowers it most."""

from __future__ import annotations

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
        stiffness: (n,) curvature of the rest.
        weight: Of a noticeable step by which a claim is missed.
    """

    here: Assessment
    slopes: Tensor
    rest_slope: Tensor
    stiffness: Tensor
    weight: float

    def loss(self, move: Tensor) -> float:
        """Foretold at x + move (n,)."""
        rest = self.here.rest + self.rest_slope @ move + 0.5 * self.stiffness @ move.square()
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
        curvature = self.stiffness + _DAMPING
        rate = 1.0 / (steepest + float(curvature.max()))
        move = ahead = torch.zeros_like(self.rest_slope)
        for number in range(_ITERATIONS):
            values = self.here.values + self.slopes @ ahead
            missed = outside(values, self.here.lower, self.here.upper)
            slope = self.slopes.T @ (weights * missed) + self.rest_slope + curvature * ahead
            earlier, move = move, project(ahead - rate * slope, low, high)
            ahead = move + number / (number + 3) * (move - earlier)
        return move

    def corrected(self, seen: Assessment, move: Tensor) -> LinearModel:
        """The model at x, whose slopes agree with what was seen at x + move (Broyden 1965).

        Args:
            seen: At x + move.
            move: (n,), not zero.
        """
        along = move / move.square().sum()
        missing = seen.values - self.here.values - self.slopes @ move
        rest = seen.rest - self.here.rest - (self.rest_slope + 0.5 * self.stiffness * move) @ move
        return replace(
            self,
            slopes=self.slopes + missing[:, None] * along,
            rest_slope=self.rest_slope + rest * along,
        )

    def moved(self, seen: Assessment, move: Tensor) -> LinearModel:
        """The model at x + move; arguments as for `corrected`."""
        there = self.corrected(seen, move)
        return replace(there, here=seen, rest_slope=there.rest_slope + self.stiffness * move)
