# SPDX-License-Identifier: Apache-2.0
"""Colors between colors: "greenish", "gray-blue", "reddish brown"."""

from __future__ import annotations

import re

from ...color.shades import mix, shade
from ...schema import Values
from .attributes import COLORS

_CHROMA, _TINGE = 0.7, 0.4  # of "greenish", and its share in "greenish yellow"
_PAIR = re.compile(r"\b([A-Za-z]+)-([A-Za-z]+)\b")
_BASIC = frozenset([*COLORS, "gray"])


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


def spelled_out(prompt: str, colors: dict[str, Values]) -> str:
    """ "Gray-blue" as "grayish blue"; what the color list has stays as it is."""

    def said(pair: re.Match[str]) -> str:
        first, second = pair[1].lower(), pair[2].lower()
        both = first in _BASIC and second in _BASIC and f"{first} {second}" not in colors
        return f"{first}ish {second}" if both else pair[0]

    return _PAIR.sub(said, prompt)
