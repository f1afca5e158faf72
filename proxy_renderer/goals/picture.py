# SPDX-License-Identifier: Apache-2.0
"""A reference image beside words: relative words, as "colder", are relative to it."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from ..words.lexicon.quantities import ClaimText
from ..words.lexicon.vocabulary import Vocabulary
from ..words.types import Attribute
from .contradictions import CASTS
from .resolve import Goals
from .wish import Wish

Axis = tuple[str, str]  # a part of the image, and a measure of it
_WARMER = (0.4, 0.8)  # in a* and b*, one step of warmth, see `claims.measures.color.warmth`
_LIGHTER = {
    "black_point": (0.2,), "lower_quartile": (0.8,), "median": (1.0,), "upper_quartile": (0.8,),
    "white_point": (0.2,), "lightness": (1.0,),
}  # fmt: skip
"""The ends move less: a picture that is lighter has black in it all the same."""
_MOVED: Mapping[str, Mapping[str, tuple[float, ...]]] = {
    "lightness": _LIGHTER,
    "warmth": dict.fromkeys(CASTS, _WARMER),
    "shadow_warmth": {"shadow_cast": _WARMER},
    "highlight_warmth": {"highlight_cast": _WARMER},
    "contrast": {
        "black_point": (-0.5,), "lower_quartile": (-0.25,), "upper_quartile": (0.25,), "white_point": (0.5,),
    },
}  # fmt: skip
"""What words measure -> what a picture measures of the same, and how far each of its numbers moves for one of the word's.
The picture's own pattern stays: lights that are warmer than shadows are so in a colder picture, too."""
FACTS = (*_MOVED, "chroma", "vignette")
"""Measures of which a picture's wishes state what it has (weight 0), for words are relative to them."""
_SEEN = 2.5  # changes that are enough in words alone, from where "colder" is seen beside a picture
_ENOUGH = 0.8  # share of the way from where a word that compares is satisfied


def beside_picture(goals: Goals, vocabulary: Vocabulary) -> Goals:
    """Goals whose words and picture fit each other; without a picture the same goals.

    Where a word asks for more or less of something than the picture has, the picture's claims of the same move along: to where the
    word is satisfied, or, of a word that compares, as "colder" does, by what is clearly seen. Such a word is then measured against
    the picture. Of one measure and part the first word in rank counts.
    """
    facts = (claim for wish in goals.pictured for claim in wish.claims if not claim.weight)
    has = {(fact.part, fact.measure): fact.lower[0] for fact in facts if fact.lower == fact.upper}
    ways: dict[tuple[str, str], float] = {}
    fitted: dict[int, Wish] = {}
    for wish in sorted(goals.wishes, key=lambda each: each.rank) if has else ():
        if wish.of_picture:  # the last in rank
            claims = [_moved(claim, wish.part_of(claim), ways) for claim in wish.claims]
        else:
            compared = compares(wish.attribute, goals.parsed.attributes, vocabulary)
            claims = [_relative(claim, wish, compared, has, ways) for claim in wish.claims]
        fitted[id(wish)] = replace(wish, claims=tuple(claims))
    return replace(goals, wishes=tuple(fitted.get(id(wish), wish) for wish in goals.wishes))


def _relative(
    claim: ClaimText, wish: Wish, compares: bool, has: Mapping[Axis, float], ways: dict[Axis, float]
) -> ClaimText:
    """A word's claim beside a picture; how far it moves what the picture has of it is added to `ways`."""
    axis = wish.part_of(claim), claim.measure
    own = None if claim.part == "thing" and wish.attribute.owners else has.get(axis)
    if own is None or not (compares or claim.measure in _MOVED):
        return claim
    asked = wish.asked_of(claim)
    way = min(max(own, asked.lower[0]), asked.upper[0]) - own  # how far it moves what the picture has
    if asked.change is not None and (compares or not asked.near):
        way = _SEEN * asked.change
    ways.setdefault(axis, way)
    if not (compares and asked.change):
        return claim
    border = (own + _ENOUGH * way,)
    ends = (border, (math.inf,)) if way > 0.0 else ((-math.inf,), border)
    return replace(claim, lower=ends[0], upper=ends[1], change=None)


def compares(attribute: Attribute, attributes: Sequence[Attribute], vocabulary: Vocabulary) -> bool:
    """True if an attribute, or the mood that it comes from, has a comparative word, as "colder"."""
    if attribute.cause:
        moods = [a for a in attributes if not a.cause and attribute.cause == a.word]
        return any(compares(mood, (), vocabulary) for mood in moods)
    known = vocabulary.adjectives.keys() | vocabulary.synonyms.keys()
    return any(
        word in vocabulary.lists["degree"] or not known.isdisjoint(vocabulary.stems(word, "comparative"))
        for word in (attribute.english or attribute.word).split()
    )


def _moved(claim: ClaimText, part: str, ways: Mapping[Axis, float]) -> ClaimText:
    """A claim of a picture, moved by the words that are about it."""
    for (place, measure), way in ways.items():
        along = _MOVED.get(measure, {}).get(claim.measure)
        if along and place in ("picture", part) and claim.weight:
            lower, upper = (
                tuple(v + way * share for v, share in zip(end, along, strict=True))
                for end in (claim.lower, claim.upper)
            )
            claim = replace(claim, lower=lower, upper=upper)
    return claim
