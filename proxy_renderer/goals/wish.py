# SPDX-License-Identifier: Apache-2.0
"""A wish: what one word wants of one quantity. Ranges of parameters and claims about the image are computed from it."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import cast

from ..schema import FAMILIES
from ..schema.parameters import PICTURE, may_serve
from ..words.attributes import color_class, is_dark
from ..words.lexicon.entries import OWNERS, Effect, EntryWish, VocabularyEntry
from ..words.lexicon.quantities import ClaimText, Quantity, quantities
from ..words.lexicon.vocabulary import Vocabulary
from ..words.types import Attribute, Part

_OWN: Mapping[str, tuple[str, ...]] = {
    "material": ("color", "substance", "glow"),
    "atmosphere": ("haze", "haze_color"),
    "setting": (),
}
"""Slots of words that say only what is usual of other quantities than these: a rainy day is gray, but not if it is said to be golden,
and gold is shiny, but not if it is matte."""
PAINTED = ("color", "surroundings_color")  # quantities of which a class is a basic color
_CHANGES = ("times", "plus", "near", "shade")  # modes of effects that only change what is there
_MAIN = 1  # priority of what a word is mainly about


@dataclass(frozen=True)
class Wish:
    """The demand of one word on one quantity."""

    attribute: Attribute  # the word, with what it describes: source and target
    quantity: str  # name in `quantities.toml`
    named: str = ""  # the class that it asks for: "glossy"; "" where it names none, or is a color
    toward: str = ""  # the same where it is said too softly to ask for all of it: "slightly muted"
    effects: tuple[Effect, ...] = ()  # what it does to parameters; of a color, what colors do to such a thing
    claims: tuple[ClaimText, ...] = ()  # what the image has to look like, those of the class last
    strength: float = 1.0  # 1 as named; less for "slightly" and for what is only denied, more for "very"
    breadth: int = 0  # how many things its word claims: what is about nothing else counts more
    vague: bool = False  # whether its word is about the light or the image as a whole: a time of day, a style

    @property
    def word(self) -> str:
        """The word of the prompt that it comes from."""
        return self.attribute.cause or self.attribute.word

    @property
    def about(self) -> Quantity:
        """Its quantity."""
        return quantities().by_name[self.quantity]

    @property
    def implied(self) -> bool:
        """True if a mood stands for it: the prompt does not say it."""
        return bool(self.attribute.cause)

    @property
    def of_picture(self) -> bool:
        """True if a reference image says it, and no word."""
        return self.attribute.slot == PICTURE

    def asked_of(self, claim: ClaimText) -> ClaimText:
        """One of its claims as its word means it: what a mood stands for, and a soft word, is satisfied sooner."""
        strength = self.attribute.strength
        return claim.of_strength(strength, self.implied or strength < _SOFT)

    def part_of(self, claim: ClaimText) -> Part:
        """The part of the image that one of its claims is about."""
        return self.attribute.part if claim.part == "thing" else cast(Part, claim.part)

    @property
    def is_seen(self) -> bool:
        """True if it says what the image is to look like, and not only what may be done for it."""
        return bool(self.named) or self.is_measured

    @property
    def is_measured(self) -> bool:
        """True if it claims something of the image, which a measure reads off it."""
        material = self.attribute.slot == "material" and self.quantity == "color" and self.effects
        return bool(self.claims or self.attribute.color or material)

    @cached_property
    def usual(self) -> int:
        """0 for what a word says; above for what a material, a weather (1) or a place (2) usually has."""
        slot = self.attribute.slot
        if slot not in _OWN or self.quantity in _OWN[slot]:
            return 0
        if slot == "setting":  # "a dark background" is mainly dark; a desert is bright as a rule
            return 0 if any(e.priority == _MAIN for e in self.effects) else 2
        return 1

    @cached_property
    def rank(self) -> tuple[bool, bool, int, bool, bool, int, bool, int, int]:
        """The place in a conflict, which the least wins.

        In this order: words before a reference image; what is more than a default; what is said before what is implied, and that
        before what is usual; what is said of one thing before what is said of all; a named color before that of a material, and
        what only changes what is there last; what is not vague; what is about nothing else; what its word is mainly about.
        """
        default = not self.is_seen and all(e.weak for e in self.effects)
        general = not self.attribute.of_one_light
        painted = bool(self.attribute.color) and self.quantity != "light_color"
        changing = bool(self.effects) and all(e.mode in _CHANGES for e in self.effects)
        changes = self.quantity == "color" and changing
        paint = 0 if painted else 2 if changes else 1
        main = min((e.priority for e in self.effects if not e.weak), default=4)
        said = self.of_picture, default, self.usual, self.implied
        return *said, general, paint, self.vague, self.breadth, main


def breadth_of(wishes: Iterable[Wish]) -> int:
    """Number of things that the wishes of one word claim of the image."""
    return len({(claim.measure, claim.part) for wish in wishes for claim in wish.claims})


_SOFT = 0.8  # strength below which a word is said softly
_NOT = 0.6  # "not glossy" asks for a mild "matte"
_OF_COLORS = {
    "surroundings": "surroundings_color", "sky": "surroundings_color", "fog": "haze_color", "subject": "color",
    "glow": "color",
}  # fmt: skip
"""Kind of thing -> the quantity of its color; of all others it is the color of the light."""
_OF_LIGHT = ("direction", "hardness", "light_color")  # their classes speak of the key, or of all light
_OF_MATTER = ("color", "finish", "substance")
_NO_MATTER = ("light", "fog", "tone", "shadow")  # kinds of things of which a word says nothing of a surface


def wishes_of(attributes: Iterable[Attribute], vocabulary: Vocabulary) -> list[Wish]:
    """The wishes of words, in their order."""
    return [wish for attribute in attributes for wish in _of_word(attribute, vocabulary)]


def _of_word(attribute: Attribute, vocabulary: Vocabulary) -> Iterator[Wish]:
    if attribute.color:
        if not attribute.negated:
            quantity = _OF_COLORS.get(attribute.kind, "light_color")
            effects = _allowed(vocabulary.painted.get(attribute.kind, ()), attribute)
            anything = attribute.kind == "ambience"  # a color that is said of nothing
            if anything and is_dark(attribute):
                return
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
    """An entry's wish for a word that is said of something, softly or strongly."""
    quantity = quantities().by_name[own.quantity]
    named = own.named if _speaks_of(attribute, own.quantity) else ""
    if named and attribute.strength < _SOFT:
        named = quantity.softer.get(named, named) if quantity.softly else ""
    claims = (*(() if attribute.negated else own.claims), *quantity.classes.get(named, ()))
    # "a cool rim light" leaves the world as it is
    elsewhere = (attribute.lights or attribute.role) and own.quantity == "surroundings_color"
    effects = () if elsewhere else _allowed(own.effects, attribute)
    return Wish(attribute, own.quantity, named, named or own.named, effects, claims, strength)


def _speaks_of(attribute: Attribute, quantity: str) -> bool:
    """True if a word names a class of a quantity where it stands: the classes of light speak of the key, or of all light."""
    if quantity in _OF_LIGHT:
        return not (attribute.lights or attribute.role in ("rim", "fill"))
    if quantity in _OF_MATTER:
        return attribute.region != "surroundings" and attribute.kind not in _NO_MATTER
    return True


def _allowed(effects: Iterable[Effect], attribute: Attribute) -> tuple[Effect, ...]:
    """The effects that are means which a word has: no mood paints."""
    return tuple(e for e in effects if may_serve(OWNERS[e.owner], attribute.slot, attribute.cause))


def _denied(entry: VocabularyEntry, vocabulary: Vocabulary) -> list[EntryWish]:
    """The wishes of a denied word: what it forbids, else its opposite, else that its effects do nothing."""
    opposite = vocabulary.opposite(entry)
    # pastel and noir are both muted
    shared = entry.classes.items() & opposite.classes.items() if opposite else set()
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
