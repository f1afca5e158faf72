# SPDX-License-Identifier: Apache-2.0
"""An image as it is measured: its colors, and what the camera sees in every pixel."""

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

FEW = 32  # shading of fewer pixels is not measured
GRAIN = 192  # longer side, in pixels, of the image that slopes are stated for
_ADAPTED = 0.7  # share of the light's color, and of its dimness in stops, that the eye adapts to


@dataclass(frozen=True)
class MeasuredPicture:
    """An image (H, W, 3) of the proxy or of Cycles, sRGB-encoded in [0, 1], and what the camera sees in its pixels."""

    display: Float[Tensor, "h w 3"]
    seen: GBuffer

    @classmethod
    def of(cls, display: Tensor, seen: GBuffer) -> MeasuredPicture:
        """An image (H, W, 3) of any size, averaged to the size of the camera's view."""
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
        """The same image as it looks to people who have adapted to the light in the region `where`.

        A white car in blue light looks nearly white, and a red one in dim light red. Each type of cone adapts
        independently (von Kries 1902), to a degree of 0.7 to that light and for the rest to the image's own white
        (Fairchild 2020). A region that is brighter than a white surface in that light glows, and keeps its colors.
        """
        gray = None if self.seen.gray is None else linear_from_srgb(self.seen.gray[where]).mean(0)
        if gray is None or luminance(gray) < 1e-4:
            return self  # the light has no color to adapt to
        to_cones, from_cones = gray.new_tensor(CONES_FROM_REC709), gray.new_tensor(REC709_FROM_CONES)
        light = to_cones @ (gray / luminance(gray))
        dimness = 0.18 / luminance(gray)
        level = dimness.clamp(1.0, 6.0) ** _ADAPTED  # to dimmer light the eye adapts no further
        scale = level / (_ADAPTED * light + (1.0 - _ADAPTED) * to_cones.sum(1))
        display = linear_from_srgb(self.display)
        adapted = display @ (from_cones @ (scale[:, None] * to_cones)).T
        glow = (luminance(display[where].detach()).mean() * dimness - 1.0).clamp(0.0, 1.0)
        return replace(self, display=srgb_from_linear(torch.lerp(adapted, display, glow)))

    @cached_property
    def luminance(self) -> Float[Tensor, "h w"]:
        """Linear luminance as displayed."""
        return luminance(linear_from_srgb(self.display))[..., 0]

    @cached_property
    def shading(self) -> Float[Tensor, "h w"]:
        """Linear luminance, divided by the luminance of the texture relative to its mean."""
        # Darker parts of a pattern mirror rather than scatter light.
        return self.luminance / self.seen.pattern.clamp_min(0.05)


def is_black(display: Tensor) -> bool:
    """True for an image (H, W, 3) in [0, 1] that shows nothing."""
    return bool(display.max() < 0.02)


def region_of(seen: GBuffer, part: Part, materials: tuple[str, ...] = ()) -> Bool[Tensor, "h w"]:
    """The pixels in a part of the image or, if materials are named, those that show one of them; without outlines."""
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
    """A region (H, W) without its outline; the whole region if that would leave less than a quarter, as of wires."""
    inside = where & ~(largest_around(~where, 3) > 0)
    return inside if inside.sum() >= 0.25 * where.sum() else where
