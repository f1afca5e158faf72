# SPDX-License-Identifier: Apache-2.0
"""What is judged in the pictures of a point, and the loss that it comes to."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import torch
import torch.nn.functional as F
from torch import Tensor

from ...claims.claim import outside


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
        """
        misses = self.misses(values)
        return weight * float(F.huber_loss(misses, torch.zeros_like(misses), reduction="sum")) + float(rest)

    def detached(self) -> Assessment:
        """The same without gradients."""
        return replace(self, values=self.values.detach(), rest=self.rest.detach())


class Slopes(NamedTuple):
    """What is judged at a point, and how it changes by n components of u.

    Attributes:
        here: Without gradients.
        values: (M, n) of the values.
        rest: (n,) of the rest.
    """

    here: Assessment
    values: Tensor
    rest: Tensor
