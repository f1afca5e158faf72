# SPDX-License-Identifier: Apache-2.0
"""Comparative words such as "colder": relative to a reference image, or to the image that a further sentence goes on from."""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from ..schema import FAMILIES
from ..words.lexicon.entries import Effect
from ..words.lexicon.quantities import ClaimText
from ..words.lexicon.vocabulary import Vocabulary
from ..words.types import Attribute
from .resolve import CASTS, Goals, resolved
from .wish import Wish, wishes_of

Axis = tuple[str, str]  # a part of the image, and a measure of it
_WARMER = (0.4, 0.8)  # a* and b* that together raise the warmth by 1, see `claims.measures.color.warmth`
_LIGHTER = {
    "black_point": (0.2,), "lower_quartile": (0.8,), "median": (1.0,), "upper_quartile": (0.8,),
    "white_point": (0.2,), "lightness": (1.0,),
}  # fmt: skip
"""Measure of tone -> L* by which it moves for one L* of lightness. The ends move less: a lighter image keeps its black."""
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

    A word may ask for more or less of a measure than the reference image has. The image's claims about that measure then move along:
    to where the word is satisfied, or, for a comparative word such as "colder", by a clearly visible amount. A comparative word is
    then measured against the reference image. If several words move one measure of one part, the first in rank counts.
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
    """A word's claim next to a reference image; adds to `ways`, by part and measure, how far the word moves the image's value."""
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
    known = vocabulary.adjectives.keys() | vocabulary.synonyms.keys()
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


_SMALL = re.compile(r"\b(?:bit|little|slightly|subtly|gently)\b")
_LARGE = re.compile(r"\b(?:much|very|strongly|far|extremely)\b")
_NOTICED = 2.0  # noticeable differences in one step; for warmth one step is a cast of about 3 ΔE
_LEAST, _MOST = 0.8, 1.3  # shares of the requested change between which a word is satisfied
_REACH = 0.07  # share of its range by which a value may move for one step, up or down
_BRIGHTER = 2.0**0.5  # factor of one step for values on a log scale that no measure reads: half a stop
_EXACT = 0.01  # share by which "twice as much" may be missed


def further(goals: Goals, vocabulary: Vocabulary, factor: float = 0.0, text: str = "") -> Goals:
    """Goals of a sentence that goes on from an image.

    Args:
        factor: 2 in "twice as much fog"; 0 if the sentence has none.
        text: The sentence from the word that the factor is of.
    """
    said, wishes = list[Attribute](), list[Wish]()
    every = (*goals.wishes, *(each.wish for each in goals.lost))
    compared = [a for a in goals.parsed.attributes if not a.cause and compares(a, (), vocabulary)]
    # of "half as red, more contrast" the red
    first = next((a for a in compared if text.startswith(a.word)), None)
    for attribute in goals.parsed.attributes:
        mine = [wish for wish in every if wish.attribute is attribute]
        if attribute in compared:
            mine = [*_compared(attribute, vocabulary, factor if first in (None, attribute) else 0.0)]
            attribute = mine[0].attribute if mine else attribute
        elif any(_names_light_of(attribute, each) for each in compared):
            attribute, mine = replace(attribute, entry=""), []
        elif attribute.role in ("rim", "fill"):  # a further light has to change the present image visibly
            mine = [replace(wish, claims=tuple(map(_beside, wish.claims))) for wish in mine]
        said.append(attribute)
        wishes += mine
    return replace(resolved(replace(goals.parsed, attributes=said), wishes), holds=True)


def _names_light_of(attribute: Attribute, compared: Attribute) -> bool:
    """True if a word only names the light of a comparative word: in "the window light a bit darker" nobody asks for a window."""
    same = bool(attribute.lights) and {*attribute.lights} <= {*compared.lights}
    return attribute.slot == "lighting" and (same or bool(attribute.role and attribute.role == compared.role))


def _beside(claim: ClaimText) -> ClaimText:
    """A claim with a sufficient change, turned into a claim for 1 to 2.5 noticeable steps that way; other claims as they are."""
    ends = (1.0, 2.5) if (claim.change or 0.0) > 0.0 else (-2.5, -1.0)
    return replace(claim, lower=ends[:1], upper=ends[1:], change=None, by=True) if claim.change else claim


def _compared(attribute: Attribute, vocabulary: Vocabulary, factor: float) -> Iterator[Wish]:
    """At most one wish of a comparative word: the change of one measure, or without a measure of the parameters themselves."""
    plain = wishes_of([replace(attribute, strength=1.0)], vocabulary)
    main = next((wish for wish in plain if wish.claims), next((wish for wish in plain if wish.effects), None))
    if main is None:
        return
    # Effects that belong to the main wish. Other wishes with a class or claims of their own are left out, and so are
    # weak effects.
    others = (w for w in plain if not (w is main or w.named or w.claims))
    effects = (*main.effects, *(e for wish in others for e in wish.effects if not e.weak))
    way = _steps(attribute.word) * (-1.0 if _asks_for_less(attribute, vocabulary) else 1.0)
    claims: tuple[ClaimText, ...] = ()
    if main.claims and not factor:
        claim = main.claims[-1]
        rises = claim.change > 0.0 if claim.change else claim.lower[0] > -math.inf
        noticed = _NOTICED * (way if rises else -way)
        lower, upper = sorted((_LEAST * noticed, _MOST * noticed))
        claims = (replace(claim, lower=(lower,), upper=(upper,), change=None, near=True, by=True),)
        moved = [_around(effect, noticed, way) for effect in effects]
    else:
        moved = [_effect_moved(e, way, factor) for e in effects if FAMILIES[e.family].components == 1]
    # Without an entry the word stands for no rig: it is about the light that is in the scene.
    bound = replace(attribute, entry="", strength=1.0, shades=(), phrases=())
    yield Wish(bound, main.quantity, effects=tuple(dict.fromkeys(moved)), claims=claims)


def _around(effect: Effect, noticed: float, way: float) -> Effect:
    """An effect that lets its parameter move around its value; sizes of lights and finishes move only in the word's direction."""
    reach = _REACH * abs(noticed) / _NOTICED
    towards = noticed if effect.name in ("size", "angle") else way * _finish_direction(effect)
    down, up = (0.0 if towards > 0.0 else reach), (0.0 if towards < 0.0 else reach)
    return Effect(effect.owner, effect.name, "near", (-down,), (up,), priority=1)


def _finish_direction(effect: Effect) -> float:
    """1 if an effect raises a value of a finish, -1 if it lowers the value; 0 for other effects, and if the default lies in its range."""
    parameter = FAMILIES[effect.family]
    if parameter.group != "material" or parameter.components > 1 or effect.mode:
        return 0.0
    low, plain, high = effect.lower[0], parameter.default, effect.upper[0]
    if low < plain < high:
        return 0.0
    # A range that begins at the parameter's own lower end, as "coat 0..0.1" does, asks for less.
    rises = high == parameter.upper if plain >= high else low > parameter.lower
    return 1.0 if rises else -1.0


def _effect_moved(effect: Effect, way: float, factor: float) -> Effect:
    """An effect that moves its parameter by a factor, or, if that is 0, by `way` steps in the effect's own direction."""
    parameter = FAMILIES[effect.family]
    if not factor:
        rises = effect.lower[0] * effect.upper[0] > 1.0
        if effect.mode != "times":
            rises = effect.lower[0] + effect.upper[0] > 2 * parameter.default
        way = way if rises else -way
        if parameter.scale.name != "log":
            ends = sorted((_REACH * way * (1 - _EXACT), _REACH * way * (1 + _EXACT)))
            return Effect(effect.owner, effect.name, "near", (ends[0],), (ends[1],), priority=1)
        factor = _BRIGHTER**way
    low, high = ((factor * (1 + off),) for off in (-_EXACT, _EXACT))
    return Effect(effect.owner, effect.name, "times", low, high, priority=1)


def _steps(word: str) -> float:
    """Steps that a word asks for: 1 for "a bit warmer", 2 for "warmer", 4 for "much warmer"."""
    return 1.0 if _SMALL.search(word) else 4.0 if _LARGE.search(word) else 2.0


def _asks_for_less(attribute: Attribute, vocabulary: Vocabulary) -> bool:
    """True if a word asks for less of its entry: "less fog" has the entry fog. "Less glossy" has the entry matte: False."""
    words = attribute.word.split()
    entry = vocabulary.entries.get(attribute.entry)
    ends = (" ".join(words[n:]) for n in range(len(words)))
    return "less" in words and entry is not None and any("less" not in e and e in entry.words for e in ends)
