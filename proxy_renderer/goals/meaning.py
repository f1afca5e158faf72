# SPDX-License-Identifier: Apache-2.0
"""From the words of a prompt to wishes: one for each quantity that a word is about."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from ..schema import FAMILIES
from ..schema.means import may_serve
from ..words.attributes import color_class
from ..words.lexicon.entries import OWNERS, Effect, EntryWish, VocabularyEntry
from ..words.lexicon.quantities import quantities
from ..words.lexicon.vocabulary import Vocabulary
from ..words.types import Attribute
from .wish import PAINTED, Wish, breadth_of

_SOFT = 0.8
"""Strength below which a word is said softly."""
_NOT = 0.6  # "not glossy" asks for a mild "matte"
_OF_COLORS = {
    "surroundings": "surroundings_color",
    "sky": "surroundings_color",
    "fog": "haze_color",
    "subject": "color",
    "glow": "color",
}
"""Kind of thing -> the quantity of its color; of all others it is the color of the light."""
_OF_LIGHT = ("direction", "hardness", "light_color")
"""Quantities whose classes speak of the key light, or of light as a whole."""
_OF_MATTER = ("color", "finish", "substance")
_NO_MATTER = ("light", "fog", "tone", "shadow")
"""Kinds of things of which a word says nothing of a surface."""


def wishes_of(attributes: Iterable[Attribute], vocabulary: Vocabulary) -> list[Wish]:
    """What words wish for, in their order."""
    return [wish for attribute in attributes for wish in _of_word(attribute, vocabulary)]


def _of_word(attribute: Attribute, vocabulary: Vocabulary) -> Iterator[Wish]:
    if attribute.color:
        if not attribute.negated:
            quantity = _OF_COLORS.get(attribute.kind, "light_color")
            effects = _allowed(vocabulary.painted.get(attribute.kind, ()), attribute)
            anything = attribute.kind == "ambience"  # a color that is said of nothing
            named = color_class(attribute) if quantity in PAINTED else ""
            strength = attribute.strength
            yield Wish(attribute, quantity, named, effects=effects, strength=strength, vague=anything)
        return
    entry = vocabulary.entries.get(attribute.entry)
    if entry is None:
        return
    found = _denied(entry, vocabulary) if attribute.negated else entry.wishes
    mild = attribute.negated and entry.opposite and not any(m.effects for m in entry.never)
    strength = _NOT if mild else attribute.strength
    wishes = [_wish(own, attribute, strength) for own in found]
    vague = entry.slot in ("lighting", "grade") and len(entry.classes) > 1
    for wish in wishes:
        if wish.effects or wish.claims or wish.named:
            yield replace(wish, breadth=breadth_of(wishes), vague=vague)


def _wish(own: EntryWish, attribute: Attribute, strength: float) -> Wish:
    """What an entry's wish comes to for a word that is said of something, softly or strongly."""
    quantity = quantities().by_name[own.quantity]
    named = own.named if _speaks_of(attribute, own.quantity) else ""
    if named and attribute.strength < _SOFT:
        named = quantity.softer.get(named, named) if quantity.softly else ""
    claims = (*(() if attribute.negated else own.claims), *quantity.classes.get(named, ()))
    effects = _allowed(own.effects, attribute)
    return Wish(attribute, own.quantity, named, named or own.named, effects, claims, strength)


def _speaks_of(attribute: Attribute, quantity: str) -> bool:
    """Whether a word names a class of a quantity where it stands: the classes of light speak of the key, or of all light."""
    if quantity in _OF_LIGHT:
        return not (attribute.told_apart or attribute.role in ("rim", "fill"))
    if quantity in _OF_MATTER:
        return attribute.region != "surroundings" and attribute.kind not in _NO_MATTER
    return True


def _allowed(effects: Iterable[Effect], attribute: Attribute) -> tuple[Effect, ...]:
    """The effects that are means which a word has: no mood paints."""
    return tuple(e for e in effects if may_serve(OWNERS[e.owner], attribute.slot, attribute.cause))


def _denied(entry: VocabularyEntry, vocabulary: Vocabulary) -> list[EntryWish]:
    """What a denied word means: what it forbids, else its opposite, else that its effects do nothing."""
    opposite = vocabulary.opposite(entry)
    shared = (
        entry.classes.items() & opposite.classes.items() if opposite else set()
    )  # pastel and noir are both muted
    other = [m for m in opposite.wishes if (m.quantity, m.named) not in shared] if opposite else []
    acting = [m for m in entry.never if m.effects] or [m for m in other if m.effects]
    if not acting and opposite is None:
        acting = [replace(m, effects=tuple(_undone(m.effects))) for m in entry.wishes]
    naming = [m for m in entry.never if m.named] or [m for m in other if m.named]
    named = {m.quantity: m.named for m in naming}
    doing = {m.quantity: m.effects for m in acting}
    return [EntryWish(q, named.get(q, ""), doing.get(q, ())) for q in dict.fromkeys([*named, *doing])]


def _undone(effects: Iterable[Effect]) -> Iterator[Effect]:
    """Effects at the values at which they change nothing, where a parameter has one."""
    for effect in effects:
        if effect.mode == "" and len(effect.lower) == 1 and OWNERS[effect.owner] != "light":
            default = FAMILIES[effect.family].default
            yield Effect(effect.owner, effect.name, "", (default,), (default,))
