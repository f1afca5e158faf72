# SPDX-License-Identifier: Apache-2.0
"""Measures of the air: how much of what lies behind it does not get through, and how light it is itself."""

from __future__ import annotations

import torch
from torch import Tensor

from .picture import MeasuredPicture

_CLEAR = 1e-3
"""Weight of what no fog hides."""

_END = 0.2
"""Share of a thing that is its foot, or its head."""


def haze(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Share of the light of what is seen there that fog takes away: (1,) in [0, 1].

    The world has no distance; a region that shows little else is measured with it.

    Args:
        where: (H, W) bool, the region.
    """
    passing = picture.seen.transmittance
    surfaces = where & (picture.seen.material >= 0)
    return 1.0 - passing[surfaces if surfaces.sum() > 0.1 * where.sum() else where].mean()[None]


def mist_below(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """How much more light the air takes away from the lowest fifth of a thing in the frame than from its highest.

    Mist that lies on the ground hides the foot and leaves the head; all of a thing is about as far away.

    Args:
        where: (H, W) bool, the thing.

    Returns:
        (1,) difference of two shares, in [-1, 1].
    """
    row = where.nonzero()[:, 0].to(picture.seen.transmittance)
    high, low = torch.quantile(row, row.new_tensor([_END, 1 - _END]))
    passing = picture.seen.transmittance[where]
    return (passing[row <= high].mean() - passing[row >= low].mean())[None]


def air_lightness(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """How light a region is where the air hides it, by how much it does: (1,) L*; its mean lightness without fog.

    How much is no way to make it lighter: thin fog shows the dark that is behind it, and is not white for that.

    Args:
        where: (H, W) bool, the region.
    """
    veil = (1.0 - picture.seen.transmittance.detach())[where] + _CLEAR
    return (picture.lab[..., 0][where] @ veil / veil.sum())[None]
