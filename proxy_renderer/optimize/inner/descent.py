# SPDX-License-Identifier: Apache-2.0
"""What an inner loop finds, and the views that points are compared on."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor


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
