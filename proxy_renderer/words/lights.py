# SPDX-License-Identifier: Apache-2.0
"""The lights that a prompt tells apart: "warm lamp, cold blue window light" describes two."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from itertools import product

from ..color.shades import hue_apart
from ..schema import Values
from .lexicon.entries import Effect
from .lexicon.vocabulary import Vocabulary
from .types import Attribute

_KINDS = ("light", "fill", "rim")
_WARM, _COOL = (1.0, 0.7, 0.35), (0.5, 0.7, 1.0)
"""sRGB that stands for light below and above the temperatures that count as white."""
_WHITE = (5000.0, 7000.0)  # kelvin
_APART = 60.0  # degrees of hue from which one light cannot have both colors


@dataclass
class Mention:
    """What the words say of one light.

    Attributes:
        role: "key", "fill" or "rim"; "" where the words do not say.
        fixture: Words that say which one it is: {"street", "lamps"}.
        said: Its attributes.
        places: Their places in the prompt.
    """

    role: str
    fixture: frozenset[str]
    said: list[Attribute] = field(default_factory=list)
    places: list[int] = field(default_factory=list)


def numbered(attributes: list[Attribute], vocabulary: Vocabulary) -> list[Attribute]:
    """The attributes, with the number of the light that each is said of: `Attribute.lamp`.

    Numbers are given only where the words contradict each other on color or side, so that one light cannot be all.
    """
    mentions = _mentions(attributes, vocabulary)
    others = ((one, other) for one in mentions for other in mentions if other is not one and not one.role)
    pairs = (pair for one, other in others for pair in product(one.said, other.said))
    if not any(_contradicts(a, b, vocabulary) for a, b in pairs):
        return attributes
    number = {place: n for n, mention in enumerate(mentions, start=1) for place in mention.places}
    return [replace(a, lamp=number.get(place, 0)) for place, a in enumerate(attributes)]


def fixture(thing: str, vocabulary: Vocabulary) -> frozenset[str]:
    """Words of a light's name that say which one is meant: of "warm light" and "from the left" none does."""
    words = thing.split()
    if thing in vocabulary.lists["hour"] or not vocabulary.lists["where"].isdisjoint(words):
        return frozenset()
    plain = vocabulary.lists["anylight"] | vocabulary.lists["stop"] | vocabulary.adjectives.keys()
    return frozenset(words) - plain


def side(said: Iterable[Attribute], vocabulary: Vocabulary) -> tuple[float, float] | None:
    """Azimuths relative to the camera, degrees, that words say a light comes from; None if they do not."""
    effects = (effect for attribute in said for effect in _strong(attribute, "azimuth", vocabulary))
    return next(((e.lower[0], e.upper[0]) for e in effects if e.mode == "camera"), None)


def _mentions(attributes: list[Attribute], vocabulary: Vocabulary) -> list[Mention]:
    found: list[Mention] = []
    for place, attribute in enumerate(attributes):
        if not _is_of_a_lamp(attribute, vocabulary):
            continue
        words = fixture(attribute.thing, vocabulary)
        before = (m for m in reversed(found) if _continues(m, words, attribute, m is found[-1], vocabulary))
        mention = next(before, None) or Mention(attribute.role, words)
        if not mention.said:
            found.append(mention)
        mention.fixture |= words
        mention.said.append(attribute)
        mention.places.append(place)
    return found


def _is_of_a_lamp(attribute: Attribute, vocabulary: Vocabulary) -> bool:
    """Whether a word is about a light that may be told apart; the light of an evening is no lamp of its own."""
    known = attribute.cause or attribute.lights or attribute.thing in vocabulary.lists["hour"]
    return not known and attribute.kind in _KINDS and attribute.slot in ("lighting", "color")


def _continues(
    mention: Mention, words: frozenset[str], attribute: Attribute, newest: bool, vocabulary: Vocabulary
) -> bool:
    """Whether an attribute goes on about the light that was spoken of, the newest one if it does not say which."""
    if mention.role != attribute.role or any(_contradicts(a, attribute, vocabulary) for a in mention.said):
        return False
    goes_on = newest and not (words and mention.fixture)
    return goes_on or words == mention.fixture


def _contradicts(one: Attribute, other: Attribute, vocabulary: Vocabulary) -> bool:
    """Whether no light can be both: of two colors, or on two sides."""
    if one.negated or other.negated:
        return False
    here, there = side([one], vocabulary), side([other], vocabulary)
    if here and there and max(here[0], there[0]) > min(here[1], there[1]):
        return True
    if one.color and other.color:
        return one.entry != other.entry
    tones = [*filter(None, (_tone(one, vocabulary), _tone(other, vocabulary)))]
    is_one = one.thing == other.thing  # "a cold green light"
    return len(tones) == 2 and not is_one and hue_apart(*tones) > _APART


def _tone(attribute: Attribute, vocabulary: Vocabulary) -> Values | None:
    """sRGB of the color that a word gives to light; None for white light and for words that give none."""
    for effect in _strong(attribute, "temperature", vocabulary):
        return _WARM if effect.upper[0] < _WHITE[0] else _COOL if effect.lower[0] > _WHITE[1] else None
    return attribute.color


def _strong(attribute: Attribute, name: str, vocabulary: Vocabulary) -> list[Effect]:
    """What a word that is no color does to one parameter of lights, not weakly."""
    entry = vocabulary.entries.get("" if attribute.color else attribute.entry)
    effects = [e for e in entry.effects if e.name == name] if entry else []
    return [e for e in effects if e.owner in ("light", "lights") and not e.weak]
