# SPDX-License-Identifier: Apache-2.0
"""From scene-linear light (H, W, 3) to the image that an artist sees: Vibe Grade, then the scene's view transform.

The grade is the torch twin, node by node, of the compositor group that the add-on builds. Sources: Blender's compositor nodes
Color Balance, Gamma, Hue/Saturation/Value and Glare (high quality), whose bloom downsamples highlights step by step and adds up
all sizes (Jimenez, "Next Generation Post Processing in Call of Duty: Advanced Warfare", 2014).
"""

import math
from collections.abc import Mapping

import torch
from jaxtyping import Float
from torch import Tensor
from torch.nn import functional

from ..color.tensors import by_stops, luminance
from ..color.view_transform import ViewTransform
from ..scene import FilmSettings
from ..schema import FAMILIES
from ..schema.radiometry import TABLE_STOPS, TABLE_TOE

Picture = Float[Tensor, "*pixels 3"]
Channels = Float[Tensor, "#3"]
Amount = Float[Tensor, "*one"]
_CLEAR = 1e-3  # least coverage that colors are divided by
MIDDLE_GRAY = 0.18
_BLACK = 1e-6  # replaces 0 as the base of a power, whose gradient at 0 may be infinite
BLOOM_THRESHOLD, BLOOM_SMOOTHNESS, BLOOM_SIZE = 1.0, 0.1, 0.5
"""Settings of the Glare node in the add-on's grade: least brightness that glows, softness of that limit, glow size."""


class Film:
    """Turns linear images of one size into display images; raises VibeError if the view transform cannot be read."""

    def __init__(self, spec: FilmSettings, size: tuple[int, int], device: str = "cpu") -> None:
        chosen = spec.ocio, spec.display, spec.view, spec.look, spec.working_space
        self._view = ViewTransform(*chosen, device, spec.white_balance)
        self._gain = spec.gain
        self._compositor: Tensor | None = None  # (1, 3, S, S, S) table; axes and values are in stops
        if spec.compositor is not None:
            self._compositor = torch.from_numpy(spec.compositor).permute(3, 0, 1, 2)[None].contiguous().to(device)
        self._falloff = falloff(*size).to(device)

    def develop(self, linear: Tensor, values: Mapping[str, Tensor], alpha: Tensor | None = None) -> Tensor:
        """Display-encoded image (H, W, 3) in [0, 1]; transparent parts are black.

        `linear` (H, W, 3) is scene-linear light before the grade, multiplied by the coverage `alpha` (H, W); None if
        the film shows the background. `values`: parameter key -> components; parameters that are missing are neutral.
        """
        graded = self.grade(linear, values)
        if alpha is None:
            return self.show(graded, values)
        # Blender divides by alpha before its view transform (imbuf, IMB_colormanagement). PNGs are left so; here the result
        # is put on black.
        alpha = alpha.clamp(0, 1)[..., None]
        return self.show(graded / alpha.clamp_min(_CLEAR), values) * alpha

    def grade(self, linear: Tensor, values: Mapping[str, Tensor]) -> Tensor:
        """Applies the renderer's gain, the artist's compositor, and the nodes of the group "Vibe Grade" in order."""
        set_ = _Settings(values, linear)
        c = linear if self._gain == 1.0 else linear * self._gain
        if self._compositor is not None:
            stops = by_stops(self._compositor, c.clamp_min(0), TABLE_TOE, TABLE_STOPS)
            c = stops.sign() * TABLE_TOE * (torch.exp2(stops.abs()) - 1)
        if set_.moves("glare"):
            c = c.clamp_min(0) + set_["glare"] * bloom(c)
        if set_.moves("grade_exposure"):
            c = c * torch.exp2(set_["grade_exposure"])
        if set_.moves("lift", "midtone", "gain"):
            c = lift_gamma_gain(c, set_["lift"], set_["midtone"], set_["gain"])
        if set_.moves("contrast"):
            c = contrast(c, set_["contrast"])
        if set_.moves("saturation"):
            c = saturation(c, set_["saturation"])
        if set_.moves("hue"):
            c = turn_hue(c.clamp_min(0), set_["hue"])
        if set_.moves("grade_gamma"):
            c = power(c, set_["grade_gamma"])
        if set_.moves("vignette"):
            c = c * (1 - set_["vignette"] * self._falloff)
        return c

    def show(self, graded: Tensor, values: Mapping[str, Tensor]) -> Tensor:
        """Image (H, W, 3) in [0, 1] by Blender's color management: exposure, white balance, OCIO view, gamma."""
        set_ = _Settings(values, graded)
        if set_.moves("exposure"):
            graded = graded * torch.exp2(set_["exposure"])
        display = self._view(graded).clamp(0, 1)
        if set_.moves("gamma"):
            display = display.clamp_min(1e-8) ** (1 / set_["gamma"])
        return display


class _Settings:
    """Name of a film parameter -> its value; parameters that are missing have the schema's neutral values."""

    def __init__(self, values: Mapping[str, Tensor], like: Tensor) -> None:
        self._values, self._like = values, like

    def __getitem__(self, name: str) -> Tensor:
        value = self._values.get(f"film/{name}")
        return value if value is not None else self._like.new_full((1,), FAMILIES[f"film/{name}"].default)

    def moves(self, *names: str) -> bool:
        """True if any of the named values is not neutral, or needs a gradient."""
        pairs = ((self[name], FAMILIES[f"film/{name}"].default) for name in names)
        return any(value.requires_grad or bool((value != neutral).any()) for value, neutral in pairs)


def power(picture: Picture, exponent: Amount) -> Picture:
    """Blender's Gamma node: image ** exponent for positive values; others stay as they are."""
    return torch.where(picture > _BLACK, picture.clamp_min(_BLACK) ** exponent, picture)


def lift_gamma_gain(picture: Picture, lift: Channels, midtone: Channels, gain: Channels) -> Picture:
    """Blender's Color Balance node, type Lift/Gamma/Gain, whose settings are colors (3,), 1 for no change."""
    scaled = ((picture - 1) * (2 - lift) + 1) * gain
    return scaled.clamp_min(_BLACK) ** (1 / midtone.clamp_min(_BLACK)) * (scaled > 0)


def contrast(picture: Picture, amount: Amount) -> Picture:
    """A power curve that keeps middle gray: 0.18 · (c / 0.18) ** amount."""
    return MIDDLE_GRAY * power(picture / MIDDLE_GRAY, amount)


def saturation(picture: Picture, amount: Amount) -> Picture:
    """Interpolates from a gray of the same luminance (amount 0) to the image (1) and beyond; never negative."""
    gray = luminance(picture)
    return (gray + (picture - gray) * amount).clamp_min(0)


def turn_hue(picture: Picture, degrees: Amount) -> Picture:
    """Blender's Hue/Saturation/Value node with only the hue turned, by `degrees`; the image must be ≥ 0."""
    brightest, darkest = picture.amax(-1, keepdim=True), picture.amin(-1, keepdim=True)
    chroma = brightest - darkest
    r, g, b = ((brightest - picture) / chroma.clamp_min(_BLACK)).unbind(-1)
    red, green, blue = picture.unbind(-1)
    sixth = torch.where(green >= blue, 2 + r - b, 4 + g - r)
    sixth = torch.where((red >= green) & (red >= blue), b - g, sixth)
    sixth = sixth[..., None] + degrees / 60 - picture.new_tensor((0.0, 2.0, 4.0))
    # Distance of each primary from the new hue, in sixths of the circle.
    away = (torch.remainder(sixth + 3, 6) - 3).abs()
    return brightest - chroma * (away - 1).clamp(0, 1)


def falloff(width: int, height: int) -> Float[Tensor, "{height} {width} 1"]:
    """Share of light that a full vignette removes from each pixel (H, W, 1): 0 in the middle, 1 in the corners."""
    x, y = ((torch.arange(n) + 0.5) / n * 2 - 1 for n in (width, height))
    radius = ((x[None, :] ** 2 + y[:, None] ** 2) / 2).sqrt()
    t = ((radius - 0.3) / 0.7).clamp(0, 1)
    return (t * t * (3 - 2 * t))[..., None]


def bloom(picture: Tensor) -> Tensor:
    """Light (H, W, 3) that Blender's Glare node adds at strength 1 to a linear image (H, W, 3)."""
    # Colors whose HSV value is lowered by the bloom threshold, with a smooth start.
    value = picture.amax(-1, keepdim=True)
    near = (BLOOM_SMOOTHNESS - (value - BLOOM_THRESHOLD).abs()).clamp_min(0) / BLOOM_SMOOTHNESS
    above = (value - BLOOM_THRESHOLD).clamp_min(0) + near * near * (BLOOM_SMOOTHNESS / 4)
    highlights = picture.clamp_min(0) * (above / value.clamp_min(1e-6))
    layers = [highlights.permute(2, 0, 1)[None]]
    length = int(math.log2(max(min(picture.shape[:2]) * BLOOM_SIZE, 1)))
    for level in range(length - 1):
        layers.append(_halve(layers[-1], calm=level == 0))
    total = layers[-1]
    for finer in reversed(layers[:-1]):
        wide = functional.interpolate(total, size=finer.shape[-2:], mode="bilinear")
        around = functional.pad(wide, (1, 1, 1, 1), mode="replicate")
        total = finer + functional.avg_pool2d(functional.avg_pool2d(around, 2, 1), 2, 1)  # the filter (1, 2, 1)² / 16
    return total[0].permute(1, 2, 0) / len(layers)  # an even highlight thus adds its own light once


def _halve(layer: Tensor, calm: bool) -> Tensor:
    """Downsamples a layer (1, 3, H, W) to half its size.

    A pixel is half the square in its middle, and half the mean of the four overlapping squares around it. A square is
    the mean of four 2×2 blocks. With `calm`, bright blocks weigh less, against fireflies.
    """
    blocks = functional.avg_pool2d(functional.pad(layer, (3, 3, 3, 3), mode="replicate"), 2, 1)
    squares = _corners(blocks)
    if calm:
        weight = 1 / (1 + blocks.amax(1, keepdim=True).clamp_min(1))  # Blender counts the alpha of 1, too
        squares = _corners(blocks * weight) / _corners(weight)
    rows, columns = (n // 2 for n in layer.shape[-2:])
    sides = _corners(squares[..., 1:, 1:])[..., ::2, ::2]
    middle = squares[..., 2::2, 2::2]
    return (middle[..., :rows, :columns] + sides[..., :rows, :columns]) / 2


def _corners(field: Tensor) -> Tensor:
    """Mean of the four corners of every 3×3 square."""
    wide = field[..., :-2] + field[..., 2:]
    return (wide[..., :-2, :] + wide[..., 2:, :]) / 4
