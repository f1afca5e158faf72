# SPDX-License-Identifier: Apache-2.0
"""What bound look words add up to: objects, and attribute targets."""

from __future__ import annotations

from dataclasses import replace

from ..schema.spec import Region
from .colors import COLOR_REGIONS, color_regions
from .lexicon.vocabulary import Vocabulary
from .lights import numbered
from .moods import overruled
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
_FOGS = {"light", "thick"}
"""Classes of fog of which the thicker one counts, without a contradiction."""
_SAID_SOFTLY = ("light_side", "light_temperature", "vignette", "subject_color")
"""Heads that words say something of under "slightly" too."""
NamedThing = tuple[str, Region, tuple[str, ...]]


def complete(parsed: Parsed, vocabulary: Vocabulary, subject: str, things: list[NamedThing]) -> None:
    """Fills in objects, targets, colors and conflicts of a prompt whose attributes are bound."""
    bound = _qualified(parsed.attributes, vocabulary)
    parsed.attributes = numbered([*bound, *_tint_of_air(bound, vocabulary)], vocabulary)
    parsed.objects = _objects(parsed.attributes, subject, things)
    parsed.overruled = overruled(parsed.attributes, vocabulary)
    _settle_targets(parsed, vocabulary)
    color_regions(parsed, parsed.attributes)
    parsed.ignored = list(dict.fromkeys(parsed.ignored))
    parsed.conflicts = list(dict.fromkeys(parsed.conflicts))


def _tint_of_air(attributes: list[Attribute], vocabulary: Vocabulary) -> list[Attribute]:
    """A tint of the picture once more, for what fills the air and has no color of its own: the water, the smoke."""
    said = [a for a in attributes if not (a.negated or a.cause)]
    tint = next((a for a in said if a.kind == "ambience" and a.color), None)
    air = next((a for a in said if a.slot == "atmosphere" and _fills_the_air(a, vocabulary)), None)
    if tint is None or air is None or any(a.kind == "fog" and a.color for a in said):
        return []
    return [replace(tint, kind=air.kind, thing=air.thing)]


def _fills_the_air(attribute: Attribute, vocabulary: Vocabulary) -> bool:
    effects = vocabulary.entries[attribute.entry].effects
    return any(e.name == "density" and e.lower[0] > _CLEAR for e in effects)


def _settle_targets(parsed: Parsed, vocabulary: Vocabulary) -> None:
    """What the attribute heads should say; of words that contradict each other, the first one counts."""
    settlers: dict[str, Attribute] = {}

    def rank(attribute: Attribute) -> tuple[bool, ...]:
        """What is usual comes after what is said: a desert is bright, but not at dusk."""
        usual = (attribute.slot == "material", attribute.slot == "setting")
        return bool(attribute.cause), *usual, is_vague(attribute, vocabulary)

    for attribute in sorted((a for a in parsed.attributes if a not in parsed.overruled), key=rank):
        heads = heads_of(attribute, vocabulary)
        if heads.get("fog") == "thick" and parsed.targets.get("fog") == "light" and not attribute.cause:
            parsed.targets["fog"] = "thick"
        firsts = {head: settlers.setdefault(head, attribute) for head in heads}
        said = {head: {value, parsed.targets.setdefault(head, value)} for head, value in heads.items()}
        unlike = [head for head, values in said.items() if len(values) > 1 and values != _FOGS]
        lost = [head for head in unlike if _contradicts(head, attribute, firsts[head])]
        for head in lost:
            first = firsts[head].cause or firsts[head].word
            what = f"'{attribute.word}' contradicts '{first}' on {head.replace('_', ' ')}"
            parsed.conflicts.append(f"{what}: '{first}' counts.")
        if heads and len(lost) == len(heads):
            parsed.overruled.append(attribute)


def _contradicts(head: str, attribute: Attribute, first: Attribute) -> bool:
    """Whether two words that say unlike things of a head are about the same; what is only usual gives way silently."""
    usual = attribute.slot == "setting" or (attribute.slot == "material" and head == "subject_finish")
    apart = attribute.owners and first.owners and {*attribute.owners}.isdisjoint(first.owners)
    apart = apart or (attribute.lamp, attribute.lights) != (first.lamp, first.lights)
    return not (attribute.cause or usual or apart or head.endswith("_color"))


def is_vague(attribute: Attribute, vocabulary: Vocabulary) -> bool:
    """Whether a word about light says several things: "evening" gives way to "warm light" on what both speak of."""
    entry = vocabulary.entries.get(attribute.entry)
    return entry is not None and entry.slot == "lighting" and len(entry.heads) > 1


def _qualified(attributes: list[Attribute], vocabulary: Vocabulary) -> list[Attribute]:
    """What later words say of earlier ones: "dark, but not too dark"; "the fog is too thick" asks for less."""
    later = {(a.entry, a.kind, a.owners): i for i, a in enumerate(attributes) if a.word.startswith("not ")}
    kept = [a for i, a in enumerate(attributes) if later.get((a.entry, a.kind, a.owners), i) <= i]
    heads = {name: entry.heads for name, entry in vocabulary.entries.items() if entry.heads}
    much = [(a.kind, heads[a.entry]) for a in kept if a.word.startswith("too ") and a.entry in heads]
    return [a for a in kept if a.negated or a.cause or a.color or (a.kind, heads.get(a.entry)) not in much]


def heads_of(attribute: Attribute, vocabulary: Vocabulary) -> dict[str, str]:
    """The attribute classes that one word asks for: head -> class."""
    if attribute.entry not in vocabulary.entries:
        return {}
    entry = vocabulary.entries[attribute.entry]
    if attribute.negated:
        opposite = vocabulary.entries.get(entry.opposite)
        return entry.never_heads or (opposite.heads if opposite else {})
    unsaid: list[str] = []
    if attribute.role in ("rim", "fill") or attribute.told_apart:  # the heads speak of the key light
        unsaid.append("light_")
    if attribute.region == "surroundings" or attribute.kind in ("light", "fog", "tone", "shadow"):
        unsaid.append("subject_")
    heads = {head: value for head, value in entry.heads.items() if not head.startswith(tuple(unsaid))}
    return _softer(heads) if attribute.strength < 0.8 else heads


def _softer(heads: dict[str, str]) -> dict[str, str]:
    """What is left of classes under "slightly": thick fog becomes light fog, most others say nothing."""
    softer = {head: value for head, value in heads.items() if head in _SAID_SOFTLY}
    if "fog" in heads:
        softer["fog"] = "light" if heads["fog"] == "thick" else heads["fog"]
    return softer


def forget_sky(parsed: Parsed) -> None:
    """A sky that the camera does not see is its light alone: what colors it colors the picture.

    Args:
        parsed: Complete; changed.
    """

    def its_light(attribute: Attribute) -> Attribute:
        hidden = attribute.kind == "sky" and attribute.color
        return replace(attribute, kind="ambience", region="whole") if hidden else attribute

    for attributes in (parsed.attributes, parsed.overruled):
        attributes[:] = map(its_light, attributes)
    parsed.colors.pop("surroundings", None)
    parsed.targets.pop("surroundings_color", None)
    color_regions(parsed, parsed.attributes)


def forget_parts(parsed: Parsed, shares: dict[str, float], vocabulary: Vocabulary) -> None:
    """A region's targets are those of what makes it up: a black book makes no still life black.

    Args:
        parsed: Complete; changed.
        shares: Material -> fraction of its region's pixels.
        vocabulary: What words mean.
    """
    parts = [a for a in parsed.attributes if a.owners and sum(shares.get(n, 1.0) for n in a.owners) < _MAIN]
    mine: set[str] = set()
    for attribute in parts:
        region = COLOR_REGIONS.get(attribute.kind)
        heads = {h for h in heads_of(attribute, vocabulary) if h.startswith("subject_")}
        mine |= heads | ({f"{region}_color"} if attribute.color else set())
        if region and attribute.color:
            parsed.colors.pop(region, None)
    kept = [a for a in parsed.attributes if a not in parts]
    spoken = {h for a in kept for h in heads_of(a, vocabulary)}
    parsed.targets = {head: value for head, value in parsed.targets.items() if head not in mine - spoken}
    color_regions(parsed, kept)


def _objects(attributes: list[Attribute], subject: str, things: list[NamedThing]) -> list[PromptObject]:
    """The prompt's objects with their attributes, the subject first."""
    main = next((name for name, region, _ in things if region == "subject"), subject) or "subject"
    objects: dict[tuple[str, Region], PromptObject] = {(main, "subject"): PromptObject(main, "subject")}
    for name, region, owners in things:
        objects.setdefault((name, region), PromptObject(name, region, materials=owners)).materials = owners
    around: tuple[str, Region] = next(
        (k for k in objects if k[1] == "surroundings"), ("surroundings", "surroundings")
    )
    for attribute in (a for a in attributes if not a.cause):
        key = (attribute.thing, attribute.region)
        if key not in objects:
            outer = {"surroundings", "atmosphere", "setting", "fog"}
            is_outer = outer & {attribute.region, attribute.slot, attribute.kind}
            key = around if is_outer else (main, "subject")
        slots = objects.setdefault(key, PromptObject(*key)).attributes
        slot, word = attribute.slot, attribute.word
        if slot == "color" and attribute.region == "whole":
            slot, word = _COLORED.get(attribute.kind, "grade"), f"{word} {attribute.thing}"
        said = slots[slot].split(", ") if slot in slots else []
        slots[slot] = ", ".join(dict.fromkeys([*said, word]))
    return list(objects.values())
