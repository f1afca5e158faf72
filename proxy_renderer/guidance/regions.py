# SPDX-License-Identifier: Apache-2.0
"""Views of the regions of an image, as the encoder sees them: random large crops under a random perspective.

text2mesh and CLIPasso do the same. Colors stay as they are, because the encoder judges them.
"""

from dataclasses import dataclass

import torch
import torch.nn.functional as F
from torch import Tensor

_CORNERS = torch.tensor([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
_TRIES, _HELD = 8, 0.7  # random crops for each that is chosen; share of a region that a crop has to show
_SCALE = (0.75, 1.0)  # of a crop's side, relative to the image's


def quads(count: int, generator: torch.Generator) -> Tensor:
    """Random quadrilaterals to cut views from: corners (count, 4, 2), x, y in [-1, 1], clockwise from the top left."""
    side = _SCALE[0] + (_SCALE[1] - _SCALE[0]) * torch.rand(count, 1, 1, generator=generator)
    center = (2.0 * torch.rand(count, 1, 2, generator=generator) - 1.0) * (1.0 - side)
    inwards = 1.0 - 0.2 * torch.rand(count, 4, 2, generator=generator)  # the corners are distorted
    return center + side * _CORNERS * inwards


def keeping(mask: Tensor, count: int, generator: torch.Generator) -> Tensor:
    """Random quadrilaterals, see `quads`, that show enough of the region `mask` (H, W), or the most of a few tries."""
    tries = quads(count * _TRIES, generator)
    small = F.interpolate(mask.detach().cpu().float()[None, None], size=(32, 32), mode="area")[0, 0]
    low, high = tries.amin(1), tries.amax(1)
    grid = (torch.arange(32) + 0.5) / 16.0 - 1.0
    inside_x = (grid >= low[:, :1]) & (grid <= high[:, :1])
    inside_y = (grid >= low[:, 1:]) & (grid <= high[:, 1:])
    held = torch.einsum("nh,hw,nw->n", inside_y.float(), small, inside_x.float())
    held = (held / small.sum().clamp_min(1e-6)).view(count, _TRIES)
    enough = (held >= _HELD).float()
    pick = torch.where(enough.any(1), enough.argmax(1), held.argmax(1))
    return tries.view(count, _TRIES, 4, 2)[torch.arange(count), pick]


def warp(pictures: Tensor, corners: Tensor, size: int) -> Tensor:
    """The views (B, C, size, size) that quadrilaterals (B, 4, 2) cut out of images (B or 1, C, H, W), with gradients."""
    # Images are halved while they are far larger than the views, against aliasing.
    while min(pictures.shape[-2:]) >= 4 * size:
        pictures = F.avg_pool2d(pictures, 2)
    count = len(corners)
    axis = (torch.arange(size, dtype=torch.float64) + 0.5) * (2.0 / size) - 1.0
    y, x = torch.meshgrid(axis, axis, indexing="ij")
    points = torch.stack([x, y, torch.ones_like(x)], -1).view(-1, 3)

    # Homographies (B, 3, 3) from [-1, 1]² to the quadrilaterals, by the direct linear transform with h₃₃ = 1
    x, y = _CORNERS.double().expand(count, -1, -1).unbind(-1)
    u, v = corners.double().unbind(-1)
    one, zero = torch.ones_like(x), torch.zeros_like(x)
    rows_u = torch.stack([x, y, one, zero, zero, zero, -u * x, -u * y], -1)
    rows_v = torch.stack([zero, zero, zero, x, y, one, -v * x, -v * y], -1)
    solved = torch.linalg.solve(torch.cat([rows_u, rows_v], 1), torch.cat([u, v], 1))
    homographies = F.pad(solved, (0, 1), value=1.0).view(-1, 3, 3)

    mapped = points @ homographies.transpose(1, 2)
    grid = (mapped[..., :2] / mapped[..., 2:]).view(count, size, size, 2).to(pictures)
    return F.grid_sample(pictures.expand(count, -1, -1, -1), grid, padding_mode="border", align_corners=False)


def whole(pictures: Tensor, size: int) -> Tensor:
    """The uncropped images (B, C, H, W), scaled to squares (B, C, size, size), with gradients."""
    return F.interpolate(pictures, size=(size, size), mode="bilinear", antialias=True, align_corners=False)


@dataclass(frozen=True)
class Views:
    """Number of views (crops) of each region in a step."""

    subject: int = 3
    surroundings: int = 2
    whole: int = 3


def mean(values: Tensor, mask: Tensor) -> Tensor:
    """Mean (C,) of values (H, W, C) over a region, the soft `mask` (H, W); 0 if the region is empty."""
    weight = mask[..., None]
    return (values * weight).sum((0, 1)) / weight.sum((0, 1)).clamp_min(1e-6)


def subject_views(display: Tensor, mask: Tensor, count: int, generator: torch.Generator, size: int) -> Tensor:
    """Views (count, 3, size, size) of the subject, I ⊙ M, framed closely, each on another plain background.

    Half of the backgrounds are random colors, so that a change behind the subject cannot make the subject fit the words
    (CLIP-Mesh). The others are the mean color of the surroundings, so that the subject is judged in its own light.
    """
    box = _frame(mask)
    display, mask = display[box], mask[box]
    backgrounds = torch.rand(count, 3, generator=generator).to(display)
    backgrounds[::2] = mean(display, 1.0 - mask).detach()
    layers = torch.cat([display * mask[..., None], mask[..., None]], -1).permute(2, 0, 1)[None]
    cut = warp(layers, keeping(mask, count, generator), size)
    return cut[:, :3] + (1.0 - cut[:, 3:]) * backgrounds[:, :, None, None]


def surroundings_views(display: Tensor, mask: Tensor, count: int, generator: torch.Generator, size: int) -> Tensor:
    """Views (count, 3, size, size) of I ⊙ (1 − M); the mean color of what remains fills the hole of the subject."""
    rest = (1.0 - mask)[..., None]
    filled = display * rest + mask[..., None] * mean(display, 1.0 - mask)
    return warp(filled.permute(2, 0, 1)[None], keeping(1.0 - mask, count, generator), size)


def whole_views(display: Tensor, count: int, generator: torch.Generator, size: int) -> Tensor:
    """The full frame of an image (H, W, 3) first, then count - 1 random large crops of it: (count, 3, size, size)."""
    picture = display.permute(2, 0, 1)[None]
    full = whole(picture, size)
    if count == 1:
        return full
    return torch.cat([full, warp(picture, quads(count - 1, generator), size)])


def _frame(mask: Tensor) -> tuple[slice, ...]:
    """Rows and columns of a nearly square window around the subject, with a margin; all without a subject."""
    solid = mask.detach() > 0.5
    if not solid.any():
        return slice(None), slice(None)
    ends = [(int(axis[0]), int(axis[-1]) + 1) for axis in (solid.any(1).nonzero(), solid.any(0).nonzero())]
    half = max(high - low for low, high in ends) * 0.65
    axes = zip(((low + high) / 2 for low, high in ends), mask.shape, strict=True)
    return tuple(slice(max(int(middle - half), 0), min(int(middle + half) + 1, size)) for middle, size in axes)
