# SPDX-License-Identifier: Apache-2.0
"""Measures of tone: contrast, black and white, vignette, and how a subject stands out."""

import math

import torch
from torch import Tensor

from .picture import FEW, MeasuredPicture, largest_around, region_of

_RINGS = (0.35, 0.62, 0.82)
"""Of a vignette, in half diagonals: the middle lies between the first two, the corners beyond the third."""


def contrast(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """From the darkest to the lightest twentieth, of the region or of the subject in it: (1,) L*.

    A small thing in a spot of light is a picture of high contrast, however little of it is light.
    """
    subject = region_of(picture.seen, "subject") & where
    parts = [where, subject] if subject.sum() >= FEW else [where]
    light = torch.stack([lightness_below(picture, part, 0.95) for part in parts]).max()
    return (light - torch.stack([lightness_below(picture, part, 0.05) for part in parts]).min())[None]


def vignette(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Darkness of the corners relative to the middle ring of the whole image, in the second least darkened one: (1,) L*.

    All four count, because light from one side darkens two of them. The subject is left out.
    """
    falls = corner_falls(picture)
    return falls[min(1, len(falls) - 1)][None] if len(falls) else picture.lab.new_zeros(1)


def corner_falls(picture: MeasuredPicture) -> Tensor:
    """Darkness of each corner relative to the middle ring, the subject left out: (n,) L*, n at most 4, the least first."""
    light, free = picture.lab[..., 0], region_of(picture.seen, "surroundings")
    height, width = light.shape
    y, x = torch.meshgrid(_middles(height, light), _middles(width, light), indexing="ij")
    radius = torch.hypot(x * width, y * height) / math.hypot(width, height)
    falloffs = []
    for up in (y < 0, y >= 0):
        for left in (x < 0, x >= 0):
            here = up & left & free
            middle, corner = here & (radius > _RINGS[0]) & (radius < _RINGS[1]), here & (radius > _RINGS[2])
            if middle.sum() > 8 and corner.sum() > 8:
                falloffs.append(light[middle].mean() - light[corner].mean())
    return torch.stack(falloffs).sort().values if falloffs else light.new_zeros(0)


def standing_out(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Lightness of a region less that of the surroundings, by their medians: (1,) L*."""
    return (
        lightness_below(picture, where, 0.5)
        - lightness_below(picture, region_of(picture.seen, "surroundings"), 0.5)
    )[None]


def silhouette(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Darkness of a region before its surroundings, less half of its own spread of light: (1,) L*."""
    spread = lightness_below(picture, where, 0.9) - lightness_below(picture, where, 0.1)
    return -standing_out(picture, where) - 0.5 * spread


def separation(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Distance of the region's mean color from that of the ring right around it: (1,) in CIE Lab."""
    width = 2 * max(min(where.shape) // 16, 1) + 1
    ring = (largest_around(where, width) > 0) & ~where
    if not ring.any():
        return picture.lab.new_full((1,), 100.0)
    difference = picture.lab[where].mean(0) - picture.lab[ring].mean(0)
    return (difference.square().sum() + 1e-6).sqrt()[None]


def burnt(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Share of a region that is burnt out, by a soft step at L* 97: (1,) in [0, 1]."""
    return torch.sigmoid(2 * (picture.lab[..., 0][where] - 97.0)).mean()[None]


def clipped(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Share of a region with a channel at its end, by a soft step at 0.99 of it: (1,) in [0, 1]. Such a color has lost its shading."""
    return torch.sigmoid(200 * (picture.display[where].amax(-1) - 0.99)).mean()[None]


def drowned(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Share of a region that drowns in black, by a soft step at L* 4: (1,) in [0, 1]."""
    return torch.sigmoid(2 * (4.0 - picture.lab[..., 0][where])).mean()[None]


def lightness_below(picture: MeasuredPicture, where: Tensor, share: float) -> Tensor:
    """Lightness () below which a share of the region lies; the mean of the pixels near it, for gradients."""
    light = picture.lab[..., 0][where].sort().values
    middle, reach = share * (len(light) - 1), max(0.01 * len(light), 1.0)
    first, last = max(round(middle - reach), 0), min(round(middle + reach), len(light) - 1)
    return light[first : last + 1].mean()


def _middles(count: int, like: Tensor) -> Tensor:
    """Positions of pixels' middles in [-1, 1]."""
    return (torch.arange(count, device=like.device, dtype=like.dtype) + 0.5) / count * 2 - 1
