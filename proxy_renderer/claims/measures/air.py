# SPDX-License-Identifier: Apache-2.0
"""Measures of the air: how much of what lies behind it does not get through, and how light it is itself."""

from __future__ import annotations

from torch import Tensor

from .picture import MeasuredPicture

_CLEAR = 1e-3
"""Weight of what no fog hides."""


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


def air_lightness(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """How light a region is where the air hides it, by how much it does: (1,) L*; its mean lightness without fog.

    How much is no way to make it lighter: thin fog shows the dark that is behind it, and is not white for that.

    Args:
        picture: The picture.
        where: (H, W) bool, the region.
    """
    veil = (1.0 - picture.seen.transmittance.detach())[where] + _CLEAR
    return (picture.lab[..., 0][where] @ veil / veil.sum())[None]
