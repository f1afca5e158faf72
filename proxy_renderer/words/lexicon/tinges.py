# SPDX-License-Identifier: Apache-2.0
"""Colors between colors: "greenish", "gray-blue", "reddish brown", "khaki green", "bluegreen"."""

from __future__ import annotations

import re

from ...color.mixtures import mixable, tinged
from ...color.shades import shade
from ...schema import Values
from .attributes import COLORS

_ALONE = 0.7  # chroma of what is only "greenish"
_TINGE, _HALF, _KIND = 0.4, 0.5, 2 / 3
"""Share of the first color in "greenish blue", "green blue", "khaki green"."""
_SLASHED = re.compile(r"\b([A-Za-z]+)/([A-Za-z]+)\b")
_BASIC = frozenset([*COLORS, "gray"])
_KINDS = _BASIC - {"white", "black"}
"""Colors that have kinds: "navy white" is two colors."""


def tending(word: str, colors: dict[str, Values]) -> Values | None:
    """The color that "greenish" and "lemony" tend to; None for other words."""
    if word.removesuffix("y") != word and word[:-1] in colors:
        return colors[word[:-1]]
    color = colors.get(_stem(word, colors))
    return shade(color, chroma=_ALONE) if color else None


def compound(words: list[str], colors: dict[str, Values]) -> Values | None:
    """A color that is called by two; None where the list has it, or where it is none, or two: "teal orange"."""
    if len(words) != 2 or " ".join(words) in colors or words[1] not in colors:
        return None
    first, base = words[0], colors[words[1]]
    if first not in colors:
        tinge = colors.get(_stem(first, colors))
        return tinged(base, tinge, _TINGE) if tinge else None
    two = first == words[1] or (first in _BASIC - _KINDS) or words[1] not in _KINDS
    if two or not mixable(base, colors[first]):
        return None
    return tinged(base, colors[first], _HALF if first in _BASIC else _KIND)


def parted(word: str, colors: dict[str, Values], shades: dict[str, dict[str, float]]) -> list[str]:
    """The words of a color's name that is written as one, "bluegreen" and "lightblue"; else the word alone."""
    for second in _BASIC:
        first = word.removesuffix(second)
        if first != word and word not in colors and (first in colors or first in shades):
            return [first, second]
    return [word]


def unslashed(prompt: str, colors: dict[str, Values]) -> str:
    """ "Blue/green" as "blue green", where that is one color."""

    def said(pair: re.Match[str]) -> str:
        words = [pair[1].lower(), pair[2].lower()]
        one = " ".join(words)
        return one if one in colors or compound(words, colors) else pair[0]

    return _SLASHED.sub(said, prompt)


def _stem(word: str, colors: dict[str, Values]) -> str:
    """The color's name in "greenish", "bluey" and "reddy"; "" for other words."""
    for ending in ("ish", "y"):
        base = word.removesuffix(ending)
        found = next((s for s in (base, base[:-1], base + "e") if base != word and s in colors), "")
        if found:
            return found
    return ""
