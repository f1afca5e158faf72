# SPDX-License-Identifier: Apache-2.0
"""All measures by name, with their units and the differences that people notice."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from torch import Tensor

from . import color, light, tone


@dataclass(frozen=True)
class Measure:
    """A way to get numbers off an image."""

    # the image and a region (H, W) bool, of at least one pixel, in; (n,) numbers out
    take: Callable[..., Tensor]
    unit: str  # for the report
    notice: float  # the least difference between two images that people notice side by side
    says: str  # its name in the report
    # whether `take` also wants the (2,) direction in a* and b* of the color that it looks for
    directed: bool = False


MEASURES: dict[str, Measure] = {
    "color": Measure(color.color, "OKLab", 2.0, "color"),
    "tint": Measure(color.tint, "ab", 2.0, "tint"),
    "off_hue": Measure(color.tint, "ab", 2.0, "tint beside the color of the light"),
    "accent": Measure(color.accent, "ab", 2.0, "tint of a tenth", directed=True),
    "lightness": Measure(color.lightness, "L*", 2.0, "lightness"),
    "chroma": Measure(color.chroma, "C*", 2.0, "chroma"),
    "vividest": Measure(color.vividest, "C*", 3.0, "chroma of the most vivid"),
    "warmth": Measure(color.warmth, "b*", 1.5, "warmth"),
    "shadow_warmth": Measure(color.shadow_warmth, "b*", 1.5, "warmth of the shadows"),
    "highlight_warmth": Measure(color.highlight_warmth, "b*", 1.5, "warmth of the lights"),
    "brown_distance": Measure(color.brown_distance, "ab", 1.5, "distance from tints of brown"),
    "contrast": Measure(tone.contrast, "L*", 3.0, "from darkest to lightest"),
    "black_point": Measure(tone.black_point, "L*", 2.0, "lightness of the darkest"),
    "white_point": Measure(tone.white_point, "L*", 2.0, "lightness of the lightest"),
    "vignette": Measure(tone.vignette, "L*", 1.5, "darkening of the corners"),
    "standing_out": Measure(tone.standing_out, "L*", 3.0, "lightness above the surroundings"),
    "silhouette": Measure(tone.silhouette, "L*", 3.0, "a dark, even shape before a lighter ground"),
    "separation": Measure(tone.separation, "Lab", 2.0, "distance from what is right around"),
    "burnt": Measure(tone.burnt, "", 0.02, "share that is burnt out"),
    "drowned": Measure(tone.drowned, "", 0.02, "share that drowns in black"),
    "light_right": Measure(light.light_right, "", 0.1, "light from the right"),
    "light_up": Measure(light.light_up, "", 0.1, "light from above"),
    "light_front": Measure(light.light_front, "", 0.1, "light from the camera's side"),
    "hardness": Measure(light.hardness, "stops/px", 0.05, "steepness of shadow edges"),
    "key_to_fill": Measure(light.key_to_fill, "stops", 0.3, "from shade to light"),
    "rim": Measure(light.rim, "L*", 3.0, "lightness of the outline above the inside"),
    "gloss": Measure(light.gloss, "L*", 1.5, "contrast of highlights"),
    "sharpness": Measure(light.sharpness, "L*/px", 0.4, "sharpness of reflections"),
    "unscattered": Measure(light.unscattered, "", 0.05, "share of mirrored or transmitted light"),
    "sheen": Measure(light.sheen, "", 0.05, "glow along the edges"),
    "mean": Measure(color.mean, "OKLab", 1.0, "color"),
    "lower_quartile": Measure(color.tone(0.25), "L*", 2.0, "lightness of the darker quarter"),
    "median": Measure(color.tone(0.5), "L*", 2.0, "median lightness"),
    "upper_quartile": Measure(color.tone(0.75), "L*", 2.0, "lightness of the lighter quarter"),
    "spread": Measure(color.spread, "L*", 3.0, "from its darkest to its lightest tenth"),
    "cast": Measure(color.cast, "ab", 2.0, "color cast"),
    "shadow_cast": Measure(color.cast_between(*color.SHADOWS), "ab", 2.0, "color cast of the shadows"),
    "midtone_cast": Measure(color.cast_between(*color.MIDTONES), "ab", 2.0, "color cast of the midtones"),
    "highlight_cast": Measure(color.cast_between(*color.LIGHTS), "ab", 2.0, "color cast of the lights"),
    "from_right": Measure(color.from_right, "L*", 3.0, "lighter on the right than on the left"),
    "from_above": Measure(color.from_above, "L*", 3.0, "lighter above than below"),
    "veil": Measure(color.veil, "%", 3.0, "light over everything"),
    "haze": Measure(light.haze, "", 0.04, "share of light that the air takes away"),
    "mist_below": Measure(light.mist_below, "", 0.04, "how much more the air hides below than above"),
    "air_lightness": Measure(light.air_lightness, "L*", 2.0, "lightness of the air"),
}
"""By name, as `quantities.toml` and the wishes of the vocabulary call them."""
