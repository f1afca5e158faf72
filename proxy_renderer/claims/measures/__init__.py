# SPDX-License-Identifier: Apache-2.0
"""All measures by name, with their units and the differences that people notice."""

import re
from collections.abc import Callable
from dataclasses import dataclass

from torch import Tensor

from . import color, light


@dataclass(frozen=True)
class Measure:
    """A function that reads one or several numbers from a region of an image, with its unit and its name in reports."""

    take: Callable[..., Tensor]  # (image, region (H, W) bool with at least one pixel) -> (n,) numbers
    unit: str  # for the report
    notice: float  # the least difference between two images that people notice side by side
    sentence: str  # the measure in words; "{}" stands for the target
    directed: bool = False  # whether `take` also needs a direction: a unit vector (2,) in a* and b*
    of_finish: bool = False  # whether it is about a surface's finish, which light and film could only fake
    beside: bool = False  # whether it compares a region with the surroundings

    @property
    def says(self) -> str:
        """The measure's name in the report, without the target."""
        return re.sub(r" \w+ the \{\}", "", self.sentence)


MEASURES: dict[str, Measure] = {
    "color": Measure(color.color, "OKLab", 2.0, "color of the {}"),
    "tint": Measure(color.tint, "a*b*", 2.0, "tint of the {}"),
    "off_hue": Measure(color.tint, "a*b*", 2.0, "tint of the {} beside the color of the light"),
    "accent": Measure(color.accent, "a*b*", 2.0, "tint of a tenth of the {}", directed=True),
    "lightness": Measure(color.lightness, "L*", 2.0, "lightness of the {}"),
    "chroma": Measure(color.chroma, "C*", 2.0, "chroma of the {}"),
    "vividest": Measure(color.vividest, "C*", 3.0, "chroma of the most vivid parts of the {}"),
    "colorfulness": Measure(color.colorfulness, "", 5.0, "colorfulness of the {}"),
    "warmth": Measure(color.warmth, "b*", 1.5, "warmth of the {}"),
    "shadow_warmth": Measure(color.warmth_between(0.0, 0.3), "b*", 1.5, "warmth of the shadows of the {}"),
    "highlight_warmth": Measure(color.warmth_between(0.7, 1.0), "b*", 1.5, "warmth of the lit parts of the {}"),
    "brown_distance": Measure(color.brown_distance, "a*b*", 1.5, "distance of the {} from tints of brown"),
    "contrast": Measure(color.contrast, "L*", 3.0, "contrast of the {}"),
    "black_point": Measure(color.tone(0.02), "L*", 2.0, "lightness of the darkest parts of the {}"),
    "white_point": Measure(color.tone(0.98), "L*", 2.0, "lightness of the lightest parts of the {}"),
    "vignette": Measure(color.vignette, "L*", 1.5, "darkening of the corners of the {}"),
    "standing_out": Measure(color.standing_out, "L*", 3.0, "lightness of the {} above the surroundings", beside=True),
    "silhouette": Measure(color.silhouette, "L*", 3.0, "darkness of the {} against the surroundings", beside=True),
    "separation": Measure(color.separation, "ΔE", 2.0, "color distance of the {} from what is around it"),
    "burnt": Measure(color.beyond(97.0, 1), "", 0.02, "overexposed share of the {}"),
    "clipped": Measure(color.clipped, "", 0.01, "share of the {} with a clipped channel"),
    "drowned": Measure(color.beyond(4.0, -1), "", 0.02, "share of the {} that drowns in black"),
    "light_right": Measure(light.light_along(0), "of 1", 0.1, "light from the right on the {}"),
    "light_up": Measure(light.light_along(1), "of 1", 0.1, "light from above on the {}"),
    "light_front": Measure(light.light_along(2), "of 1", 0.1, "light from the camera's side on the {}"),
    "hardness": Measure(light.hardness, "stops per pixel", 0.05, "steepness of shadow edges in the {}"),
    "key_to_fill": Measure(light.key_to_fill, "stops", 0.3, "contrast of light and shade on the {}"),
    "rim": Measure(light.rim, "L*", 3.0, "lightness of the outline of the {} above the inside"),
    "gloss": Measure(light.gloss, "L*", 1.5, "contrast of highlights on the {}", of_finish=True),
    "sharpness": Measure(light.sharpness, "L* per pixel", 0.4, "sharpness of reflections on the {}", of_finish=True),
    "unscattered": Measure(
        light.unscattered, "", 0.05, "share of mirrored or transmitted light on the {}", of_finish=True
    ),
    "sheen": Measure(light.sheen, "", 0.05, "glow along the edges of the {}", of_finish=True),
    "mean": Measure(color.mean, "OKLab", 1.0, "color of the {}"),
    "chromaticity": Measure(color.chromaticity, "OKLab", 1.0, "color of the {} in any light"),
    "lower_quartile": Measure(color.tone(0.25), "L*", 2.0, "lightness of the darker quarter of the {}"),
    "median": Measure(color.tone(0.5), "L*", 2.0, "median lightness of the {}"),
    "upper_quartile": Measure(color.tone(0.75), "L*", 2.0, "lightness of the lighter quarter of the {}"),
    "spread": Measure(color.spread, "L*", 3.0, "lightness range of the {}"),
    "cast": Measure(color.cast_between(0.0, 1.0), "a*b*", 2.0, "cast of the {}"),
    "shadow_cast": Measure(color.cast_between(0.02, 0.25), "a*b*", 2.0, "cast of shadows of the {}"),
    "midtone_cast": Measure(color.cast_between(0.25, 0.75), "a*b*", 2.0, "cast of midtones of the {}"),
    "highlight_cast": Measure(color.cast_between(0.75, 0.98), "a*b*", 2.0, "cast of highlights of the {}"),
    "from_right": Measure(color.across(1, 1), "L*", 3.0, "lightness of the right of the {} above the left"),
    "from_above": Measure(color.across(0, -1), "L*", 3.0, "lightness of the top of the {} above its foot"),
    "veil": Measure(color.veil, "%", 3.0, "veil of light over the {}"),
    "haze": Measure(light.haze, "", 0.04, "share of light that the air takes from the {}"),
    "mist_below": Measure(light.mist_below, "", 0.04, "haze at the foot of the {} beyond that above"),
    "air_lightness": Measure(light.air_lightness, "L*", 2.0, "lightness of the air before the {}"),
}
"""Measures by their names in `quantities.toml` and in the wishes of the vocabulary."""
