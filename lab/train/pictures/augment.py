# SPDX-License-Identifier: Apache-2.0
"""Augments training pictures as guidance does: cut to a region, cropped, mirrored, blurred."""

import random

import torch
import torch.nn.functional as F
from torch import Tensor

from lab.heads.attributes import ATTRIBUTES
from lab.train.pictures import looks

WHOLE, ALONE, EMPTY = 0, 1, 2
_SEEN_ALONE = ("subject_color", "subject_finish", "subject_metal", "light_side", "light_softness", "light_temperature")
_SEEN_EMPTY = ("surroundings_color",)


def cut(
    pictures: Tensor, labels: Tensor, mask: Tensor, variant: int, generator: torch.Generator
) -> tuple[Tensor, Tensor]:
    """Leaves one region of the pictures, and only the labels that the region can show.

    Args:
        pictures: (LOOKS, 3, H, W), display values.
        labels: (LOOKS, A).
        mask: (H, W) bool, where the subject is.
        variant: `WHOLE`, `ALONE` for the subject or `EMPTY` for its surroundings.

    Returns:
        Pictures and labels of the same shapes; what cannot be seen any more is `looks.UNKNOWN`.
    """
    if variant == WHOLE:
        return pictures, labels
    visible = _SEEN_ALONE if variant == ALONE else _SEEN_EMPTY
    hidden = torch.tensor([name not in visible for name in looks.NAMES])
    labels = labels.masked_fill(hidden, looks.UNKNOWN)
    rest = (~mask).float()
    mean = (pictures * rest).sum((2, 3), keepdim=True) / rest.sum().clamp_min(1)
    chance = torch.rand((), generator=generator)
    if variant == EMPTY:
        fill = mean if chance < 0.8 else 0 * mean
        if chance < 0.3:
            fill = torch.rand(3, 1, 1, generator=generator).to(pictures)
        return torch.where(mask, fill, pictures), labels
    if chance < 0.35:
        return torch.where(mask, pictures, mean), labels
    cells = (1, 1, 2, 5, 12)[int(torch.randint(5, (), generator=generator))]
    coarse = torch.rand(len(pictures), 3, cells, cells, generator=generator)
    if cells == 1 and torch.rand((), generator=generator) < 0.4:
        coarse = coarse[:, :1].expand(-1, 3, -1, -1)
    background = F.interpolate(coarse.to(pictures), pictures.shape[-2:], mode="bilinear", align_corners=False)
    return torch.where(mask, pictures, background), labels


def frame(
    pictures: Tensor, labels: Tensor, mask: Tensor, variant: int, dice: random.Random
) -> tuple[Tensor, Tensor, tuple[float, float, float], bool]:
    """A random crop around the subject, and a mirror image with the light's sides exchanged.

    Args:
        pictures: (LOOKS, 3, H, W), square.
        labels: (LOOKS, A).
        mask: (H, W) bool, where the subject is.
        variant: As for `cut`.

    Returns:
        Pictures, labels, the crop's top, left and side as shares of the picture, and whether it was mirrored.
    """
    labels, box = labels.clone(), (0.0, 0.0, 1.0)
    size = pictures.shape[-1]
    if dice.random() < (0.4 if variant == WHOLE else 0.7):
        rows, columns = (torch.nonzero(mask.any(axis))[:, 0].float() for axis in (1, 0))
        center = [(axis[0] + axis[-1]).item() / 2 for axis in (rows, columns)]
        side = int(size * dice.uniform(0.55, 0.97))
        if variant == ALONE:  # guidance frames a lone subject closely
            extent = max((axis[-1] - axis[0]).item() for axis in (rows, columns))
            side = int(min(max(extent * dice.uniform(0.85, 1.35), 0.45 * size), size))
        if variant == EMPTY:
            center = [dice.uniform(0, size), dice.uniform(0, size)]
        top, left = (int(min(max(c - side / 2 + dice.uniform(-0.12, 0.12) * side, 0), size - side)) for c in center)
        pictures = pictures[:, :, top : top + side, left : left + side]
        box = (top / size, left / size, side / size)
        if side < 0.85 * size:
            labels[:, looks.INDEX["vignette"]] = looks.UNKNOWN
    mirrored = dice.random() < 0.5
    if mirrored:
        pictures = pictures.flip(-1)
        sides = labels[:, looks.INDEX["light_side"]]
        left, right = (ATTRIBUTES["light_side"].index(name) for name in ("left", "right"))
        labels[:, looks.INDEX["light_side"]] = torch.where(
            sides == left, right, torch.where(sides == right, left, sides)
        )
    return pictures, labels, box, mirrored


def wear(pictures: Tensor, generator: torch.Generator) -> Tensor:
    """Blurs some groups a little, because renders differ in sharpness.

    Args:
        pictures: (G, LOOKS, 3, H, W).
        generator: Draws the groups and how much they are blurred.
    """
    share, worn = torch.rand(2, len(pictures), generator=generator).unbind()
    for g in torch.nonzero(worn < 0.6)[:, 0].tolist():
        soft = F.pad(pictures[g], (1, 1, 1, 1), mode="replicate")  # slices are ten times faster than a pool
        soft = soft[..., :-2, :] + soft[..., 1:-1, :] + soft[..., 2:, :]
        soft = (soft[..., :-2] + soft[..., 1:-1] + soft[..., 2:]) / 9
        pictures[g] = torch.lerp(pictures[g], soft, share[g].item())
    return pictures
