# SPDX-License-Identifier: Apache-2.0
"""What bound look words add up to: the objects of a prompt, with their attributes."""

from __future__ import annotations

from dataclasses import replace

from ..schema.spec import Region
from .lexicon.vocabulary import Vocabulary
from .lights import numbered
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
_CLEAR = 0.02  # density of air that has no color
_OUTER = {"surroundings", "atmosphere", "setting", "fog"}
"""Regions, slots and kinds of what is not the subject's."""
NamedThing = tuple[str, Region, tuple[str, ...]]


def complete(
    parsed: Parsed, vocabulary: Vocabulary, subject: str, things: list[NamedThing], sky: bool = True
) -> None:
    """Fills in the objects of a prompt whose attributes are bound, and what words say of each other."""
    qualified = _qualified(parsed.attributes, vocabulary)
    bound = all_shaded(qualified, parsed.prompt.lower(), vocabulary)
    parsed.attributes = numbered([*bound, *_tint_of_air(bound, vocabulary)], vocabulary)
    if not sky:
        parsed.attributes = [_without_sky(a) for a in parsed.attributes]
    parsed.objects = _objects(parsed.attributes, subject, things)
    parsed.ignored = list(dict.fromkeys(parsed.ignored))
    parsed.notes = list(dict.fromkeys(parsed.notes))


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
    classes = {a.entry: vocabulary.entries[a.entry].classes for a in kept if a.entry in vocabulary.entries}
    much = [(a.kind, classes[a.entry]) for a in kept if a.word.startswith("too ") and classes.get(a.entry)]
    return [a for a in kept if a.negated or a.cause or a.color or (a.kind, classes.get(a.entry)) not in much]


def _without_sky(attribute: Attribute) -> Attribute:
    """A sky that the camera does not see is its light alone: what colors it colors the picture."""
    hidden = attribute.kind == "sky" and attribute.color
    return replace(attribute, kind="ambience", region="whole") if hidden else attribute


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
