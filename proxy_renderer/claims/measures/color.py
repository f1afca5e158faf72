# SPDX-License-Identifier: Apache-2.0
"""Measures of color: of a thing, of a region, of what is dark and of what is light."""

from __future__ import annotations

import torch
from torch import Tensor

from .picture import MeasuredPicture

_REST = 0.1
"""Share of a region's darkest pixels, and of its lightest, that say nothing of its color: shadows and highlights."""

_MIRRORED = 0.4
"""Share of its lightest pixels that say little of its hue and chroma: where it is glossy, they have those of the lights."""

_PLAIN = 1.0
"""Chroma, OKLab times 100, that pixels count for beside their own, where lightness is read: gray things have none."""

_ACCENT = 0.1
"""Share of a region that one of several colors of light has to tint."""

_ENDS = 0.3
"""Share of the darkest, or of the lightest, pixels that tints of shadows and of lights are read from."""


def color(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Color of a region without its deepest shadows and its highlights, as people name it.

    Its lightness is that of where its color shows: what mirrors a white wall says little of a teal. Hue and chroma are those
    of its darker part.

    Args:
        where: (H, W) bool, the region.

    Returns:
        (3,) OKLab, times 100.
    """
    light, seen = picture.oklab[..., 0].detach()[where], picture.oklab[where]
    low, matte, high = torch.quantile(light, light.new_tensor([_REST, 1 - _MIRRORED, 1 - _REST]))
    inside = (light >= low) & (light <= high)
    colored = seen[inside, 1:].detach().norm(dim=-1) + _PLAIN
    lightness = (colored * seen[inside, 0]).sum() / colored.sum()
    return torch.cat([lightness[None], seen[inside & (light <= matte), 1:].mean(0)])


def tint(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Where the mean color lies off gray: (2,) a* and b* of CIE Lab.

    Args:
        where: (H, W) bool, the region.
    """
    return picture.lab[..., 1:][where].mean(0)


def accent(picture: MeasuredPicture, where: Tensor, direction: Tensor) -> Tensor:
    """How far the part of a region that lies farthest in a color's direction does so: (1,) a* and b* along it.

    Two lights of two colors tint different parts of a picture, and its mean by neither.

    Args:
        where: (H, W) bool, the region.
        direction: (2,) unit vector in a* and b*.
    """
    along = picture.lab[..., 1:][where] @ direction
    return along[along.detach() >= torch.quantile(along.detach(), 1 - _ACCENT)].mean()[None]


def lightness(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Mean lightness: (1,) L*.

    Args:
        where: (H, W) bool, the region.
    """
    return picture.lab[..., 0][where].mean()[None]


def chroma(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Mean distance from gray: (1,) C* of CIE Lab.

    Args:
        where: (H, W) bool, the region.
    """
    return _chroma_of(picture, where).mean()[None]


def vividest(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Distance from gray that all but the most vivid thirtieth of the pixels keep below: (1,) C* of CIE Lab.

    Args:
        where: (H, W) bool, the region.
    """
    return _chroma_of(picture, where).quantile(1 - 1 / 30)[None]


def _chroma_of(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """C* (n,) of each pixel of a region."""
    return (picture.lab[..., 1:][where].square().sum(-1) + 1e-4).sqrt()


def warmth(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """How far the mean color lies towards orange, or, below 0, towards blue: (1,) b* and half of a*.

    Args:
        where: (H, W) bool, the region.
    """
    _, a, b = picture.lab[where].mean(0)
    return (b + 0.5 * a)[None]


def shadow_warmth(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Warmth of the darkest part of a region: (1,), see `warmth`.

    Args:
        where: (H, W) bool, the region.
    """
    return warmth(picture, where & (_rank(picture, where) <= _ENDS))


def highlight_warmth(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Warmth of the lightest part of a region: (1,), see `warmth`.

    Args:
        where: (H, W) bool, the region.
    """
    return warmth(picture, where & (_rank(picture, where) >= 1 - _ENDS))


def brown_distance(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Mean distance of colors from the one line of brown tints that a sepia print has: (1,) Lab; gray is 5 away.

    Args:
        where: (H, W) bool, the region.
    """
    _, a, b = picture.lab[where].unbind(-1)
    along = 0.34, 0.94  # hue of sepia, 70 degrees
    brown, across = a * along[0] + b * along[1], b * along[0] - a * along[1]
    return (across.square() + (5.0 - brown).clamp_min(0.0).square() + 1e-6).sqrt().mean()[None]


def _rank(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """(H, W) share of the region that is darker than each of its pixels; 0.5 outside."""
    light = picture.lab[..., 0].detach()
    rank = torch.full_like(light, 0.5)
    order = light[where].argsort().argsort()
    rank[where] = (order.to(light) + 0.5) / max(len(order), 1)
    return rank
