# SPDX-License-Identifier: Apache-2.0
"""Many views of one picture, so that no single framing of it can be exploited.

Random large crops under a random perspective, as text2mesh and CLIPasso do; colors are never
touched, because they are the signal.
"""

from __future__ import annotations

import torch
import torch.nn.functional as F
from torch import Tensor

_CORNERS = torch.tensor([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
_TRIES = 8


def quads(
    count: int, generator: torch.Generator, scale: tuple[float, float] = (0.75, 1.0), distortion: float = 0.2
) -> Tensor:
    """Random quadrilaterals inside the picture, each the source of one view.

    Args:
        generator: Source of all randomness (on the CPU).
        scale: Range of the crop's side relative to the picture's.
        distortion: How far a corner may move inwards, relative to half the crop's side.

    Returns:
        (count, 4, 2) corners in [-1, 1], clockwise from the top left; x to the right, y down.
    """
    side = scale[0] + (scale[1] - scale[0]) * torch.rand(count, 1, 1, generator=generator)
    center = (2.0 * torch.rand(count, 1, 2, generator=generator) - 1.0) * (1.0 - side)
    inwards = 1.0 - distortion * torch.rand(count, 4, 2, generator=generator)
    return center + side * _CORNERS * inwards


def keeping(mask: Tensor, count: int, generator: torch.Generator, share: float = 0.7) -> Tensor:
    """Random quadrilaterals that hold at least this share of a region.

    Args:
        mask: (H, W) soft membership of the region.
        share: Crops that hold less of the region are drawn again; after a few tries the one that
            holds most is taken.

    Returns:
        (count, 4, 2) corners as from `quads`.
    """
    tries = quads(count * _TRIES, generator)
    small = F.interpolate(mask.detach().cpu().float()[None, None], size=(32, 32), mode="area")[0, 0]
    low, high = tries.amin(1), tries.amax(1)
    grid = (torch.arange(32) + 0.5) / 16.0 - 1.0
    inside_x = (grid >= low[:, :1]) & (grid <= high[:, :1])
    inside_y = (grid >= low[:, 1:]) & (grid <= high[:, 1:])
    held = torch.einsum("nh,hw,nw->n", inside_y.float(), small, inside_x.float())
    held = (held / small.sum().clamp_min(1e-6)).view(count, _TRIES)
    enough = (held >= share).float()
    pick = torch.where(enough.any(1), enough.argmax(1), held.argmax(1))
    return tries.view(count, _TRIES, 4, 2)[torch.arange(count), pick]


def warp(pictures: Tensor, corners: Tensor, size: int) -> Tensor:
    """The views that the quadrilaterals cut out.

    Args:
        pictures: (B, C, H, W), or (1, C, H, W) for views of one picture.
        corners: (B, 4, 2) as from `quads`.
        size: Side of the result, pixels.

    Returns:
        (B, C, size, size), differentiable in the pictures.
    """
    pictures = _shrink(pictures, 2 * size)
    count = len(corners)
    axis = (torch.arange(size, dtype=torch.float64) + 0.5) * (2.0 / size) - 1.0
    y, x = torch.meshgrid(axis, axis, indexing="ij")
    points = torch.stack([x, y, torch.ones_like(x)], -1).view(-1, 3)
    mapped = points @ _homographies(corners.double()).transpose(1, 2)
    grid = (mapped[..., :2] / mapped[..., 2:]).view(count, size, size, 2).to(pictures)
    return F.grid_sample(pictures.expand(count, -1, -1, -1), grid, padding_mode="border", align_corners=False)


def whole(pictures: Tensor, size: int) -> Tensor:
    """The uncropped picture, squeezed to a square.

    Args:
        pictures: (B, C, H, W).
        size: Side of the result, pixels.

    Returns:
        (B, C, size, size), differentiable in the pictures.
    """
    return F.interpolate(pictures, size=(size, size), mode="bilinear", antialias=True, align_corners=False)


def _shrink(pictures: Tensor, most: int) -> Tensor:
    """Halves pictures while they are far larger than what is sampled from them: no aliasing."""
    while min(pictures.shape[-2:]) >= 2 * most:
        pictures = F.avg_pool2d(pictures, 2)
    return pictures


def _homographies(corners: Tensor) -> Tensor:
    """(B, 3, 3) maps of the square [-1, 1]² onto quadrilaterals (B, 4, 2).

    The eight equations of the direct linear transform, with the ninth entry fixed to 1.
    """
    source = _CORNERS.to(corners).expand(len(corners), -1, -1)
    x, y = source.unbind(-1)
    u, v = corners.unbind(-1)
    one, zero = torch.ones_like(x), torch.zeros_like(x)
    rows_u = torch.stack([x, y, one, zero, zero, zero, -u * x, -u * y], -1)
    rows_v = torch.stack([zero, zero, zero, x, y, one, -v * x, -v * y], -1)
    solved = torch.linalg.solve(torch.cat([rows_u, rows_v], 1), torch.cat([u, v], 1))
    return torch.cat([solved, torch.ones_like(solved[:, :1])], 1).view(-1, 3, 3)
