# SPDX-License-Identifier: Apache-2.0
"""What bound look words add up to: objects, and attribute targets."""

from __future__ import annotations

from dataclasses import replace

from ..schema.spec import Region
from .colors import color_regions
from .heads import settle
from .lexicon.vocabulary import Vocabulary
from .lights import numbered
from .moods import overruled
from .shading import all_shaded
from .types import Attribute, Parsed, PromptObject

_COLORED = {
    "light": "lighting",
    "fill": "lighting",
    "rim": "lighting",
    "fog": "atmosphere",
    "glow": "material",
}
"""Kind of thing -> slot that a color word about it counts for."""
_MAIN = 0.5  # share of its region above which a thing's color is the region's
_CLEAR = 0.02  # density of air that has no color
_OUTER = {"surroundings", "atmosphere", "setting", "fog"}
"""Regions, slots and kinds of what is not the subject's."""
_OF_REGIONS = ("subject_", "surroundings_")
"""What heads begin with that speak of a region, and not of the picture or its light."""
NamedThing = tuple[str, Region, tuple[str, ...]]


def complete(parsed: Parsed, vocabulary: Vocabulary, subject: str, things: list[NamedThing]) -> None:
    """Fills in objects, targets, colors and conflicts of a prompt whose attributes are bound."""
    qualified = _qualified(parsed.attributes, vocabulary)
    bound = all_shaded(qualified, parsed.prompt.lower(), vocabulary)
    parsed.attributes = numbered([*bound, *_tint_of_air(bound, vocabulary)], vocabulary)
    parsed.objects = _objects(parsed.attributes, subject, things)
    parsed.overruled = overruled(parsed.attributes, vocabulary)
    _settle(parsed, parsed.attributes, vocabulary)
    parsed.ignored = list(dict.fromkeys(parsed.ignored))


def _settle(parsed: Parsed, attributes: list[Attribute], vocabulary: Vocabulary) -> None:
    """Targets and colors of a prompt: those that some of its attributes come to."""
    settle(parsed, attributes, vocabulary)
    color_regions(parsed, attributes)
    parsed.conflicts = list(dict.fromkeys(parsed.conflicts))


def _tint_of_air(attributes: list[Attribute], vocabulary: Vocabulary) -> list[Attribute]:
    """A tint of the picture once more, for what fills the air and has no color of its own: the water, the smoke."""
    said = [a for a in attributes if not (a.negated or a.cause)]
    colored = {a.kind: a for a in reversed(said) if a.color}
    tint = colored.get("ambience")
    air = next((a for a in said if a.slot == "atmosphere" and _fills_the_air(a, vocabulary)), None)
    if tint is None or air is None or "fog" in colored:
        return []
    return [replace(tint, kind=air.kind, thing=air.thing)]


def _fills_the_air(attribute: Attribute, vocabulary: Vocabulary) -> bool:
    effects = vocabulary.entries[attribute.entry].effects
    return any(e.name == "density" and e.lower[0] > _CLEAR for e in effects)


def _qualified(attributes: list[Attribute], vocabulary: Vocabulary) -> list[Attribute]:
    """What later words say of earlier ones: "dark, but not too dark"; "the fog is too thick" asks for less."""
    later = {(a.entry, a.kind, a.owners): i for i, a in enumerate(attributes) if a.word.startswith("not ")}
    kept = [a for i, a in enumerate(attributes) if later.get((a.entry, a.kind, a.owners), i) <= i]
    heads = {name: entry.heads for name, entry in vocabulary.entries.items() if entry.heads}
    much = [(a.kind, heads[a.entry]) for a in kept if a.word.startswith("too ") and a.entry in heads]
    return [a for a in kept if a.negated or a.cause or a.color or (a.kind, heads.get(a.entry)) not in much]


def forget_sky(parsed: Parsed, vocabulary: Vocabulary) -> None:
    """A sky that the camera does not see is its light alone: what colors it colors the picture.

    Args:
        parsed: Complete; changed.
        vocabulary: What words mean.
    """

    def its_light(attribute: Attribute) -> Attribute:
        hidden = attribute.kind == "sky" and attribute.color
        return replace(attribute, kind="ambience", region="whole") if hidden else attribute

    for attributes in (parsed.attributes, parsed.overruled):
        attributes[:] = map(its_light, attributes)
    _settle(parsed, parsed.attributes, vocabulary)
    if "surroundings" not in parsed.colors:  # "a cloudless noon" made them blue
        parsed.targets.pop("surroundings_color", None)


def forget_parts(parsed: Parsed, shares: dict[str, float], vocabulary: Vocabulary) -> None:
    """A region's targets are those of what makes it up: a black book makes no still life black.

    Args:
        parsed: Complete; changed.
        shares: Material -> fraction of its region's pixels.
        vocabulary: What words mean.
    """
    said = parsed.targets
    large = (a for a in parsed.attributes if sum(shares.get(n, 1.0) for n in a.owners or ("",)) >= _MAIN)
    _settle(parsed, [*large], vocabulary)
    parsed.targets = {
        head: value
        for head, value in said.items()
        if not head.startswith(_OF_REGIONS) or parsed.targets.get(head) == value
    }


def _objects(attributes: list[Attribute], subject: str, things: list[NamedThing]) -> list[PromptObject]:
    """The prompt's objects with their attributes, the subject first."""
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
