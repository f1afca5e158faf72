# SPDX-License-Identifier: Apache-2.0
"""A picture as it is measured: its colors, and what the camera sees in every pixel."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import torch
import torch.nn.functional as F
from jaxtyping import Bool, Float
from torch import Tensor

from ...color.constants import CONES_FROM_REC709, REC709_FROM_CONES
from ...color.tensors import lab_from_srgb, linear_from_srgb, luminance, oklab_from_srgb, srgb_from_linear
from ...render.surface.view_cache import GBuffer
from ...words.types import Part

FEW = 32  # pixels of which nothing is told
GRAIN = 192  # slopes are given per pixel of a picture of this size
_BLACK = 0.02  # of white, as an image is stored: what is darker everywhere shows nothing
_ADAPTED = 0.7  # share of the light's color that is not noticed, and of its stops, where it is dim
_MIDDLE = 0.18  # of white: gray in light that is not dim
_DIM = 6.0  # times darker, beyond which things are dark
_UNLIT = 1e-4  # of white: light that has no color to adapt to
_DARKEST = 0.05  # of a pattern, relative to its mean: what is darker mirrors rather than scatters light


@dataclass(frozen=True)
class MeasuredPicture:
    """An image (H, W, 3) of the proxy or of Cycles, sRGB-encoded in [0, 1], and the camera's view there, of the same size."""

    display: Float[Tensor, "h w 3"]
    seen: GBuffer

    @classmethod
    def of(cls, display: Tensor, seen: GBuffer) -> MeasuredPicture:
        """A picture of any size (H, W, 3), averaged to the pixels of what is seen."""
        shape = seen.subject.shape
        if display.shape[:2] != shape:
            planes = display.permute(2, 0, 1)[None]
            display = F.interpolate(planes, shape, mode="area")[0].permute(1, 2, 0)
        return cls(display.to(seen.subject), seen)

    @cached_property
    def lab(self) -> Float[Tensor, "h w 3"]:
        """CIE Lab."""
        return lab_from_srgb(self.display)

    @cached_property
    def oklab(self) -> Float[Tensor, "h w 3"]:
        """OKLab, times 100."""
        return 100 * oklab_from_srgb(self.display)

    def in_white_light(self, where: Tensor) -> MeasuredPicture:
        """The same picture as it looks to people who have adapted to the light in the region `where`.

        A white car in blue light looks nearly white, and a red one in dim light red. The cones adapt each by itself (von Kries
        1902), and to a degree of 0.7, with the picture's own white for the rest (Fairchild 2020). What is brighter than white
        would be in that light glows by itself, and looks as it is.
        """
        gray = None if self.seen.gray is None else linear_from_srgb(self.seen.gray[where]).mean(0)
        if gray is None or luminance(gray) < _UNLIT:
            return self
        to_cones, from_cones = gray.new_tensor(CONES_FROM_REC709), gray.new_tensor(REC709_FROM_CONES)
        light = to_cones @ (gray / luminance(gray))
        dimness = _MIDDLE / luminance(gray)
        level = dimness.clamp(1.0, _DIM) ** _ADAPTED
        scale = level / (_ADAPTED * light + (1.0 - _ADAPTED) * to_cones.sum(1))
        display = linear_from_srgb(self.display)
        adapted = display @ (from_cones @ (scale[:, None] * to_cones)).T
        glow = (luminance(display[where].detach()).mean() * dimness - 1.0).clamp(0.0, 1.0)
        return replace(self, display=srgb_from_linear(torch.lerp(adapted, display, glow)))

    @cached_property
    def luminance(self) -> Float[Tensor, "h w"]:
        """Linear light as shown."""
        return luminance(linear_from_srgb(self.display))[..., 0]

    @cached_property
    def shading(self) -> Float[Tensor, "h w"]:
        """Linear light without what textures make of it."""
        return self.luminance / self.seen.pattern.clamp_min(_DARKEST)


def is_black(display: Tensor) -> bool:
    """True for an image (H, W, 3) in [0, 1] that shows nothing."""
    return bool(display.max() < _BLACK)


def region_of(seen: GBuffer, part: Part, materials: tuple[str, ...] = ()) -> Bool[Tensor, "h w"]:
    """The pixels that lie wholly in a part of the image, or show one of these materials, if there are any names."""
    if materials:
        numbers = [i for i, name in enumerate(seen.materials) if name in materials]
        return _inner(torch.isin(seen.material, torch.tensor(numbers, device=seen.material.device)))
    if part == "picture":
        return torch.ones_like(seen.subject, dtype=torch.bool)
    if part == "subject":
        return _inner(seen.subject > 0.9)
    around = seen.subject < 0.05
    return _inner(around & (seen.material < 0) if part == "sky" else around)


def largest_around(field: Tensor, width: int) -> Float[Tensor, "h w"]:
    """The largest value of a field (H, W) in a square window of an odd width around each pixel."""
    planes = field[None, None].float()
    rows = F.max_pool2d(planes, (width, 1), stride=1, padding=(width // 2, 0))
    return F.max_pool2d(rows, (1, width), stride=1, padding=(0, width // 2))[0, 0]


def _inner(where: Tensor) -> Tensor:
    """A region (H, W) without its outline; the whole of it where it is all outline, as wires are."""
    inside = where & ~(largest_around(~where, 3) > 0)
    return inside if inside.sum() >= 0.25 * where.sum() else where
