# SPDX-License-Identifier: Apache-2.0
"""Measures that read alike off any picture, whatever is known of what it shows: tones, tints, how light runs across it."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import torch
import torch.nn.functional as F
from torch import Tensor

from .picture import MeasuredPicture
from .tone import lightness_below

SHADOWS, MIDTONES, LIGHTS = (0.02, 0.25), (0.25, 0.75), (0.75, 0.98)
"""Shares of the pixels in order of lightness that shadows, midtones and lights are read from."""

_GRAY = 10.0
"""C* of CIE Lab at which a pixel counts half for a color cast: about what people call gray at a glance."""

_DARK, _LEAST = 25.0, 0.02
"""L* below which a pixel says less of a cast, the less the darker, and what black counts."""

_PATCH = 24
"""Patches of a dark channel along the longer side of a picture."""


def mean(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Mean color of a region: (3,) OKLab, times 100.

    Args:
        where: (H, W) bool, the region.
    """
    return picture.oklab[where].mean(0)


class RegionMeans:
    """The measure `mean` of many regions at once.

    Args:
        regions: (H, W) bool each, of at least one pixel, by any number.
    """

    def __init__(self, regions: Mapping[int, Tensor]) -> None:
        self._numbers = tuple(regions)
        pixels = [where.flatten().nonzero(as_tuple=True)[0] for where in regions.values()]
        self._pixels = torch.cat(pixels)
        self._counts = self._pixels.new_tensor([len(each) for each in pixels])
        self._owners = torch.arange(len(pixels), device=self._pixels.device).repeat_interleave(self._counts)

    def of(self, picture: MeasuredPicture) -> dict[int, Tensor]:
        """What a picture has, each (3,) OKLab, times 100, by the regions' numbers."""
        colors = picture.oklab.flatten(0, 1)[self._pixels]
        sums = colors.new_zeros(len(self._counts), 3).index_add(0, self._owners, colors)
        return dict(zip(self._numbers, (sums / self._counts[:, None]).unbind(), strict=True))


def tone(share: float) -> Callable[[MeasuredPicture, Tensor], Tensor]:
    """The measure of the lightness below which a share of a region lies: (1,) L*."""

    def take(picture: MeasuredPicture, where: Tensor) -> Tensor:
        return lightness_below(picture, where, share)[None]

    return take


def spread(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """From the darkest to the lightest tenth of a region: (1,) L*.

    Args:
        where: (H, W) bool, the region.
    """
    return (lightness_below(picture, where, 0.9) - lightness_below(picture, where, 0.1))[None]


def cast(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Where a region lies off gray, its grayest pixels counting most: (2,) a* and b* of CIE Lab.

    Light and grade tint gray things as well, and a thing that is much more colorful is paint. Where all is colorful, all of
    it counts. Gray pixels tell the light, as in Yang, Gao and Li 2015, "Efficient Illuminant Estimation in the Real World
    using Gray Pixels"; the weights are Cauchy's.

    Args:
        where: (H, W) bool, the region.
    """
    lab = picture.lab[where]
    return grayness(lab) @ lab[:, 1:]


def cast_between(low: float, high: float) -> Callable[[MeasuredPicture, Tensor], Tensor]:
    """The measure of the cast, see `cast`, of what lies between two shares of a region in order of lightness: (2,)."""

    def take(picture: MeasuredPicture, where: Tensor) -> Tensor:
        lab = picture.lab[where]
        order = lab[:, 0].detach().argsort()
        first, last = round(low * (len(order) - 1)), round(high * (len(order) - 1))
        some = lab[order[first : last + 1]]
        return grayness(some) @ some[:, 1:]

    return take


def from_right(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """How much lighter the right third of a region is than its left third: (1,) L*.

    Args:
        where: (H, W) bool, the region.
    """
    return _across(picture, where, 1)[None]


def from_above(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """How much lighter the upper third of a region is than its lower third: (1,) L*.

    Args:
        where: (H, W) bool, the region.
    """
    return -_across(picture, where, 0)[None]


def veil(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Light that lies over everything, as haze does: the dark channel of a region (He, Sun and Tang 2009).

    In a clear picture nearly every patch has something dark or colorful in it, where one of red, green and blue is low.

    Args:
        where: (H, W) bool, the region.

    Returns:
        (1,) mean over patches of the least of red, green and blue, sRGB-encoded, in percent.
    """
    width = 2 * (max(where.shape) // _PATCH // 2) + 1
    least = -F.max_pool2d(-picture.display.amin(-1)[None, None], width, stride=1, padding=width // 2)[0, 0]
    return 100 * least[where].mean()[None]


def grayness(lab: Tensor) -> Tensor:
    """How much each of some pixels counts for a cast: (N,) of sum 1, no function of the picture to gradients.

    Black is gray in any light, and counts for little.

    Args:
        lab: (N, 3) CIE Lab.
    """
    lab = lab.detach()
    weights = (lab[:, 0] / _DARK).clamp(_LEAST, 1.0) / (1 + lab[:, 1:].square().sum(-1) / _GRAY**2)
    return weights / weights.sum()


def _across(picture: MeasuredPicture, where: Tensor, axis: int) -> Tensor:
    """() L* of the last third of a region's pixels along an axis, less that of the first."""
    place = where.nonzero()[:, axis].to(picture.lab)
    low, high = torch.quantile(place, place.new_tensor([1 / 3, 2 / 3]))
    light = picture.lab[..., 0][where]
    return light[place >= high].mean() - light[place <= low].mean()
