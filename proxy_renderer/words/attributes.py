# SPDX-License-Identifier: Apache-2.0
"""The objects of a prompt, from its bound look words; display colors of named colors; and described lights."""

from dataclasses import replace

from ..color.constants import Lab
from ..color.floats import chroma, lab_from_srgb
from ..color.shades import basic, shade
from ..schema import Values
from ..schema.parameters import Region
from .lexer import Token
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


def complete(parsed: Parsed, subject: str, things: list[NamedThing], sky: bool = True) -> None:
    """Fills in `parsed.objects` from its attributes and the nouns `things`; `sky`: whether the camera sees the sky."""
    for number, each in enumerate(parsed.attributes):
        if each.kind == "sky" and each.color and not sky:  # an unseen sky is light: its color is the image's
            parsed.attributes[number] = replace(each, kind="ambience", region="whole")
    parsed.ignored = list(dict.fromkeys(parsed.ignored))
    parsed.notes = list(dict.fromkeys(parsed.notes))
    main = next((name for name, region, _ in things if region == "subject"), subject) or "subject"
    objects: dict[tuple[str, Region], PromptObject] = {(main, "subject"): PromptObject(main, "subject")}
    objects |= {(name, region): PromptObject(name, region, materials=its) for name, region, its in things}
    around = next((k for k in objects if k[1] == "surroundings"), ("surroundings", "surroundings"))
    for attribute in (a for a in parsed.attributes if not a.cause):
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
    parsed.objects = list(objects.values())


# Colors


def color_class(attribute: Attribute) -> str:
    """The basic color of a color word: its last word if that is one ("light blue"), else the basic one of its sRGB."""
    last = attribute.entry.rpartition(" ")[2].replace("gray", "grey")
    return last if last in COLORS else basic(attribute.color or (0.5, 0.5, 0.5))


def is_dark(attribute: Attribute) -> bool:
    """True if a word is a color that no light can have: "black"."""
    return attribute.color is not None and lab_from_srgb(attribute.color)[0] < _DARKEST


def display_color(color: tuple[float, ...], region: Region) -> Lab:
    """The Lab value that a lit surface of an sRGB color can reach on the display, in this region of the image.

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
    """The display color, sRGB, of fog of color `srgb`: scattering makes it paler, and neither dark nor white."""
    return shade(srgb, lightness=0.4, chroma=0.6, towards=70.0)


# Lights that are called by their names, and those that are described one by one: "a hard key from the left, warm"


def fixture(thing: str, vocabulary: Vocabulary) -> frozenset[str]:
    """Words of the noun `thing` that tell which light is meant: {"window"} of "window light"; none of "warm light"."""
    words = thing.split()
    if thing in vocabulary.lists["hour"] or not vocabulary.lists["where"].isdisjoint(words):
        return frozenset()
    plain = vocabulary.lists["anylight"] | vocabulary.lists["stop"] | vocabulary.adjectives.keys()
    return frozenset(words) - plain


def light_phrases(passage: Passage, vocabulary: Vocabulary, rigs: RigTable) -> dict[int, tuple[int, ...]]:
    """Place of a token -> the number, from 1, of the light that it describes, as (number,); other tokens are left out.

    A description begins with the part of a sentence that names a light, and goes on in parts that name nothing else: "a
    softbox from the left, large and warm".
    """
    parts: list[list[int]] = []  # places; a part begins with a clause, and at words that join or end a description
    for place, item in enumerate(passage.items):
        joins = "joiner" in item.lists or item.text in vocabulary.words["consequence"]
        if not parts or joins or place in passage.starts:
            parts.append([])
        parts[-1].append(place)
    found: dict[int, tuple[int, ...]] = {}
    number, spoken_of, several = 0, 0, False
    for places in parts:
        items = [passage.items[place] for place in places]
        # it may go on about the light before it, if it names no other thing and no setup
        setups = any(item.entry in rigs.rigs and item.entry not in rigs.modifiers for item in items)
        others = any(item.scene or not item.lists.isdisjoint(("others", "action")) for item in items)
        goes_on = not (setups or others) and all(i.known and i.noun in ("", "glow") for i in items)
        heads = [n for n, item in enumerate(items) if is_light(item, rigs, vocabulary, several or spoken_of > 0)]
        # a color or an adjective of light, with a side: "magenta from the left", "warm from the right"
        of_light = (vocabulary.adjectives.get(item.adjective, {}).get("light", "") for item in items)
        tells = any(item.color for item in items) or any(map(rigs.modifier, of_light))
        modifiers = filter(None, (rigs.modifier(item.entry) for item in items))
        if tells and goes_on and not heads and any("direction" in modifier.aspects for modifier in modifiers):
            heads = [0]
        counts = any("count" in item.lists for item in items) and not any(i.names_a_look for i in items)
        if counts and any(item.noun == "light" for item in items):  # "two lights: a pink one ..."
            several, spoken_of = True, 0
        elif heads and not any("negation" in item.lists for item in items[: heads[0]]):
            number += 1
            spoken_of = number
            found |= dict.fromkeys(places, (number,))
        elif not goes_on:
            spoken_of = 0
        elif spoken_of:  # "cup, warm light, pale blue": a color there may be a thing's
            plain = [p for p, i in zip(places, items, strict=True) if i.color is None or i.text.endswith("white")]
            found |= dict.fromkeys(plain, (spoken_of,))
    return found


def is_light(item: Token, rigs: RigTable, vocabulary: Vocabulary, expected: bool = False) -> bool:
    """True if a token names a light; "one" names a light only if lights are `expected`."""
    if (expected and item.text in vocabulary.words["one_of_them"]) or item.noun in LIGHTS:
        return True
    if vocabulary.slot(item.entry) != "lighting":
        return False
    # "light behind"
    behind = any(vocabulary.nouns.get(singular(word)) in LIGHTS for word in item.text.split())
    return behind or rigs.is_a_light(item.entry, item.text)
