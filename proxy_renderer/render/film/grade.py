# SPDX-License-Identifier: Apache-2.0
"""Vibe Grade, node by node: the torch twin of the compositor group that the add-on builds.

Pictures are scene-linear (H, W, 3). Sources: Blender's compositor nodes Color Balance, Gamma, Hue/Saturation/Value.
"""

from __future__ import annotations

import torch
from jaxtyping import Float
from torch import Tensor

from ...color.tensors import luminance

MIDDLE_GRAY = 0.18
_BLACK = 1e-6  # stands in for 0 under a power, whose gradient there may be infinite


def power(picture: Float[Tensor, "*pixels 3"], exponent: Float[Tensor, "*one"]) -> Float[Tensor, "*pixels 3"]:
    """Blender's Gamma node: picture ** exponent where it is positive; the rest stays as it is."""
    return torch.where(picture > _BLACK, picture.clamp_min(_BLACK) ** exponent, picture)


def lift_gamma_gain(
    picture: Float[Tensor, "*pixels 3"],
    lift: Float[Tensor, "#3"],
    midtone: Float[Tensor, "#3"],
    gain: Float[Tensor, "#3"],
) -> Float[Tensor, "*pixels 3"]:
    """Blender's Color Balance node, type Lift/Gamma/Gain; each color (3,), 1 for no change."""
    lifted = (picture - 1) * (2 - lift) + 1
    scaled = lifted * gain
    return scaled.clamp_min(_BLACK) ** (1 / midtone.clamp_min(_BLACK)) * (scaled > 0)


def contrast(
    picture: Float[Tensor, "*pixels 3"], amount: Float[Tensor, "*one"]
) -> Float[Tensor, "*pixels 3"]:
    """A power around middle gray, which stays: 0.18 · (c / 0.18) ** amount."""
    return MIDDLE_GRAY * power(picture / MIDDLE_GRAY, amount)


def saturation(
    picture: Float[Tensor, "*pixels 3"], amount: Float[Tensor, "*one"]
) -> Float[Tensor, "*pixels 3"]:
    """Between gray of the same luminance (0), the picture (1) and beyond; never negative."""
    gray = luminance(picture)
    return (gray + (picture - gray) * amount).clamp_min(0)


def turn_hue(
    picture: Float[Tensor, "*pixels 3"], degrees: Float[Tensor, "*one"]
) -> Float[Tensor, "*pixels 3"]:
    """Blender's Hue/Saturation/Value node with only the hue turned; picture ≥ 0."""
    brightest, darkest = picture.amax(-1, keepdim=True), picture.amin(-1, keepdim=True)
    chroma = brightest - darkest
    r, g, b = ((brightest - picture) / chroma.clamp_min(_BLACK)).unbind(-1)
    red, green, blue = picture.unbind(-1)
    sixth = torch.where(
        (red >= green) & (red >= blue), b - g, torch.where(green >= blue, 2 + r - b, 4 + g - r)
    )
    sixth = sixth[..., None] + degrees / 60 - picture.new_tensor((0.0, 2.0, 4.0))
    away = (
        torch.remainder(sixth + 3, 6) - 3
    ).abs()  # of each primary from the new hue, in sixths of the circle
    return brightest - chroma * (away - 1).clamp(0, 1)


def falloff(width: int, height: int) -> Float[Tensor, "{height} {width} 1"]:
    """What a full vignette takes from each pixel (H, W, 1): 0 in the middle, 1 in the corners."""
    x, y = ((torch.arange(n) + 0.5) / n * 2 - 1 for n in (width, height))
    radius = ((x[None, :] ** 2 + y[:, None] ** 2) / 2).sqrt()
    t = ((radius - 0.3) / 0.7).clamp(0, 1)
    return (t * t * (3 - 2 * t))[..., None]
