# SPDX-License-Identifier: Apache-2.0
"""The sum of bound look words: objects with their attributes, colors with shades, and the lights that a prompt tells apart."""

from collections.abc import Iterable
from dataclasses import replace
from itertools import permutations, product

from ..color.constants import Lab
from ..color.floats import chroma, lab_from_srgb
from ..color.shades import basic, hue_apart, relative_shade, shade
from ..schema import Values
from ..schema.parameters import Region
from .lexer import Token
from .lexicon.entries import Effect
from .lexicon.languages import singular
from .lexicon.quantities import COLORS
from .lexicon.rigs import RigTable
from .lexicon.vocabulary import Vocabulary
from .passage import LIGHTS, Passage
from .types import Attribute, Parsed, PromptObject

NamedThing = tuple[str, Region, tuple[str, ...]]  # name, region and materials
_COLORED = dict.fromkeys(LIGHTS, "lighting") | {"fog": "atmosphere", "glow": "material"}
"""Kind of thing -> slot that a color word about it counts for."""
_OUTER = {"surroundings", "atmosphere", "setting", "fog"}  # slots and kinds around the subject
_BLACK = 12.0  # L* of a black thing whose form can be seen
_DARKEST, _LIGHTEST = 14.0, 78.0  # L* of lit things of a strong color, navy and yellow
_STRONG = 30.0  # C* that lit things show in full
_KEPT = 0.7  # share of the chroma beyond that
_WARM_LIGHT, _COOL_LIGHT = (1.0, 0.7, 0.35), (0.5, 0.7, 1.0)  # sRGB of light below and above white
_WHITE = (5000.0, 7000.0)  # kelvins
_APART = 60.0  # degrees of hue from which one light cannot have both colors


def complete(
    parsed: Parsed, vocabulary: Vocabulary, subject: str, things: list[NamedThing], sky: bool = True
) -> None:
    """Fills in the objects of a prompt whose attributes are bound, and relations of words to each other."""
    parsed.attributes = _with_lamps(_all_shaded(parsed, vocabulary), vocabulary)
    if not sky:  # a sky that the camera does not see is its light alone: what colors it colors the image
        hidden = (a.kind == "sky" and a.color for a in parsed.attributes)
        both = zip(parsed.attributes, hidden, strict=True)
        parsed.attributes = [replace(a, kind="ambience", region="whole") if h else a for a, h in both]
    parsed.objects = _objects(parsed.attributes, subject, things)
    parsed.ignored = list(dict.fromkeys(parsed.ignored))
    parsed.notes = list(dict.fromkeys(parsed.notes))


def _objects(attributes: list[Attribute], subject: str, things: list[NamedThing]) -> list[PromptObject]:
    main = next((name for name, region, _ in things if region == "subject"), subject) or "subject"
    objects: dict[tuple[str, Region], PromptObject] = {(main, "subject"): PromptObject(main, "subject")}
    objects |= {
        (name, region): PromptObject(name, region, materials=owners) for name, region, owners in things
    }
    around: tuple[str, Region] = next(
        (k for k in objects if k[1] == "surroundings"), ("surroundings", "surroundings")
    )
    for attribute in (a for a in attributes if not a.cause):
        key = (attribute.thing, attribute.region)
        if key not in objects:
            is_outer = _OUTER & {attribute.region, attribute.slot, attribute.kind}
            key = around if is_outer else (main, "subject")
        slots = objects.setdefault(key, PromptObject(*key)).attributes
        slot, word = attribute.slot, attribute.word
        if slot == "color" and attribute.region == "whole":
            slot, word = _COLORED.get(attribute.kind, "grade"), f"{word} {attribute.thing}"
        said = [*filter(None, slots.get(slot, "").split(", ")), word]
        slots[slot] = ", ".join(dict.fromkeys(said))
    return list(objects.values())


# Colors


def color_class(attribute: Attribute) -> str:
    """The basic color of a color word: its own last word where that is one ("light blue")."""
    last = attribute.entry.rpartition(" ")[2].replace("gray", "grey")
    return last if last in COLORS else basic(attribute.color or (0.5, 0.5, 0.5))


def is_dark(attribute: Attribute) -> bool:
    """True if a word is a color that no light can have: "black"."""
    return attribute.color is not None and lab_from_srgb(attribute.color)[0] < _DARKEST


def display_color(color: tuple[float, ...], region: Region) -> Lab:
    """A Lab value that a lit region of a color can reach on the display.

    Shading and the view transform's shoulder keep saturated colors from the gamut's corners, and
    nothing lit is as black as its name.
    """
    light, a, b = lab_from_srgb(color)
    if (own := chroma((light, a, b))) > _STRONG:
        kept = (_STRONG + _KEPT * (own - _STRONG)) / own
        return min(max(light, _DARKEST), _LIGHTEST), kept * a, kept * b
    ceiling = 95.0 if region == "surroundings" else 86.0
    return min(max(light, _BLACK), ceiling), a, b


def fog_color(srgb: Values) -> Values:
    """The display color of fog of a color: scattering makes it paler, and neither dark nor white."""
    return shade(srgb, lightness=0.4, chroma=0.6, towards=70.0)


def shaded(attribute: Attribute, word: str, entry: str, strength: float, vocabulary: Vocabulary) -> Attribute:
    """A color as a word before it makes it ("boring green" is muted); itself where the word says nothing of colors, or it is none."""
    known = vocabulary.entries.get(entry)
    effects = known.effects if known and known.slot == "color" else ()
    effect = next((e for e in effects if (e.family, e.mode) == ("material/base_color", "shade")), None)
    if effect is None or not attribute.color:
        return attribute
    lighter, share = ((a + b) / 2 for a, b in zip(effect.lower, effect.upper, strict=True))
    color = relative_shade(attribute.color, lighter, share, strength)
    return replace(attribute, word=f"{word} {attribute.word}", color=color)


def _all_shaded(parsed: Parsed, vocabulary: Vocabulary) -> list[Attribute]:
    """The attributes, with a word that changes colors and the color of one object right after it as one: "washed out green"."""
    found: list[Attribute] = []
    for each in parsed.attributes:
        before, prompt = found[-1] if found else each, parsed.prompt.lower()
        same = (before.kind, before.owners, None, "") == (each.kind, each.owners, before.color, before.cause)
        whole = each
        if same and not before.negated and f"{before.word} {each.word}" in prompt:
            whole = shaded(each, before.word, before.entry, before.strength, vocabulary)
        found = [*found[: len(found) - (whole is not each)], whole]
    return found


# Lights that contradict each other: "warm lamp, cold blue window light"


def fixture(thing: str, vocabulary: Vocabulary) -> frozenset[str]:
    """Words of a light's name that say which one is meant: of "warm light" and "from the left" none does."""
    words = thing.split()
    if thing in vocabulary.lists["hour"] or not vocabulary.lists["where"].isdisjoint(words):
        return frozenset()
    plain = vocabulary.lists["anylight"] | vocabulary.lists["stop"] | vocabulary.adjectives.keys()
    return frozenset(words) - plain


def side(attributes: Iterable[Attribute], vocabulary: Vocabulary) -> tuple[float, float] | None:
    """Azimuths relative to the camera, degrees, that words say a light comes from; None if they do not."""
    effects = (effect for attribute in attributes for effect in _strong(attribute, "azimuth", vocabulary))
    return next(((e.lower[0], e.upper[0]) for e in effects if e.mode == "camera"), None)


def _strong(attribute: Attribute, name: str, vocabulary: Vocabulary) -> list[Effect]:
    """Effects of a word that is no color on one parameter of lights, without the weak ones."""
    entry = vocabulary.entries.get("" if attribute.color else attribute.entry)
    effects = [e for e in entry.effects if e.name == name] if entry else []
    return [e for e in effects if e.owner in ("light", "lights") and not e.weak]


def _with_lamps(attributes: list[Attribute], vocabulary: Vocabulary) -> list[Attribute]:
    """The attributes, with the number of the light that each is said of: `Attribute.lamp`.

    Numbers are given only where the words contradict each other on color or side, so that one light cannot be all.
    """
    lamps: list[list[int]] = []  # places of the attributes of each light
    for place, attribute in enumerate(attributes):
        # The light of an evening is no lamp of its own
        known = attribute.cause or attribute.lights or attribute.thing in vocabulary.lists["hour"]
        if known or attribute.kind not in LIGHTS or attribute.slot not in ("lighting", "color"):
            continue
        words = fixture(attribute.thing, vocabulary)
        for lamp in reversed(lamps):  # the newest goes on where the words do not say which
            its = [attributes[p] for p in lamp]
            called = frozenset().union(*(fixture(a.thing, vocabulary) for a in its))
            goes_on = (lamp is lamps[-1] and not (words and called)) or words == called
            apart = its[0].role != attribute.role or any(_contradicts(a, attribute, vocabulary) for a in its)
            if goes_on and not apart:
                lamp.append(place)
                break
        else:
            lamps.append([place])
    others = ((one, other) for one, other in permutations(lamps, 2) if not attributes[one[0]].role)
    pairs = ((attributes[a], attributes[b]) for one, other in others for a, b in product(one, other))
    if not any(_contradicts(a, b, vocabulary) for a, b in pairs):
        return attributes
    number = {place: n for n, lamp in enumerate(lamps, start=1) for place in lamp}
    return [replace(a, lamp=number.get(place, 0)) for place, a in enumerate(attributes)]


def _contradicts(one: Attribute, other: Attribute, vocabulary: Vocabulary) -> bool:
    """True if no light can be both: of two colors, or on two sides."""
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
        if effect.upper[0] < _WHITE[0]:
            return _WARM_LIGHT
        return _COOL_LIGHT if effect.lower[0] > _WHITE[1] else None
    return attribute.color


# Lights that are described one by one: "a hard key from the left, warm, and a cold rim from behind"


def light_phrases(passage: Passage, vocabulary: Vocabulary, rigs: RigTable) -> dict[int, tuple[int, ...]]:
    """Place of an item -> the numbers, from 1, of the lights that it describes; other items are left out.

    A description begins with the words that lead a light's name and goes on in parts of the sentence that name nothing: "a softbox
    from the left, large and warm". Each color after "two rim lights" is one of these. "Both" and "all" speak of every light before.
    """
    found: dict[int, tuple[int, ...]] = {}
    number, spoken_of, words, several = 0, tuple[int, ...](), vocabulary.words, False
    counted, listed = list[int](), list[int]()  # places of "two rim lights", and the numbers of these
    for places in _segments(passage, vocabulary):
        items = [passage.items[place] for place in places]
        goes_on = all(_goes_on(item, rigs, vocabulary) for item in items)
        expected = several or bool(spoken_of)
        heads = [n for n, item in enumerate(items) if _is_light(item, rigs, vocabulary, expected)]
        counts = any("count" in item.lists for item in items) and not any(i.names_a_look for i in items)
        if counts and any(item.noun == "light" for item in items):  # "two lights: a pink one ..."
            several, spoken_of = True, ()
        elif heads and not any("negation" in item.lists for item in items[: heads[0]]):
            number += 1
            spoken_of = (number,)
            found |= dict.fromkeys(places, spoken_of)
            first = {word for item in items for word in item.text.split()[:1]}
            counted, listed = ([] if first.isdisjoint(vocabulary.lists["count"]) else places), []
        elif counted and goes_on and any(item.color for item in items):
            number += bool(listed)
            listed.append(number)
            spoken_of = (number,)
            found |= dict.fromkeys(places, spoken_of) | dict.fromkeys(counted, tuple(listed))
        elif not goes_on:
            spoken_of = ()
        elif spoken_of and any(item.text in words["together"] for item in items):
            spoken_of = tuple(range(1, number + 1))
        # "cup, warm light, pale blue": a color there may be a thing's
        plain = [p for p, i in zip(places, items, strict=True) if i.color is None or i.text.endswith("white")]
        found |= dict.fromkeys(plain if spoken_of else (), spoken_of)
    return found


def _segments(passage: Passage, vocabulary: Vocabulary) -> list[list[int]]:
    """Places of the items, parted where a clause begins and at words that join or end a description."""
    parts: list[list[int]] = []
    for place, item in enumerate(passage.items):
        joins = "joiner" in item.lists or item.text in vocabulary.words["consequence"]
        if not parts or joins or place in passage.starts:
            parts.append([])
        parts[-1].append(place)
    return parts


def _is_light(item: Token, rigs: RigTable, vocabulary: Vocabulary, expected: bool) -> bool:
    """True if an item names a light; "one" does where lights were spoken of."""
    if (expected and item.text in vocabulary.words["one_of_them"]) or item.noun in LIGHTS:
        return True
    if vocabulary.slot(item.entry) != "lighting":
        return False
    # "light behind"
    behind = any(vocabulary.nouns.get(singular(word)) in LIGHTS for word in item.text.split())
    return behind or rigs.is_a_light(item.entry, item.text)


def _goes_on(item: Token, rigs: RigTable, vocabulary: Vocabulary) -> bool:
    """True if an item names no other thing and no setup, so that it may go on about the light before it."""
    setup = item.entry in rigs.rigs and item.entry not in rigs.modifiers
    rest = "others" in item.lists and item.text not in vocabulary.words["together"]
    return (
        item.known
        and item.noun in ("", "glow")
        and not (item.scene or rest or setup or "action" in item.lists)
    )
