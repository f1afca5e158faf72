# SPDX-License-Identifier: Apache-2.0
"""Comparative words such as "colder" in a prompt with a reference image: they are relative to the image's values."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from ..words.lexicon.quantities import ClaimText
from ..words.lexicon.vocabulary import Vocabulary
from ..words.types import Attribute
from .resolve import CASTS, Goals
from .wish import Wish

Axis = tuple[str, str]  # a part of the image, and a measure of it
_WARMER = (0.4, 0.8)  # a* and b* that together raise the warmth by 1, see `claims.measures.color.warmth`
_LIGHTER = {
    "black_point": (0.2,), "lower_quartile": (0.8,), "median": (1.0,), "upper_quartile": (0.8,),
    "white_point": (0.2,), "lightness": (1.0,),
}  # fmt: skip
"""Measure of tone -> L* by which it moves if the lightness moves by 1 L*. Black and white points move less."""
_MOVED: Mapping[str, Mapping[str, tuple[float, ...]]] = {
    "lightness": _LIGHTER,
    "warmth": dict.fromkeys(CASTS, _WARMER),
    "shadow_warmth": {"shadow_cast": _WARMER},
    "highlight_warmth": {"highlight_cast": _WARMER},
    "contrast": {
        "black_point": (-0.5,), "lower_quartile": (-0.25,), "upper_quartile": (0.25,), "white_point": (0.5,),
    },
}  # fmt: skip
"""Measure of a word -> measures of a reference image that follow it, and how far each of their numbers moves when the
word's measure moves by 1. All numbers move together: highlights warmer than shadows stay warmer in a colder image."""
FACTS = (*_MOVED, "chroma", "vignette")
"""Measures whose values in the reference image are stated by claims of weight 0: words are relative to these values."""
_SEEN = 2.5  # factor on a word's sufficient change: so much "colder" is visible next to a reference image
_ENOUGH = 0.8  # share of the full move that satisfies a comparative word


def goals_with_picture(goals: Goals, vocabulary: Vocabulary) -> Goals:
    """Goals in which the claims of words and of a reference image agree; without a reference image the same goals.

    A word may ask for more or less of a measure than the reference image has. Then the image's claims about that
    measure move: to where the word is satisfied or, for a comparative word such as "colder", by a clearly visible
    amount. A comparative word is measured against the reference image. If several words move one measure of one part
    of the image, the first in rank counts.
    """
    facts = (claim for wish in goals.pictured for claim in wish.claims if not claim.weight)
    has = {(fact.part, fact.measure): fact.lower[0] for fact in facts if fact.lower == fact.upper}
    ways: dict[tuple[str, str], float] = {}
    fitted: dict[int, Wish] = {}
    for wish in sorted(goals.wishes, key=lambda each: each.rank) if has else ():
        if wish.of_picture:  # last in rank, so `ways` is complete here
            claims = [_moved(claim, wish.part_of(claim), ways) for claim in wish.claims]
        else:
            compared = compares(wish.attribute, goals.parsed.attributes, vocabulary)
            claims = [_relative(claim, wish, compared, has, ways) for claim in wish.claims]
        fitted[id(wish)] = replace(wish, claims=tuple(claims))
    return replace(goals, wishes=tuple(fitted.get(id(wish), wish) for wish in goals.wishes))


def _relative(
    claim: ClaimText, wish: Wish, compares: bool, has: Mapping[Axis, float], ways: dict[Axis, float]
) -> ClaimText:
    """A word's claim, relative to the reference image's value `has[part, measure]` if `compares`; else the same claim.

    Also sets `ways[part, measure]`: the distance by which the word moves the reference image's value of that measure.
    """
    axis = wish.part_of(claim), claim.measure
    own = None if claim.part == "thing" and wish.attribute.owners else has.get(axis)
    if own is None or not (compares or claim.measure in _MOVED):
        return claim
    asked = wish.asked_of(claim)
    way = min(max(own, asked.lower[0]), asked.upper[0]) - own  # from the image's value to the nearest end
    if asked.change is not None and (compares or not asked.near):
        way = _SEEN * asked.change
    ways.setdefault(axis, way)
    if not (compares and asked.change):
        return claim
    border = (own + _ENOUGH * way,)
    ends = (border, (math.inf,)) if way > 0.0 else ((-math.inf,), border)
    return replace(claim, lower=ends[0], upper=ends[1], change=None)


def compares(attribute: Attribute, attributes: Sequence[Attribute], vocabulary: Vocabulary) -> bool:
    """True if an attribute, or the mood that implies it, contains a comparative word such as "colder"."""
    if attribute.cause:
        moods = [a for a in attributes if not a.cause and attribute.cause == a.word]
        return any(compares(mood, (), vocabulary) for mood in moods)
    known = vocabulary.adjectives.keys() | vocabulary.synonyms.keys() | vocabulary.colors.keys()
    return any(
        word in vocabulary.lists["degree"] or not known.isdisjoint(vocabulary.stems(word, "comparative"))
        for word in (attribute.english or attribute.word).split()
    )


def _moved(claim: ClaimText, part: str, ways: Mapping[Axis, float]) -> ClaimText:
    """A claim of a reference image, moved by `ways`: (part, measure) -> distance that a word moves the image's value."""
    for (place, measure), way in ways.items():
        along = _MOVED.get(measure, {}).get(claim.measure)
        if along and place in ("picture", part) and claim.weight:
            lower, upper = (
                tuple(v + way * share for v, share in zip(end, along, strict=True))
                for end in (claim.lower, claim.upper)
            )
            claim = replace(claim, lower=lower, upper=upper)
    return claim
