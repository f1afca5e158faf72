# SPDX-License-Identifier: Apache-2.0
"""A further sentence: its words that compare are measured from the image as it is, and the rest of that stays."""

import math
import re
from collections.abc import Iterator
from dataclasses import replace

from ..schema import FAMILIES
from ..words.lexicon.entries import Effect
from ..words.lexicon.quantities import ClaimText
from ..words.lexicon.vocabulary import Vocabulary
from ..words.types import Attribute
from .picture import compares
from .resolve import Goals, resolved
from .wish import Wish, wishes_of

_SMALL = re.compile(r"\b(?:bit|little|slightly|subtly|gently)\b")
_LARGE = re.compile(r"\b(?:much|very|strongly|far|extremely)\b")
_NOTICED = 2.0  # noticeable differences of one step: of warmth a cast of about 3 ΔE
_ENOUGH, _MOST = 0.8, 1.3  # shares of its way between which a word is satisfied
_REACH = 0.07  # share of its range by which a value may move for one step, either way
_BRIGHTER = 1.25  # factor of one step, of what no measure reads
_EXACT = 0.01  # share by which "twice as much" may be missed


def further(goals: Goals, vocabulary: Vocabulary, factor: float = 0.0) -> Goals:
    """Goals of a sentence that goes on from an image; the factor of "twice as much fog" is 2, and 0 if it says none."""
    said, wishes = list[Attribute](), list[Wish]()
    every = (*goals.wishes, *(each.wish for each in goals.lost))
    for attribute in goals.parsed.attributes:
        mine = [wish for wish in every if wish.attribute is attribute]
        if not attribute.cause and compares(attribute, (), vocabulary):
            mine = [*_compared(attribute, vocabulary, factor)]
            attribute = mine[0].attribute if mine else attribute
        elif attribute.role in ("rim", "fill"):  # another light has to show beside what is there
            mine = [replace(wish, claims=tuple(map(_beside, wish.claims))) for wish in mine]
        said.append(attribute)
        wishes += mine
    return replace(resolved(replace(goals.parsed, attributes=said), wishes), holds=True)


def _beside(claim: ClaimText) -> ClaimText:
    """A claim of which a change is enough, as that change."""
    ends = (1.0, 2.5) if (claim.change or 0.0) > 0.0 else (-2.5, -1.0)
    return replace(claim, lower=ends[:1], upper=ends[1:], change=None, by=True) if claim.change else claim


def _compared(attribute: Attribute, vocabulary: Vocabulary, factor: float) -> Iterator[Wish]:
    """The wish of a word that compares: the change of one measure by the parameters that the word has for it."""
    plain = wishes_of([replace(attribute, strength=1.0)], vocabulary)
    main = next((wish for wish in plain if wish.claims), next((wish for wish in plain if wish.effects), None))
    if main is None:
        return
    # What belongs to it: other quantities have a class of their own, or are only usual.
    others = (w for w in plain if not (w is main or w.named or w.claims))
    effects = (*main.effects, *(e for wish in others for e in wish.effects if not e.weak))
    way = _steps(attribute.word) * (-1.0 if _asks_for_less(attribute, vocabulary) else 1.0)
    claims: tuple[ClaimText, ...] = ()
    if main.claims and not factor:
        claim = main.claims[-1]
        rises = claim.change > 0.0 if claim.change else claim.lower[0] > -math.inf
        noticed = _NOTICED * (way if rises else -way)
        lower, upper = sorted((_ENOUGH * noticed, _MOST * noticed))
        claims = (replace(claim, lower=(lower,), upper=(upper,), change=None, near=True, by=True),)
        moved = [_around(effect, noticed) for effect in effects]
    else:
        moved = [_moved(e, way, factor) for e in effects if FAMILIES[e.family].components == 1]
    # Without an entry it stands for no rig.
    bound = replace(attribute, entry="", strength=1.0, shades=())
    yield Wish(bound, main.quantity, effects=tuple(dict.fromkeys(moved)), claims=claims)


def _around(effect: Effect, noticed: float) -> Effect:
    """An effect's parameter, free around its value; the size of a light only to where shadows change as wanted."""
    reach = _REACH * abs(noticed) / _NOTICED
    sized = effect.name in ("size", "angle")
    down, up = (0.0 if sized and noticed < 0.0 else reach), (0.0 if sized and noticed > 0.0 else reach)
    return Effect(effect.owner, effect.name, "near", (-down,), (up,), priority=1)


def _moved(effect: Effect, way: float, factor: float) -> Effect:
    """An effect's parameter, moved by a factor, or by steps in the effect's own direction."""
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
    return Effect(
        effect.owner, effect.name, "times", (factor * (1 - _EXACT),), (factor * (1 + _EXACT),), priority=1
    )


def _steps(word: str) -> float:
    """Noticeable steps that a word asks for: 1 for "a bit warmer", 2 for "warmer", 4 for "much warmer"."""
    return 1.0 if _SMALL.search(word) else 4.0 if _LARGE.search(word) else 2.0


def _asks_for_less(attribute: Attribute, vocabulary: Vocabulary) -> bool:
    """Whether a word asks for less of its entry: "less fog" is said of fog, but "less glossy" of matte."""
    words = attribute.word.split()
    entry = vocabulary.entries.get(attribute.entry)
    ends = (" ".join(words[n:]) for n in range(len(words)))
    return "less" in words and entry is not None and any("less" not in e and e in entry.words for e in ends)
