# SPDX-License-Identifier: Apache-2.0
"""From goals to claims about the image: those of single wishes, how they limit each other, and those of every image."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import cast

from ..color.floats import chroma, lab_from_srgb, srgb_from_hex
from ..color.shades import WARM
from ..goals.resolve import Goals
from ..goals.wish import Wish
from ..schema import Values
from ..words.lexicon.quantities import ClaimText, warmth_asked
from ..words.lexicon.vocabulary import Vocabulary
from ..words.types import Attribute
from .claim import Claim
from .colors import as_accent, darkened, in_colored_light, of_color, of_material, part_of
from .measures.picture import Part

_OF_MOODS = 0.5  # weight of what a mood stands for
_SLIGHT = 0.8  # strength below which a word is a weak one
_LESS = 2.0  # by how many of its changes a claim would ask for less at strength 0
_OPPOSED = 0.5  # cosine between a tint and the other direction, from where an image cannot have both
_MUTED = 0.7  # share of a named color's chroma that an image keeps in which colors are muted
# least L* of an image in colored light; share of the color's own lightness that is enough
_LIT, _LIT_SHARE = (44.0, 0.7)

# Of every image
_BURNT, _SUBJECT_DROWNED, _DROWNED = 0.06, 0.3, 0.12  # shares that may be overexposed, or drown in black
_WHITE, _BRIGHT = 90.0, 60.0  # L* of a color that is white, and of an image of which parts may be overexposed
_BLACK, _DARK = 22.0, 50.0  # L* of a color that is black, and the most that words for dark ask for
_APART = 10.0  # Lab distance between the subject and its ground
# least L* between a subject's tenths, for light from everywhere shows no shape; the same if words ask for flat
_SHAPED, _FLAT = (14.0, 8.0)
_DIMMEST = 24.0  # least L* of the lightest parts of a subject: even at night its lights are seen

_TINTS = ("tint", "accent")


def claims_of(goals: Goals, vocabulary: Vocabulary) -> tuple[Claim, ...]:
    """The claims of goals, and those of every image: that its subject can be seen."""
    ranked = sorted(goals.wishes, key=lambda wish: wish.rank)
    rows = _with_accents([(wish, [*_of_wish(wish, goals, vocabulary)]) for wish in ranked])
    colors = [c for wish, row in rows if wish.attribute.color and not wish.implied for c in row]

    # Each word adds what those of higher rank do not claim already.
    claims: list[Claim] = []
    for wish, row in rows:
        compared = _compares(wish.attribute, goals.parsed.attributes, vocabulary)
        for claim in row:
            claim = replace(_allowing_colors(claim, wish.usual > 0, colors), compares=compared)
            if all(_narrows(claim, wish.usual > 0, first) for first in claims):
                claims.append(claim)
    claims += _least_lightness(colors, claims)

    # Objects are measured as they look in the light that is asked for, and light on what has no color of its own.
    darkest = min((c.upper[0] for c in claims if _is_brightness(c)), default=math.inf)
    casts = [direction for c in claims if (direction := _cast_direction(c))]
    colored = [c for c in claims if c.measure == "color"]
    colored += [c for wish, row in rows for c in row if _is_painted(c, wish.attribute)]
    shown = []
    for claim in claims:
        if _is_light(claim):
            claim = _without_colored(claim, colored)
        else:
            claim = in_colored_light(darkened(claim, darkest), casts)
        if (claim.part, claim.measure) == ("picture", "chroma") and claim.lower[0] > 0.0:
            # vivid objects: a gray world behind them has no color, and lights them
            claim = replace(claim, apart=(("sky", ()),))
        shown.append(claim)
    return (*shown, *_of_every_image(goals, claims))


def _of_wish(wish: Wish, goals: Goals, vocabulary: Vocabulary) -> Iterator[Claim]:
    attribute = wish.attribute
    if attribute.color:
        weight = _OF_MOODS if wish.implied else 1.0
        for claim in of_color(attribute, attribute.color):
            yield replace(claim, word=wish.word, weight=weight)
        return
    for text in wish.claims:
        yield _of_text(text, attribute)
    if wish.quantity == "color" and not attribute.negated:
        yield from of_material(attribute, goals.parsed.attributes, vocabulary)


def _of_text(text: ClaimText, attribute: Attribute) -> Claim:
    """A lexicon's claim about what a word describes; a strong word asks for more of a change, a weak one for less.

    What a mood stands for counts less than a named look, and is too much sooner: a summery image is not all orange.
    """
    own = text.part == "thing"
    part = part_of(attribute) if own else cast(Part, text.part)
    mild = attribute.cause or attribute.strength < _SLIGHT
    lower, upper = _milder(text, min(attribute.strength, 1.0)) if mild else (text.lower, text.upper)
    color = srgb_from_hex(text.color) if text.color else None
    named = lab_from_srgb(color) if color else (0.0, 0.0, 0.0)
    return Claim(
        word=attribute.cause or attribute.word,
        thing=(attribute.thing or part) if own else part,
        measure=text.measure,
        part=part,
        lower=(lower,),
        upper=(upper,),
        materials=attribute.owners if own else (),
        change=None if text.change is None else text.change * attribute.strength,
        direction=tuple(v / chroma(named) for v in named[1:]) if color else (),
        color=color,
        weight=_OF_MOODS if attribute.cause else 1.0,
        near=text.near,
    )


def _milder(text: ClaimText, strength: float) -> tuple[float, float]:
    """The ends of an interval of a weak word: the near one is met sooner, and so is the far one, where there is too much."""
    if text.change is None:
        return text.lower, text.upper
    less, middle = (1.0 - strength) * _LESS * text.change, (text.lower + text.upper) / 2
    if text.change > 0:
        return text.lower - less, middle if math.isfinite(middle) else text.upper
    return middle if math.isfinite(middle) else text.lower, text.upper - less


def _compares(attribute: Attribute, attributes: Sequence[Attribute], vocabulary: Vocabulary) -> bool:
    """True if an attribute, or the mood that it comes from, has a comparative word, as "colder"."""
    if attribute.cause:
        moods = [a for a in attributes if not a.cause and attribute.cause == a.word]
        return any(_compares(mood, (), vocabulary) for mood in moods)
    known = vocabulary.adjectives.keys() | vocabulary.synonyms.keys()
    return any(
        word in vocabulary.lists["degree"] or not known.isdisjoint(vocabulary.stems(word, "comparative"))
        for word in (attribute.english or attribute.word).split()
    )


def _with_accents(rows: list[tuple[Wish, list[Claim]]]) -> list[tuple[Wish, list[Claim]]]:
    """Wishes with their claims; colors of light that no image can have all over, magenta and cyan, have a part of it each."""
    tints = [
        c for w, row in rows if w.attribute.color for c in row if (c.part, c.measure) == ("picture", "tint")
    ]
    opposed = [c for c in tints if any(_cosine(c, other) < -_OPPOSED for other in tints)]
    words = {c.word for c in opposed}
    return [
        (
            wish,
            [
                as_accent(c) if c in opposed else c
                for c in row
                if c.measure != "off_hue" or c.word not in words
            ],
        )
        for wish, row in rows
    ]


def _cosine(first: Claim, second: Claim) -> float:
    return sum(a * b for a, b in zip(first.direction, second.direction, strict=True))


def _allowing_colors(claim: Claim, usual: bool, colors: Sequence[Claim]) -> Claim:
    """A claim about the whole image, eased for the named colors of what fills it.

    Muted colors are still colors, and a gallery with a dark backdrop is no light image, though galleries are.

    Args:
        usual: Whether the word says only what is usual of a place or a weather.
        colors: Claims of color words.
    """
    named = [lab_from_srgb(c.color) for c in colors if c.measure == "color" and c.color and not c.materials]
    if claim.part != "picture" or not named:
        return claim
    if claim.measure == "chroma":
        kept = _MUTED * max(map(chroma, named))
        return replace(claim, upper=(max(claim.upper[0], kept),))
    if claim.measure == "lightness" and usual:
        light = [lab[0] for lab in named]
        return replace(claim, lower=(min(claim.lower[0], *light),), upper=(max(claim.upper[0], *light),))
    return claim


def _narrows(claim: Claim, usual: bool, first: Claim) -> bool:
    """True if a claim adds anything to one of higher rank.

    Of one measure of one part, a claim that goes further in the same sense does: an old detective movie is as gray as the
    movie, not as the old one. Of several colors of a part the first counts.

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
    """Measure and region of a claim; of colors the hue is what is claimed."""
    return claim.measure, claim.part, claim.materials, () if claim.measure == "color" else claim.direction


def _least_lightness(colors: Sequence[Claim], claims: Sequence[Claim]) -> list[Claim]:
    """Colored light is no dark light: where no word says how light the image is, it stays as light as the color is.

    A tint could be had by exposing less, where it would drown the other colors.
    """
    tints = [c.color for c in colors if (c.part, c.measure) == ("picture", "tint") and c.color]
    if not tints or any(map(_is_brightness, claims)):
        return []
    least = min(_LIT_SHARE * min(lab_from_srgb(color)[0] for color in tints), _LIT)
    return [Claim.unsaid("picture", "lightness", lower=least)]


def _without_colored(claim: Claim, colored: Sequence[Claim]) -> Claim:
    """A claim about light, measured on parts that get no color of their own by other words."""
    apart = (
        (c.part, c.materials)
        for c in colored
        if c.measure == "color" or c.part == "sky" or c.word != claim.word
    )
    return replace(claim, apart=tuple(dict.fromkeys(apart)))


def _cast_direction(claim: Claim) -> Values:
    """The direction in a and b in which a claim wants the light of the whole image to be colored; () for other claims."""
    if not _is_light(claim) or claim.measure in ("accent", "off_hue"):
        return ()
    side = warmth_asked(claim.measure, claim.lower[0], claim.upper[0])
    return claim.direction or tuple(side * part / math.hypot(*WARM) for part in WARM if side)


def _is_painted(claim: Claim, attribute: Attribute) -> bool:
    """True for the color of a place or a sky, not of the light there: sand is yellow at noon, and a sunset's sky orange."""
    if claim.part == "sky":
        return claim.measure in (*_TINTS, "warmth")
    return attribute.slot == "setting" and claim.part == "surroundings" and claim.measure in _TINTS


def _is_light(claim: Claim) -> bool:
    """True for claims about the color of light, which objects that have a color of their own hide."""
    return claim.part == "picture" and claim.measure in (*_TINTS, "warmth", "off_hue")


def _is_brightness(claim: Claim) -> bool:
    return claim.part == "picture" and claim.measure == "lightness"


def _of_every_image(goals: Goals, claims: Sequence[Claim]) -> Iterator[Claim]:
    """The subject stands out from its ground, and neither it nor the image is overexposed or drowns, or no more than before."""
    dark = goals.classes.get("brightness") == "dark"
    lightness = [lab_from_srgb(c.color)[0] for c in claims if c.color]
    yield Claim.unsaid("subject", "separation", lower=_APART)
    yield Claim.unsaid("subject", "burnt", upper=_BURNT)
    if not any(a.entry == "silhouette" and not a.negated for a in goals.parsed.attributes):
        yield Claim.unsaid("subject", "white_point", lower=_DIMMEST)
        if goals.classes.get("haze") != "thick":  # which takes the contrast of all that is in it
            flat = dark or goals.classes.get("contrast") == "low"
            yield Claim.unsaid("subject", "spread", lower=_FLAT if flat else _SHAPED)
        if not dark:
            yield Claim.unsaid("subject", "drowned", upper=_SUBJECT_DROWNED)

    # Words that ask for white or a bright image, or for black or a dark one, get it.
    bright = any(_is_brightness(c) and c.lower[0] > _BRIGHT for c in claims)
    if not bright and not any(light > _WHITE for light in lightness):
        yield Claim.unsaid("picture", "burnt", upper=_BURNT)
    dark |= any(
        (c.measure in ("lightness", "black_point") and c.upper[0] < _DARK) or c.measure == "silhouette"
        for c in claims
    )
    if not dark and not any(light < _BLACK for light in lightness):
        yield Claim.unsaid("picture", "drowned", upper=_DROWNED)
