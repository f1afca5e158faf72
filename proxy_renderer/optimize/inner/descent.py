# SPDX-License-Identifier: Apache-2.0
"""What inner loops share: what they minimize, what they find, and what a parameter could gain."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import torch
from torch import Tensor


class Objective(Protocol):
    """Pictures of u, and how far they are from the words."""

    @property
    def shots(self) -> int:
        """How many pictures there are: steps take them in turn, points are judged on all of them."""

    def render(self, u: Tensor, shot: int) -> Any:
        """A picture of u, differentiable in what may move.

        Args:
            u: (N,) in [0, 1].
            shot: Which picture, from 0.
        """

    def loss(self, picture: Any, u: Tensor, generator: torch.Generator, shot: int) -> Tensor:
        """How far a picture is from the words.

        Args:
            picture: As `render` returns it.
            u: (N,) the values that it shows.
            generator: Chooses the views.
            shot: Which picture it is, from 0.

        Returns:
            A scalar, differentiable in the picture and in u.
        """


@dataclass
class Descent:
    """The result of an inner loop.

    Attributes:
        u: (N,) the point of least loss on the fixed views.
        loss: Its loss on them.
        start_loss: The loss of the loop's start on them.
        steps: Steps taken, at most T.
        repairs: Times that a non-finite loss or gradient was rolled back.
    """

    u: Tensor
    loss: float
    start_loss: float
    steps: int = 0
    repairs: int = 0


def fixed_views() -> torch.Generator:
    """The generator of the views that points are compared on."""
    return torch.Generator().manual_seed(12345)


def first_order_gain(objective: Objective, u: Tensor, lower: Tensor, upper: Tensor) -> Tensor:
    """(N,) how much the loss could fall, to first order, by moving each component within the box.

    Args:
        objective: What is minimized.
        u: (N,) where the gradient is taken, inside the box.
        lower: (N,) lower corner of the feasible box.
        upper: (N,) upper corner.

    Returns:
        (N,) at least 0, in units of the loss; the mean over all shots.
    """
    point = u.clone().requires_grad_()
    for shot in range(objective.shots):
        objective.loss(objective.render(point, shot), point, fixed_views(), shot).backward()
    slope = (
        torch.zeros_like(u)
        if point.grad is None
        else torch.nan_to_num(point.grad / objective.shots, 0.0, 0.0, 0.0)
    )
    return slope.abs() * torch.where(slope > 0, u - lower, upper - u)
