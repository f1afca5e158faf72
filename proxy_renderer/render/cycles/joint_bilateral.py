# SPDX-License-Identifier: Apache-2.0
"""Averages over pixels that show the same thing: smoothing and look-ups that do not cross outlines.

Kopf et al., "Joint Bilateral Upsampling", 2007, with names of surfaces in place of colors.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor
from torch.nn.functional import embedding_bag, max_pool2d

_REACH = 2.0  # pixels of the picture that is looked up in
_ALIKE = 0.5  # stops
_LEAST = 1e-3  # weight of all pixels together, of which one at the place itself has 4
_OUTLINE = 0.2  # weight of pixels beside an outline, which show two things


@dataclass(frozen=True)
class GuideImage:
    """What the pixels of a picture show.

    Attributes:
        names: (H, W) int64, equal where pixels show the same object and material; negative for the background.
    """

    names: Tensor

    @property
    def device(self) -> torch.device:
        """Where the picture is."""
        return self.names.device

    @property
    def inner(self) -> Tensor:
        """(H, W) weight of a pixel: little where its neighbors show something else."""
        wide = torch.cat((self.names, -self.names)).view(2, *self.names.shape).double()
        high, low = max_pool2d(wide[None], 3, 1, 1)[0]
        return torch.where(high == -low, 1.0, _OUTLINE).float()


def blur(fields: Tensor, guide: GuideImage, radius: int, sigma: float) -> Tensor:
    """Gaussian averages (C, P) of fields (C, P) over each pixel's neighbors of the same name."""
    height, width = guide.names.shape
    picture = fields.view(-1, height, width)
    total, weights = torch.zeros_like(picture), torch.zeros_like(picture[0])
    for dy in range(-radius, radius + 1):
        for dx in range(-radius, radius + 1):
            here, there = _overlap(dy, height), _overlap(dx, width)
            (y, from_y), (x, from_x) = here, there
            weight = torch.exp(torch.tensor(-(dx * dx + dy * dy) / (2 * sigma * sigma))).to(fields)
            same = weight * (guide.names[y, x] == guide.names[from_y, from_x])
            total[:, y, x] += same * picture[:, from_y, from_x]
            weights[y, x] += same
    return (total / weights).view_as(fields)


def _overlap(shift: int, size: int) -> tuple[slice, slice]:
    """Where a picture and itself, shifted, overlap: there, and what lies there in the shifted one."""
    return slice(max(0, -shift), size - max(0, shift)), slice(max(0, shift), size - max(0, -shift))


def look_up(
    fields: Tensor,
    guide: GuideImage,
    place: Tensor,
    names: Tensor,
    neutral: Tensor,
    stops: tuple[Tensor, Tensor] | None = None,
) -> Tensor:
    """Averages around picture positions, over pixels that show what is asked for.

    Args:
        fields: (C, P) of the picture.
        guide: What its pixels show.
        place: (2, N) positions in pixels, x and y; centers are at .5.
        names: (N,) what is to be seen there.
        neutral: (C,) for where nothing near shows it.
        stops: (P,) brightness of the pixels and (N,) of what is asked for, in stops: only pixels about as bright
            count, so that what belongs to a highlight stays with it. None to average over all.

    Returns:
        (C, N).
    """
    height, width = guide.names.shape
    flat, inner = guide.names.flatten(), guide.inner.flatten()
    rows = fields.T.contiguous()  # what a pixel has lies together
    total = torch.zeros((place.shape[1], len(fields)), device=fields.device)
    weights = torch.zeros_like(total[:, 0])
    place = torch.nan_to_num(place, nan=-1e6).clamp(-1e6, 1e6)
    start = (place - 0.5 - _REACH).ceil().long()
    steps = torch.arange(int(2 * _REACH) + 1, device=fields.device)
    for dy in steps:
        x, y = start[0] + steps[:, None], (start[1] + dy).expand(len(steps), -1)
        inside = (x >= 0) & (x < width) & (y >= 0) & (y < height)
        index = x.clamp(0, width - 1) + width * y.clamp(0, height - 1)
        near = ((_REACH - (p + 0.5 - at).abs()).clamp_min(0.0) for p, at in zip((x, y), place, strict=True))
        weight = next(near) * next(near) * inner[index] * (inside & (flat[index] == names))
        if stops is not None:
            weight = weight * torch.exp(-(((stops[0][index] - stops[1]) / _ALIKE) ** 2))
        total += embedding_bag(index.T, rows, per_sample_weights=weight.T, mode="sum")
        weights += weight.sum(0)
    covered = weights > _LEAST
    return torch.where(covered, total.T / torch.where(covered, weights, 1.0), neutral[:, None])
