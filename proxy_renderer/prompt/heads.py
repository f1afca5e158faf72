# SPDX-License-Identifier: Apache-2.0
"""What words say of a picture's attribute heads ("fog" -> "thick"), and which of them counts where they disagree."""

from __future__ import annotations

from .lexicon.vocabulary import Vocabulary
from .types import Attribute, Parsed

_FOGS = {"light", "thick"}
"""Classes of fog of which the thicker one counts, without a contradiction."""
_SAID_SOFTLY = ("light_side", "light_temperature", "vignette", "subject_color", "fog")
"""Heads that words say something of under "slightly" too."""
_SOFTER = {("fog", "thick"): "light"}
"""Head and class -> its class under "slightly"."""
_SOFT = 0.8  # strength below which a word is said softly
_OTHER_LIGHTS = ("rim", "fill")
_NO_MATTER = ("light", "fog", "tone", "shadow")
"""Kinds of things of which a word says nothing of the subject."""


def heads_of(attribute: Attribute, vocabulary: Vocabulary) -> dict[str, str]:
    """The attribute classes that one word asks for: head -> class."""
    entry = vocabulary.entries.get(attribute.entry)
    if entry is None:
        return {}
    if attribute.negated:
        opposite = vocabulary.opposite(entry)
        return entry.never_heads or (opposite.heads if opposite else {})
    unsaid = []
    if attribute.role in _OTHER_LIGHTS or attribute.told_apart:  # the heads speak of the key light
        unsaid.append("light_")
    if attribute.region == "surroundings" or attribute.kind in _NO_MATTER:
        unsaid.append("subject_")
    heads = {head: value for head, value in entry.heads.items() if not head.startswith(tuple(unsaid))}
    return _softer(heads) if attribute.strength < _SOFT else heads


def _softer(heads: dict[str, str]) -> dict[str, str]:
    """What is left of classes under "slightly": thick fog becomes light fog, most others say nothing."""
    return {head: _SOFTER.get((head, value), value) for head, value in heads.items() if head in _SAID_SOFTLY}


def is_vague(attribute: Attribute, vocabulary: Vocabulary) -> bool:
    """Whether a word about light says several things: "evening" gives way to "warm light" on what both speak of."""
    entry = vocabulary.entries.get(attribute.entry)
    return entry is not None and entry.slot == "lighting" and len(entry.heads) > 1


def settle(parsed: Parsed, attributes: list[Attribute], vocabulary: Vocabulary) -> None:
    """What the attribute heads should say; of words that contradict each other, the first one counts.

    Args:
        parsed: Gets the targets, the contradictions, and the words that lose all that they say.
        attributes: Those that count.
        vocabulary: What words mean.
    """
    settled: dict[str, tuple[str, Attribute]] = {}
    meant = [a for a in attributes if a not in parsed.overruled]
    for attribute in sorted(meant, key=lambda a: _rank(a, vocabulary)):
        heads = heads_of(attribute, vocabulary)
        lost = []
        for head, value in heads.items():
            said, first = settled.setdefault(head, (value, attribute))
            if {said, value} == _FOGS:
                settled[head] = "thick", first
            elif said != value and _contradicts(head, attribute, first):
                lost.append(head)
                what = f"'{attribute.word}' contradicts '{first.word}' on {head.replace('_', ' ')}"
                parsed.conflicts.append(f"{what}: '{first.word}' counts.")
        if heads and len(lost) == len(heads):
            parsed.overruled.append(attribute)
    parsed.targets = {head: value for head, (value, _) in settled.items()}


def _rank(attribute: Attribute, vocabulary: Vocabulary) -> tuple[bool, ...]:
    """What is usual comes after what is said: a desert is bright, but not at dusk."""
    usual = (attribute.slot == "material", attribute.slot == "setting")
    return bool(attribute.cause), *usual, is_vague(attribute, vocabulary)


def _contradicts(head: str, attribute: Attribute, first: Attribute) -> bool:
    """Whether two words that say unlike things of a head are about the same; what is only usual gives way silently."""
    usual = attribute.slot == "setting" or (attribute.slot, head) == ("material", "subject_finish")
    apart = attribute.owners and first.owners and {*attribute.owners}.isdisjoint(first.owners)
    other_light = (attribute.lamp, attribute.lights) != (first.lamp, first.lights)
    return not (attribute.cause or usual or apart or other_light or head.endswith("_color"))
