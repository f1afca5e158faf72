# SPDX-License-Identifier: Apache-2.0
"""Measures of color and tone: functions of an image and a region `where` (H, W) bool of its pixels."""

import math
from collections.abc import Callable
from itertools import product

import torch
import torch.nn.functional as F
from torch import Tensor

from .picture import FEW, MeasuredPicture, largest_around, region_of

MeasureFunction = Callable[[MeasuredPicture, Tensor], Tensor]  # the numbers (n,) of a region in an image


def contrast(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Span from darkest to lightest twentieth of a region, or of the subject in it if more extreme: (1,) L*."""
    subject = region_of(picture.seen, "subject") & where
    parts = [where, subject] if subject.sum() >= FEW else [where]
    dark, light = (torch.stack([lightness_below(picture, part, share) for part in parts]) for share in (0.05, 0.95))
    return (light.max() - dark.min())[None]


def vignette(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Darkness of the second least dark corner relative to the middle ring: (1,) L*. Side light darkens two corners."""
    falls = corner_falls(picture)
    return falls[min(1, len(falls) - 1)][None] if len(falls) else picture.lab.new_zeros(1)


def corner_falls(picture: MeasuredPicture) -> Tensor:
    """Darkness of each corner without the subject, relative to the middle ring: (n,) L*, n <= 4, the least first."""
    light, free = picture.lab[..., 0], region_of(picture.seen, "surroundings")
    height, width = light.shape
    # Centers of pixels, in [-1, 1], and their radii as shares of half the image's diagonal
    y, x = torch.meshgrid(*((torch.arange(n).to(light) + 0.5) / n * 2 - 1 for n in light.shape), indexing="ij")
    radius = torch.hypot(x * width, y * height) / math.hypot(width, height)
    falloffs = []
    for up, left in product((y < 0, y >= 0), (x < 0, x >= 0)):
        here = up & left & free
        middle, corner = here & (radius > 0.35) & (radius < 0.62), here & (radius > 0.82)
        if middle.sum() > 8 and corner.sum() > 8:
            falloffs.append(light[middle].mean() - light[corner].mean())
    return torch.stack(falloffs).sort().values if falloffs else light.new_zeros(0)


def standing_out(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Median lightness of a region minus that of the surroundings: (1,) L*."""
    around = region_of(picture.seen, "surroundings")
    return (lightness_below(picture, where, 0.5) - lightness_below(picture, around, 0.5))[None]


def silhouette(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Darkness of a region relative to the surroundings, minus half of the region's `spread`: (1,) L*."""
    return -standing_out(picture, where) - 0.5 * spread(picture, where)


def separation(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Distance of the region's mean color from that of the ring right around it: (1,) in CIE Lab."""
    width = 2 * max(min(where.shape) // 16, 1) + 1
    ring = (largest_around(where, width) > 0) & ~where
    if not ring.any():
        return picture.lab.new_full((1,), 100.0)
    difference = picture.lab[where].mean(0) - picture.lab[ring].mean(0)
    return (difference.square().sum() + 1e-6).sqrt()[None]


def beyond(level: float, way: int) -> MeasureFunction:
    """A measure: the share of a region above an L* (`way` 1) or below it (`way` -1), by a soft step: (1,) in [0, 1]."""
    return lambda picture, where: torch.sigmoid(2 * way * (picture.lab[..., 0][where] - level)).mean()[None]


def clipped(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Share of a region with a channel near 1, by a soft step at 0.99: (1,) in [0, 1]. A clipped color shows no shading."""
    return torch.sigmoid(200 * (picture.display[where].amax(-1) - 0.99)).mean()[None]


def lightness_below(picture: MeasuredPicture, where: Tensor, share: float) -> Tensor:
    """Lightness () L* below which a share of the region's pixels lies; a mean over the nearest ranks, for smoother gradients."""
    light = picture.lab[..., 0][where].sort().values
    middle, reach = share * (len(light) - 1), max(0.01 * len(light), 1.0)
    first, last = max(round(middle - reach), 0), min(round(middle + reach), len(light) - 1)
    return light[first : last + 1].mean()


def color(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Color of a region as people name it, without its deepest shadows and its highlights: (3,) OKLab, times 100.

    Lightness is a mean weighted by chroma, so that reflections of a white wall count little. Hue and chroma are those
    of the mean of the darker 60 % of pixels: on gloss, the lighter pixels have the hue of the light.
    """
    light, seen = picture.oklab[..., 0].detach()[where], picture.oklab[where]
    low, matte, high = torch.quantile(light, light.new_tensor([0.1, 0.6, 0.9]))
    inside = (light >= low) & (light <= high)
    colored = seen[inside, 1:].detach().norm(dim=-1) + 1.0
    lightness = (colored * seen[inside, 0]).sum() / colored.sum()
    return torch.cat([lightness[None], seen[inside & (light <= matte), 1:].mean(0)])


def tint(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Mean of a* and b*: (2,) of CIE Lab, 0 for gray."""
    return picture.lab[..., 1:][where].mean(0)


def accent(picture: MeasuredPicture, where: Tensor, direction: Tensor) -> Tensor:
    """Mean distance from gray along a hue (2,) in a* b*, of the tenth of a region that is farthest along it: (1,)."""
    along = picture.lab[..., 1:][where] @ direction
    return along[along.detach() >= torch.quantile(along.detach(), 0.9)].mean()[None]


def lightness(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Mean lightness: (1,) L*."""
    return picture.lab[..., 0][where].mean()[None]


def chroma(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Mean distance from gray: (1,) C* of CIE Lab."""
    return _chroma_of(picture, where).mean()[None]


def vividest(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Chroma below which all but the most vivid thirtieth of the pixels lie: (1,) C* of CIE Lab."""
    return _chroma_of(picture, where).quantile(1 - 1 / 30)[None]


def colorfulness(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Colorfulness as people call it: (1,), 0 gray, 82 highly, 109 extremely (Hasler and Süsstrunk 2003, sRGB of 0 to 255)."""
    red, green, blue = (255 * picture.display[where]).unbind(-1)
    opponents = torch.stack([red - green, (red + green) / 2 - blue])
    deviation = opponents.var(1, correction=0).sum() + 1e-4
    return (deviation.sqrt() + 0.3 * (opponents.mean(1).square().sum() + 1e-4).sqrt())[None]


def _chroma_of(picture: MeasuredPicture, where: Tensor) -> Tensor:
    return (picture.lab[..., 1:][where].square().sum(-1) + 1e-4).sqrt()


def warmth(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Warmth of the mean color, positive toward orange, negative toward blue: (1,) b* + a* / 2."""
    _, a, b = picture.lab[where].mean(0)
    return (b + 0.5 * a)[None]


def warmth_between(low: float, high: float) -> MeasureFunction:
    """A measure: the `warmth` (1,) of a region's pixels between two ranks in lightness, from 0 (darkest) to 1."""

    def take(picture: MeasuredPicture, where: Tensor) -> Tensor:
        light = picture.lab[..., 0].detach()
        rank = torch.full_like(light, 0.5)  # (H, W) share of the region that is darker than each pixel
        order = light[where].argsort().argsort()
        rank[where] = (order.to(light) + 0.5) / max(len(order), 1)
        return warmth(picture, where & (rank >= low) & (rank <= high))

    return take


def brown_distance(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Mean distance of colors from the line of brown tints that a sepia print has: (1,) in a* b*. Gray has the distance 5."""
    _, a, b = picture.lab[where].unbind(-1)
    along = 0.34, 0.94  # hue of sepia, 70 degrees
    brown, across = a * along[0] + b * along[1], b * along[0] - a * along[1]
    return (across.square() + (5.0 - brown).clamp_min(0.0).square() + 1e-6).sqrt().mean()[None]


def mean(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Mean color of a region: (3,) OKLab, times 100."""
    return picture.oklab[where].mean(0)


def chromaticity(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """`chromaticity_of` the mean color of a region: (2,)."""
    return chromaticity_of(mean(picture, where))


def chromaticity_of(mean: Tensor) -> Tensor:
    """a and b (2,) of a mean color (3,), OKLab times 100, scaled to the lightness 60: exposure does not change them."""
    return mean[1:] * (60.0 / mean[0].clamp_min(20.0))


def tone(share: float) -> MeasureFunction:
    """A measure: the lightness below which a share of a region's pixels lies: (1,) L*."""
    return lambda picture, where: lightness_below(picture, where, share)[None]


def spread(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Difference between the darkest and the lightest tenth of a region: (1,) L*."""
    return (lightness_below(picture, where, 0.9) - lightness_below(picture, where, 0.1))[None]


def cast_between(low: float, high: float) -> MeasureFunction:
    """A measure: the cast of a region's pixels between two ranks in lightness, from 0 (darkest) to 1.

    A cast (2,) is a mean of a* and b* in which near-gray pixels count most.
    """

    def take(picture: MeasuredPicture, where: Tensor) -> Tensor:
        lab = picture.lab[where]
        order = lab[:, 0].detach().argsort()
        first, last = round(low * (len(order) - 1)), round(high * (len(order) - 1))
        some = lab[order[first : last + 1]]
        return grayness(some) @ some[:, 1:]

    return take


def across(axis: int, way: int) -> MeasureFunction:
    """A measure: lightness of a region's last third along an axis (0 down, 1 right) minus that of the first: (1,) L*.

    With a `way` of -1 it is the first third's minus the last's.
    """

    def take(picture: MeasuredPicture, where: Tensor) -> Tensor:
        place = where.nonzero()[:, axis].to(picture.lab)
        low, high = torch.quantile(place, place.new_tensor([1 / 3, 2 / 3]))
        light = picture.lab[..., 0][where]
        return way * (light[place >= high].mean() - light[place <= low].mean())[None]

    return take


def veil(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Light that lies over everything, as haze does: (1,) mean dark channel of a region, in percent (He, Sun and Tang 2009)."""
    width = 2 * (max(where.shape) // 24 // 2) + 1  # of a patch
    least = -F.max_pool2d(-picture.display.amin(-1)[None, None], width, stride=1, padding=width // 2)[0, 0]
    return 100 * least[where].mean()[None]


def grayness(lab: Tensor) -> Tensor:
    """Weights (N,), of sum 1 and without gradients, of pixels (N, 3) CIE Lab in a cast. Black pixels count little."""
    lab = lab.detach()
    # Half for C* 10, about what people call gray; less below L* 25
    weights = (lab[:, 0] / 25.0).clamp(0.02, 1.0) / (1 + lab[:, 1:].square().sum(-1) / 10.0**2)
    return weights / weights.sum()
