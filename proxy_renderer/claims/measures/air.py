# SPDX-License-Identifier: Apache-2.0
"""Measures of the air: how much of what lies behind it does not get through."""

from __future__ import annotations

from torch import Tensor

from .picture import MeasuredPicture


def haze(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Share of the light of what is seen there that fog takes away: (1,) in [0, 1].

    The world has no distance; a region that shows little else is measured with it.

    Args:
        picture: The picture.
        where: (H, W) bool, the region.
    """
    passing = picture.seen.transmittance
    surfaces = where & (picture.seen.material >= 0)
    return 1.0 - passing[surfaces if surfaces.sum() > 0.1 * where.sum() else where].mean()[None]
