# SPDX-License-Identifier: Apache-2.0
"""Rays cut into segments, along which fog scatters light."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass

import torch
from torch import Tensor

from .camera import View


@dataclass(frozen=True)
class RaySegments:
    """Rays from a grid of places, each cut into S segments.

    Attributes:
        start: (3, rows, columns) origins, meters.
        toward: (3, rows, columns) unit directions.
        cuts: (S + 1, …) distances of the segments' ends, meters; they may differ from ray to ray.
        signature: Changes when the rays do.
    """

    start: Tensor
    toward: Tensor
    cuts: Tensor
    signature: Hashable

    @staticmethod
    def of(view: View, coarse: int, cuts: Tensor) -> RaySegments:
        """Camera rays through the centers of blocks of pixels.

        Args:
            coarse: Side of a block in pixels.
            cuts: As for the class.
        """
        columns, rows = (max(1, round(n / coarse)) for n in view.size)
        y, x = torch.meshgrid(torch.arange(rows) + 0.5, torch.arange(columns) + 0.5, indexing="ij")
        pixel = torch.stack((x * (view.size[0] / columns), y * (view.size[1] / rows))).flatten(1)
        start, toward = (part.view(3, rows, columns) for part in view.rays(pixel.to(view.position)))
        return RaySegments(start, toward, cuts, (view.signature(), float(cuts[-1])))

    @property
    def middles(self) -> Tensor:
        """Points (3, S, rows, columns) halfway between the cuts."""
        return self.start[:, None] + self.toward[:, None] * ((self.cuts[1:] + self.cuts[:-1]) / 2)
