# SPDX-License-Identifier: Apache-2.0
"""Trilinear interpolation in tables of three dimensions."""

from __future__ import annotations

from torch import Tensor
from torch.nn import functional

_PARTS = 16


def trilinear(table: Tensor, place: Tensor) -> Tensor:
    """Trilinear values (C, N) of a table (1, C, D, H, W) at places (N, 3) in [-1, 1], the last axis first.

    As a batch: torch's CPU kernel uses a core for each of its members.

    Args:
        table: (1, C, D, H, W).
        place: (N, 3) in [-1, 1], W's coordinate first; outside of that the border's values are taken.

    Returns:
        (C, N), differentiable in table and place.
    """
    parts = functional.pad(place, (0, 0, 0, -len(place) % _PARTS)).view(_PARTS, -1, 1, 1, 3)
    tables = table.expand(_PARTS, -1, -1, -1, -1)
    values = functional.grid_sample(tables, parts, padding_mode="border", align_corners=True)
    return values.transpose(0, 1).reshape(table.shape[1], -1)[:, : len(place)]
