# SPDX-License-Identifier: Apache-2.0
"""Claims of several words beside each other: which ones give way, and where light can be measured beside what is painted."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

from ..color.floats import chroma, lab_from_srgb
from ..color.shades import WARM, warm
from ..prompt.types import Attribute
from ..schema import Values
from .claim import Claim
from .colored import COLORED, as_accent

USUAL = ("atmosphere", "setting")
"""Slots of words that say only what is usual of other measures than their own: the later, the less."""

_OPPOSED = 0.5
"""Cosine between a tint and the other direction, from where a picture cannot have both."""

_LIT, _STILL = 44.0, 0.7
"""L* of a picture in colored light at least, and the share of the color's own lightness that is enough for dark colors."""

_MUTED = 0.7
"""Share of a named color's chroma that a picture keeps in which colors are muted."""

_FIXED = ("warmth", "tint", "accent", "chroma")
"""Measures of what lies around that a color word for it fixes."""


_SIDES = {"light_right", "light_up", "light_front"}
"""Measures of where light comes from."""


def parted(said: list[tuple[Attribute, tuple[Claim, ...]]]) -> list[tuple[Attribute, tuple[Claim, ...]]]:
    """Words with what they claim; colors of light that no picture can have all over, magenta and cyan, have a part of it each."""
    tints = [c for a, row in said if a.color for c in row if (c.part, c.measure) == ("picture", "tint")]
    apart = [c for c in tints if any(_against(c, other.direction) for other in tints)]
    words = {c.word for c in apart}
    rest = [(a, [c for c in row if c.measure != "off_hue" or c.word not in words]) for a, row in said]
    return [(a, tuple(as_accent(c) if c in apart else c for c in row)) for a, row in rest]


def adds(claim: Claim, attribute: Attribute, first: Claim) -> bool:
    """Whether a claim says anything beside one that goes first.

    Of one measure of one thing, what is said and goes further in the same sense: an old detective movie is as gray as the
    movie, not as the old one. What is usual of a place gives way, and so does, around the subject, what a mood stands for to
    what is said of the picture: a toy shop is no gray shop. Of several colors of a thing the first counts. Where light comes
    from is for the word that says it: a haunted house is lit from below, but not where light is to come from the right.

    Args:
        claim: Of a later word.
        attribute: The word.
        first: Of an earlier one.
    """
    usual = attribute.slot in USUAL
    low, high = max(claim.lower[0], first.lower[0]), min(claim.upper[0], first.upper[0])
    if attribute.cause and first.word != claim.word and {claim.measure, first.measure} <= _SIDES:
        return False
    if _measured(claim) != _measured(first):
        around = (claim.measure, claim.part, first.part) == (first.measure, "surroundings", "picture")
        return not ((usual or attribute.cause) and around and low > high)
    if first.color or claim.word == first.word or usual:
        return False
    return low <= high and (low, high) != (first.lower[0], first.upper[0])


def _measured(claim: Claim) -> tuple[object, ...]:
    """What a claim is measured on: of colors the hue is what is claimed."""
    hue = () if claim.measure == "color" else claim.direction
    return claim.measure, claim.part, claim.materials, hue


def beside_painted(claim: Claim, attribute: Attribute, colors: Sequence[Claim]) -> Claim:
    """A claim about the whole picture as far as the colors leave it that words name for what fills it.

    Muted colors are still colors, and a gallery with a dark backdrop is no light picture, though galleries are.

    Args:
        claim: Of a word.
        attribute: The word.
        colors: Claims of color words.
    """
    named = [lab_from_srgb(c.color) for c in colors if c.measure == "color" and c.color and not c.materials]
    if claim.part != "picture" or not named:
        return claim
    if claim.measure == "chroma":
        kept = _MUTED * max(math.hypot(a, b) for _, a, b in named)
        return replace(claim, upper=(max(claim.upper[0], kept),))
    if claim.measure == "lightness" and attribute.slot in USUAL:
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
        claims: All of them.
    """
    tints = [c.color for c in colors if (c.part, c.measure) == ("picture", "tint") and c.color]
    if not tints or any(map(is_brightness, claims)):
        return []
    least = min(_STILL * min(lab_from_srgb(color)[0] for color in tints), _LIT)
    return [Claim.unsaid("picture", "lightness", lower=least)]


def gives_way(claim: Claim, colors: Sequence[Claim], casts: Sequence[Claim]) -> bool:
    """Whether what colors claim that the prompt names rules out what a word usually is like.

    A forest before a purple background is not green, a morning of pale blue light not warm, a gallery at sunset not gray, and
    fresh asphalt no more colored for being fresh.

    Args:
        claim: Of any word.
        colors: Claims of color words, and how light gray materials are.
        casts: Claims that light is warm, cool or of a color.
    """
    if claim in colors:
        return False
    if claim.materials and claim.measure == "chroma" and claim.lower[0] > 0.0:
        return any(_is_gray(c) and not {*c.materials}.isdisjoint(claim.materials) for c in colors)
    if claim.part == "picture" and claim.measure in ("warmth", "tint"):
        tints = [c for c in colors if (c.part, c.measure) == ("picture", "tint")]
        return any(_against(claim, c.direction) for c in tints)
    if claim.part in ("surroundings", "sky") and claim.measure in _FIXED and not claim.materials:
        gray = (claim.part, claim.measure) == ("surroundings", "chroma")
        if gray and any(c.part == "picture" and c.word != claim.word for c in casts):
            return True
        same = [c for c in colors if c.part == claim.part and not c.materials]
        return any(c.measure == "color" or _against(claim, c.direction) for c in same)
    return False


def _is_gray(claim: Claim) -> bool:
    return claim.color is not None and chroma(lab_from_srgb(claim.color)) < COLORED


def _against(claim: Claim, direction: Values) -> bool:
    """Whether a color lies on the other side of what a claim about warmth or a tint asks for."""
    if not direction:
        return False
    if claim.direction:
        return sum(a * b for a, b in zip(claim.direction, direction, strict=True)) < -_OPPOSED
    return asks(claim) * warm(*direction) < -_OPPOSED


def asks(claim: Claim) -> int:
    """Whether a claim asks for warmth (1), for coolness (-1), or for neither."""
    if claim.measure != "warmth":
        return 0
    return 1 if claim.lower[0] > 0.0 else -1 if claim.upper[0] < 0.0 else 0


def cast_of(claim: Claim) -> Values:
    """The direction in a and b in which a claim wants the light of the whole picture to be colored; () for other claims."""
    if not is_light(claim) or claim.measure in ("accent", "off_hue"):
        return ()
    return claim.direction or tuple(asks(claim) * part / math.hypot(*WARM) for part in WARM if asks(claim))


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
