# SPDX-License-Identifier: Apache-2.0
"""From wishes to claims: what the picture has to look like."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import cast

from ..color.floats import chroma, lab_from_srgb, srgb_from_hex
from ..goals.resolve import Goals
from ..goals.wish import Wish
from ..prompt.lexicon.claim_text import ClaimText
from ..prompt.lexicon.vocabulary import Vocabulary
from ..prompt.types import Attribute
from .beside import (
    beside_painted,
    cast_of,
    is_brightness,
    is_light,
    is_painted,
    lit,
    narrows,
    on_things,
    parted,
    still_light,
)
from .claim import Claim
from .colored import in_colored_light, in_the_dark, of_color, part_of
from .comparing import compares
from .matter import of_matter
from .measures.picture import Part

_OF_MOODS = 0.5
"""Weight of what a mood stands for."""

_SLIGHT, _LESS = 0.8, 2.0
"""Strength below which a word is a weak one, and by how many of its changes a claim would ask for less at strength 0."""

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
    lower, upper = text.lower, text.upper
    if attribute.cause or attribute.strength < _SLIGHT:
        lower, upper = _milder(text, min(attribute.strength, 1.0))
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


def _milder(text: ClaimText, strength: float) -> tuple[float, float]:
    """The ends of an interval of a word that asks for less: the near end is met sooner, and the far end, where there is too much, too."""
    if text.change is None:
        return text.lower, text.upper
    less, middle = (1.0 - strength) * _LESS * text.change, (text.lower + text.upper) / 2
    rises, far = text.change > 0, math.isfinite(middle)
    if rises:
        return text.lower - less, middle if far else text.upper
    return middle if far else text.lower, text.upper - less
