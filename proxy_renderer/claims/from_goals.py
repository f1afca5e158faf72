# SPDX-License-Identifier: Apache-2.0
"""From goals to claims about the image."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import cast

from ..color.floats import chroma, lab_from_srgb, srgb_from_hex
from ..color.shades import WARM
from ..goals.resolve import Goals
from ..goals.wish import Wish
from ..prompt.lexicon.claim_text import ClaimText, warmth_asked
from ..prompt.lexicon.vocabulary import Vocabulary
from ..prompt.types import Attribute
from ..schema import Values
from .claim import Claim
from .colors import as_accent, in_colored_light, in_the_dark, of_color, of_matter, part_of
from .measures.picture import Part

_OF_MOODS = 0.5
"""Weight of what a mood stands for."""

_SLIGHT = 0.8
"""Strength below which a word is a weak one."""

_BURNT = 0.06
"""Share of a thing, or of the picture, that may burn out."""

_WHITE, _BRIGHT = 90.0, 60.0
"""L* of a color from where it is white, and of a picture that words ask for from where parts of it may burn out."""

_DROWNED = 0.12
"""Share of the picture that may drown in black, where no word asks for a dark one or a black thing."""

_OF_DARKNESS, _DARK, _BLACK = ("lightness", "black_point"), 50.0, 22.0
"""Measures of how dark something is, what words for dark ask for at most, and L* of a color up to which it is black."""

_SHAPED, _FLAT = 14.0, 8.0
"""From the darkest to the lightest tenth of a subject, L*, at least: light from everywhere shows no shape. The latter where words ask for
dark or for little contrast."""

_DIMMEST = 24.0
"""L* of the lightest parts of a subject in the dark, at least."""


def claims_of(goals: Goals, vocabulary: Vocabulary) -> tuple[Claim, ...]:
    """The claims of goals, and what holds of every picture: that its subject can be seen.

    Args:
        goals: What the words wish for, resolved.
    """
    attributes = goals.parsed.attributes
    ranked = sorted(goals.wishes, key=lambda wish: wish.rank)
    said = parted([(wish, tuple(_of_wish(wish, goals, vocabulary))) for wish in ranked])
    said_colors = [claim for wish, row in said if wish.attribute.color and not wish.implied for claim in row]
    claims: list[Claim] = []
    for wish, row in said:
        compared, usual = compares(wish.attribute, attributes, vocabulary), wish.usual > 0
        for claim in row:
            claim = replace(beside_painted(claim, usual, said_colors), compares=compared)
            if all(narrows(claim, usual, first) for first in claims):
                claims.append(claim)
    darkest = min((c.upper[0] for c in claims if is_brightness(c)), default=math.inf)
    claims += still_light(said_colors, claims)
    painted = [c for wish, row in said for c in row if is_painted(c, wish.attribute)]
    colored = [c for c in claims if c.measure == "color"] + painted
    tints = [cast for c in claims if (cast := cast_of(c))]
    shown = (
        lit(c, colored) if is_light(c) else in_colored_light(in_the_dark(c, darkest), tints) for c in claims
    )
    return (
        *map(on_things, shown),
        *_of_every_picture(goals),
        *_unburnt(claims),
        *_undrowned(goals, claims),
    )


def _of_wish(wish: Wish, goals: Goals, vocabulary: Vocabulary) -> Iterator[Claim]:
    attribute = wish.attribute
    if attribute.color:
        weight = _OF_MOODS if wish.implied else 1.0
        claims = of_color(attribute, attribute.color)
        yield from (replace(claim, word=wish.word, weight=weight) for claim in claims)
        return
    yield from (_bound(text, attribute) for text in wish.claims)
    if wish.quantity == "color" and not attribute.negated:
        yield from of_matter(attribute, goals.parsed.attributes, vocabulary)


def _of_every_picture(goals: Goals) -> Iterator[Claim]:
    """That the subject stands out from what is around it, and neither burns out nor drowns, or no more than before."""
    silhouette = any(a.entry == "silhouette" and not a.negated for a in goals.parsed.attributes)
    yield Claim.unsaid("subject", "separation", lower=10.0)
    yield Claim.unsaid("subject", "burnt", upper=_BURNT)
    if silhouette:
        return
    dark = goals.classes.get("brightness") == "dark"
    shaped = _FLAT if dark or goals.classes.get("contrast") == "low" else _SHAPED
    yield Claim.unsaid("subject", "white_point", lower=_DIMMEST)  # even at night its lights are seen
    if goals.classes.get("haze") != "thick":  # which takes the contrast of all that is in it
        yield Claim.unsaid("subject", "spread", lower=shaped)
    if not dark:
        yield Claim.unsaid("subject", "drowned", upper=0.3)


def _unburnt(claims: Sequence[Claim]) -> Iterator[Claim]:
    """That no more of the picture burns out than before, unless words ask for white or for a bright picture."""
    white = any(c.color and lab_from_srgb(c.color)[0] > _WHITE for c in claims)
    if not white and not any(is_brightness(c) and c.lower[0] > _BRIGHT for c in claims):
        yield Claim.unsaid("picture", "burnt", upper=_BURNT)


def _undrowned(goals: Goals, claims: Sequence[Claim]) -> Iterator[Claim]:
    """That no more of the picture drowns in black than before, unless words ask for dark, or for something that is."""
    black = any(c.color and lab_from_srgb(c.color)[0] < _BLACK for c in claims)
    dark = any(
        (c.measure in _OF_DARKNESS and c.upper[0] < _DARK) or c.measure == "silhouette" for c in claims
    )
    if not black and not dark and goals.classes.get("brightness") != "dark":
        yield Claim.unsaid("picture", "drowned", upper=_DROWNED)


def _bound(text: ClaimText, attribute: Attribute) -> Claim:
    """A claim about what a word describes; a strong word asks for more of a change, a weak one for less.

    What a mood stands for counts less than what is said, and too much of it comes sooner: a summery picture is not all orange.
    """
    own = text.part == "thing"
    part = part_of(attribute) if own else cast(Part, text.part)
    lower, upper = (
        _milder(text) if attribute.cause or attribute.strength < _SLIGHT else (text.lower, text.upper)
    )
    named = lab_from_srgb(srgb_from_hex(text.color)) if text.color else (0.0, 0.0, 0.0)
    return Claim(
        word=attribute.cause or attribute.word,
        thing=(attribute.thing or part) if own else part,
        measure=text.measure,
        part=part,
        lower=(lower,),
        upper=(upper,),
        materials=attribute.owners if own else (),
        change=None if text.change is None else text.change * attribute.strength,
        direction=tuple(v / chroma(named) for v in named[1:]) if text.color else (),
        color=srgb_from_hex(text.color) if text.color else None,
        weight=_OF_MOODS if attribute.cause else 1.0,
        near=text.near,
    )


def _milder(text: ClaimText) -> tuple[float, float]:
    """The ends of an interval whose far end, where there is too much, is nearer; others stay."""
    middle = (text.lower + text.upper) / 2
    if text.change is None or not math.isfinite(middle):
        return text.lower, text.upper
    return (text.lower, middle) if text.change > 0 else (middle, text.upper)


_OPPOSED = 0.5
"""Cosine between a tint and the other direction, from where a picture cannot have both."""

_LIT_LIGHTNESS, _STILL = 44.0, 0.7
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
    least = min(_STILL * min(lab_from_srgb(color)[0] for color in tints), _LIT_LIGHTNESS)
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


def compares(attribute: Attribute, all_of_them: Sequence[Attribute], vocabulary: Vocabulary) -> bool:
    """Whether an attribute, or the mood that it comes from, is said by a word that compares.

    Args:
        vocabulary: Knows what "colder" is made of.
    """
    if not attribute.cause:
        return any(_is_comparative(word, vocabulary) for word in _english(attribute).split())
    moods = [a for a in all_of_them if not a.cause and attribute.cause == a.word]
    return any(compares(mood, (), vocabulary) for mood in moods)


def _english(attribute: Attribute) -> str:
    return attribute.english or attribute.word


def _is_comparative(word: str, vocabulary: Vocabulary) -> bool:
    known = vocabulary.adjectives.keys() | vocabulary.synonyms.keys()
    return word in vocabulary.lists["degree"] or not known.isdisjoint(vocabulary.stems(word, "comparative"))
