# SPDX-License-Identifier: Apache-2.0
"""Claims of several words beside each other: what is measured where, and how far, when other words color the image too."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

from ..color.floats import lab_from_srgb
from ..color.shades import WARM
from ..goals.wish import Wish
from ..prompt.lexicon.claim_text import warmth_asked
from ..prompt.types import Attribute
from ..schema import Values
from .claim import Claim
from .colors import as_accent

_OPPOSED = 0.5
"""Cosine between a tint and the other direction, from where a picture cannot have both."""

_LIT, _STILL = 44.0, 0.7
"""L* of a picture in colored light at least, and the share of the color's own lightness that is enough for dark colors."""

_MUTED = 0.7
"""Share of a named color's chroma that a picture keeps in which colors are muted."""


def parted(said: list[tuple[Wish, tuple[Claim, ...]]]) -> list[tuple[Wish, tuple[Claim, ...]]]:
    """Wishes with what they claim; colors of light that no picture can have all over, magenta and cyan, have a part of it each."""
    tints = [
        c for w, row in said if w.attribute.color for c in row if (c.part, c.measure) == ("picture", "tint")
    ]
    apart = [c for c in tints if any(_against(c, other.direction) for other in tints)]
    words = {c.word for c in apart}
    rest = [(w, [c for c in row if c.measure != "off_hue" or c.word not in words]) for w, row in said]
    return [(w, tuple(as_accent(c) if c in apart else c for c in row)) for w, row in rest]


def narrows(claim: Claim, usual: bool, first: Claim) -> bool:
    """Whether a claim says anything beside one that goes first.

    Of one measure of one thing, what is said and goes further in the same sense: an old detective movie is as gray as the
    movie, not as the old one. Of several colors of a thing the first counts.

    Args:
        usual: Whether the word says only what is usual.
    """
    if _measured(claim) != _measured(first):
        return True
    if first.color or claim.word == first.word or usual:
        return False
    low, high = max(claim.lower[0], first.lower[0]), min(claim.upper[0], first.upper[0])
    return low <= high and (low, high) != (first.lower[0], first.upper[0])


def _measured(claim: Claim) -> tuple[object, ...]:
    """What a claim is measured on: of colors the hue is what is claimed."""
    hue = () if claim.measure == "color" else claim.direction
    return claim.measure, claim.part, claim.materials, hue


def beside_painted(claim: Claim, usual: bool, colors: Sequence[Claim]) -> Claim:
    """A claim about the whole picture as far as the colors leave it that words name for what fills it.

    Muted colors are still colors, and a gallery with a dark backdrop is no light picture, though galleries are.

    Args:
        usual: Whether the word says only what is usual of a place or a weather.
        colors: Claims of color words.
    """
    named = [lab_from_srgb(c.color) for c in colors if c.measure == "color" and c.color and not c.materials]
    if claim.part != "picture" or not named:
        return claim
    if claim.measure == "chroma":
        kept = _MUTED * max(math.hypot(a, b) for _, a, b in named)
        return replace(claim, upper=(max(claim.upper[0], kept),))
    if claim.measure == "lightness" and usual:
        light = [lab[0] for lab in named]
        return replace(claim, lower=(min(claim.lower[0], *light),), upper=(max(claim.upper[0], *light),))
    return claim


def lit(claim: Claim, colored: Sequence[Claim]) -> Claim:
    """A claim about light, measured on what has no color of its own by other words."""
    apart = (
        (c.part, c.materials)
        for c in colored
        if c.measure == "color" or c.part == "sky" or c.word != claim.word
    )
    return replace(claim, apart=tuple(dict.fromkeys(apart)))


def on_things(claim: Claim) -> Claim:
    """A claim of vivid colors, measured on things: a gray world that is seen behind them has none, and lights them all."""
    vivid = (claim.part, claim.measure) == ("picture", "chroma") and claim.lower[0] > 0.0
    return replace(claim, apart=(("sky", ()),)) if vivid else claim


def still_light(colors: Sequence[Claim], claims: Iterable[Claim]) -> list[Claim]:
    """That colored light is no dark light: where no word says how light the picture is, it stays as light as the color is.

    A tint could be had by exposing less, where it would drown the other colors.

    Args:
        colors: Claims of color words.
    """
    tints = [c.color for c in colors if (c.part, c.measure) == ("picture", "tint") and c.color]
    if not tints or any(map(is_brightness, claims)):
        return []
    least = min(_STILL * min(lab_from_srgb(color)[0] for color in tints), _LIT)
    return [Claim.unsaid("picture", "lightness", lower=least)]


def _against(claim: Claim, direction: Values) -> bool:
    """Whether two tints lie on opposite sides of gray."""
    return sum(a * b for a, b in zip(claim.direction, direction, strict=True)) < -_OPPOSED


def cast_of(claim: Claim) -> Values:
    """The direction in a and b in which a claim wants the light of the whole picture to be colored; () for other claims."""
    if not is_light(claim) or claim.measure in ("accent", "off_hue"):
        return ()
    side = warmth_asked(claim.measure, claim.lower[0], claim.upper[0])
    return claim.direction or tuple(side * part / math.hypot(*WARM) for part in WARM if side)


def is_painted(claim: Claim, attribute: Attribute) -> bool:
    """Whether a claim is the color of a place or a sky, not of the light there: sand is yellow at noon, and a sunset's sky orange."""
    if claim.part == "sky":
        return claim.measure in ("tint", "accent", "warmth")
    return (
        attribute.slot == "setting" and claim.part == "surroundings" and claim.measure in ("tint", "accent")
    )


def is_light(claim: Claim) -> bool:
    """Whether a claim is about the color of light, which things that have a color of their own hide."""
    return claim.part == "picture" and claim.measure in ("warmth", "tint", "off_hue", "accent")


def is_brightness(claim: Claim) -> bool:
    """Whether a claim is about how light the picture is."""
    return claim.part == "picture" and claim.measure == "lightness"
