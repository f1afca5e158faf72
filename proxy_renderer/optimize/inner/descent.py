# SPDX-License-Identifier: Apache-2.0
"""What inner loops share: what they minimize, and what they find."""

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
