# SPDX-License-Identifier: Apache-2.0
"""What "vivid colors" need where nothing has a color: saturation times gray is gray."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from ..color.floats import chroma, lab_from_srgb, linear_from_srgb, srgb_from_lab, srgb_from_linear
from ..prompt.types import Parsed
from ..schema import Instance, Values
from .ranges import clip
from .sources import Range

_GRAY, _HUELESS = (
    15.0,
    3.0,
)  # C* of a base color up to which it is gray, and up to which it has no hue of its own
_CHROMA, _OWN, _LIGHTNESS = 52.0, 36.0, (48.0, 68.0)  # C* and L* that surfaces get; C* of a hue of their own
_HUES = 45.0, 137.5
"""Degrees of the first hue, orange, and from one to the next: the golden angle keeps them apart."""
_WITHIN = (0.75, 1.25)  # multiples of a color between which it is sought


def wants_color(parsed: Parsed, instances: dict[str, Instance], keys: Sequence[str]) -> bool:
    """Whether words ask for vivid colors, and no surface has one.

    Args:
        parsed: The prompt.
        instances: The scene's parameters.
        keys: Of the base colors that no word names.
    """
    vivid = parsed.targets.get("saturation") == "vivid"
    return vivid and not parsed.colors and all(_is_gray(instances[key].value) for key in keys)


def colored(instances: dict[str, Instance], keys: Sequence[str]) -> Iterator[tuple[str, Range]]:
    """Ranges of base colors around the hues that they have, or else around hues that are told apart.

    Args:
        instances: The scene's parameters.
        keys: Of the base colors, the most important one first.
    """
    first, step = _HUES
    for number, key in enumerate(keys):
        own, a, b = lab_from_srgb(srgb_from_linear(instances[key].value))
        hueless = math.hypot(a, b) <= _HUELESS
        hue = math.radians(first + number * step) if hueless else math.atan2(b, a)
        light, strength = min(max(own, _LIGHTNESS[0]), _LIGHTNESS[1]), _CHROMA if hueless else _OWN
        color = linear_from_srgb(srgb_from_lab((light, strength * math.cos(hue), strength * math.sin(hue))))
        low, high = (tuple(v * share for v in color) for share in _WITHIN)
        yield key, clip(low, high, instances[key])


def _is_gray(color: Values) -> bool:
    return chroma(lab_from_srgb(srgb_from_linear(color))) <= _GRAY
