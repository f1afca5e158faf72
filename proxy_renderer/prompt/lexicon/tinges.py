# SPDX-License-Identifier: Apache-2.0
"""Colors between colors: "greenish", "gray-blue", "reddish brown", "khaki green"."""

from __future__ import annotations

import math
import re

from ...color.floats import oklab_from_srgb
from ...color.shades import mix, shade
from ...schema import Values
from .attributes import COLORS

_CHROMA, _TINGE = 0.7, 0.4  # of "greenish", and its share in "greenish yellow"
_HALF, _KIN = 0.5, 75.0  # share of khaki in "khaki green"; how far apart their hues may be, degrees
_FAINT = 0.03  # OKLab chroma of what has no hue
_PAIR = re.compile(r"\b([A-Za-z]+)-([A-Za-z]+)\b")
_BASIC = frozenset([*COLORS, "gray"])
_KINDS = _BASIC - {"white", "black"}
"""Colors that have kinds: "navy white" is two colors."""


def tending(word: str, colors: dict[str, Values]) -> Values | None:
    """The color that "greenish" and "lemony" tend to; None for other words."""
    if word.removesuffix("y") != word and word[:-1] in colors:
        return colors[word[:-1]]
    base = word.removesuffix("ish")
    stems = (base, base[:-1], base + "e") if base != word else ()
    color = next((colors[s] for s in stems if s in colors), None)
    return shade(color, chroma=_CHROMA) if color else None


def tinged(words: list[str], colors: dict[str, Values]) -> Values | None:
    """A color with another's tinge: "greenish yellow"; None where that is a color of the list, or none at all."""
    if len(words) != 2 or " ".join(words) in colors or words[1] not in colors:
        return None
    tinge = tending(words[0], colors)
    return mix(colors[words[1]], tinge, _TINGE) if tinge else None


def kind_of(words: list[str], colors: dict[str, Values]) -> Values | None:
    """A kind of a basic color: "khaki green"; None where the list has it, and for what are two colors: "teal orange"."""
    if len(words) != 2 or " ".join(words) in colors:
        return None
    kind = colors.get(words[0]) if words[0] not in _BASIC and words[1] in _KINDS else None
    return mix(colors[words[1]], kind, _HALF) if kind and _are_kin(colors[words[1]], kind) else None


def _are_kin(a: Values, b: Values) -> bool:
    """Whether two sRGB colors have neighboring hues, or one of them none."""
    (_, a1, b1), (_, a2, b2) = oklab_from_srgb(a), oklab_from_srgb(b)
    if min(math.hypot(a1, b1), math.hypot(a2, b2)) < _FAINT:
        return True
    turn = math.degrees(math.atan2(b1, a1) - math.atan2(b2, a2)) % 360
    return min(turn, 360 - turn) < _KIN


def spelled_out(prompt: str, colors: dict[str, Values]) -> str:
    """ "Gray-blue" as "grayish blue"; what the color list has stays as it is."""

    def said(pair: re.Match[str]) -> str:
        first, second = pair[1].lower(), pair[2].lower()
        both = first in _BASIC and second in _BASIC and f"{first} {second}" not in colors
        return f"{first}ish {second}" if both else pair[0]

    return _PAIR.sub(said, prompt)
