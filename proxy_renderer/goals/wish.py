# SPDX-License-Identifier: Apache-2.0
"""A wish: the request of one word about one quantity. Parameter ranges and claims about the image are made from it."""

from collections.abc import Iterable, Iterator
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

_OWN = {"material": ("color", "substance", "glow"), "atmosphere": ("haze", "haze_color"), "setting": ()}
"""Slot -> the quantities that its words are about. On other quantities, they say what is usual, and other words win:
a rainy day is gray, but not if the prompt calls it golden; gold is shiny, but not if the prompt calls it matte."""
PAINTED = ("color", "surroundings_color")  # quantities whose classes are basic colors


@dataclass(frozen=True)
class Wish:
    """The request of one word, or of a reference image, about one quantity."""

    attribute: Attribute  # the word that asks, with the target that it describes
    quantity: str  # name in `quantities.toml`
    named: str = ""  # the class that it asks for, as "glossy"; "" if it asks for none
    toward: str = ""  # `named`, or if that is "" the class of its entry: "slightly muted" is toward "muted"
    effects: tuple[Effect, ...] = ()  # on parameters; of a color word, the effects of any color on its kind of target
    claims: tuple[ClaimText, ...] = ()  # about the image, those of the class last
    strength: float = 1.0  # 1 for the plain word, less for "slightly" and some negated words, more for "very"
    breadth: int = 0  # number of claims of its word, each measure and part once: fewer claims win a conflict
    vague: bool = False  # whether its word is about the light or the image as a whole: a time of day, a style

    @property
    def word(self) -> str:
        """The word of the prompt that the wish comes from."""
        return self.attribute.cause or self.attribute.word

    @property
    def about(self) -> Quantity:
        """The row of the wish's quantity in the table of quantities."""
        return quantities().by_name[self.quantity]

    @property
    def implied(self) -> bool:
        """True if the wish comes from a mood or style and is not in the prompt itself."""
        return bool(self.attribute.cause)

    @property
    def of_picture(self) -> bool:
        """True if the wish comes from a reference image, not from a word."""
        return self.attribute.slot == PICTURE

    def asked_of(self, claim: ClaimText) -> ClaimText:
        """`claim`, adapted to the strength of the wish's word: implied and soft words are satisfied sooner."""
        strength = self.attribute.strength
        return claim.of_strength(strength, self.implied or strength < _SOFT)

    def part_of(self, claim: ClaimText) -> Part:
        """The part of the image that `claim` is about; for "thing", the part that the wish's word describes."""
        return self.attribute.part if claim.part == "thing" else cast(Part, claim.part)

    @property
    def is_seen(self) -> bool:
        """True if the wish says how the image should look, by a class or a measure; False if it only has effects."""
        return bool(self.named) or self.is_measured

    @property
    def is_measured(self) -> bool:
        """True if the wish leads to a claim, which a measure can check on the image."""
        material = self.attribute.slot == "material" and self.quantity == "color" and self.effects
        return bool(self.claims or self.attribute.color or material)

    @cached_property
    def usual(self) -> int:
        """0 if the word itself asks for it, 1 if a material or weather usually has it, 2 if a place usually has it."""
        slot = self.attribute.slot
        if slot not in _OWN or self.quantity in _OWN[slot]:
            return 0
        if slot == "setting":  # "a dark background" is mainly about darkness; a desert is only usually bright
            return 0 if any(e.priority == 1 for e in self.effects) else 2
        return 1

    @cached_property
    def rank(self) -> tuple[bool, bool, int, bool, bool, int, bool, int, int]:
        """The sort key of a conflict: the smallest wins.

        The first of these rules that applies decides: a word before a reference image; any wish before a default; what
        a word says before what is usual; said before implied; a word about one light or object before one about all.
        Then a named color comes before the color of a material, and a mere change of the present color last. The last
        rules: words that are not vague before vague ones, fewer claims before more, a word's main effect before others.
        """
        default = not self.is_seen and all(e.weak for e in self.effects)
        general = not self.attribute.of_one_light
        painted = bool(self.attribute.color) and self.quantity != "light_color"
        changing = bool(self.effects) and all(e.mode in ("times", "plus", "near", "shade") for e in self.effects)
        paint = 0 if painted else 2 if changing and self.quantity == "color" else 1
        main = min((e.priority for e in self.effects if not e.weak), default=4)
        said = self.of_picture, default, self.usual, self.implied
        return *said, general, paint, self.vague, self.breadth, main


def breadth_of(wishes: Iterable[Wish]) -> int:
    """Number of different (measure, part) pairs among the claims of one word's wishes."""
    return len({(claim.measure, claim.part) for wish in wishes for claim in wish.claims})


_SOFT = 0.8  # strength below which a word is said softly
_OF_COLORS = {
    "surroundings": "surroundings_color", "sky": "surroundings_color", "fog": "haze_color", "subject": "color",
    "glow": "color",
}  # fmt: skip
"""Kind of target -> the quantity that a color word for it is about; for all other kinds "light_color"."""


def wishes_of(attributes: Iterable[Attribute], vocabulary: Vocabulary) -> list[Wish]:
    """All wishes of the look words `attributes`, in the order of the words."""
    return [wish for attribute in attributes for wish in _of_word(attribute, vocabulary)]


def _of_word(attribute: Attribute, vocabulary: Vocabulary) -> Iterator[Wish]:
    if attribute.color:
        if not attribute.negated:
            quantity = _OF_COLORS.get(attribute.kind, "light_color")
            effects = _allowed(vocabulary.painted.get(attribute.kind, ()), attribute)
            vague = attribute.kind == "ambience"  # a color word without a target
            if not (vague and is_dark(attribute)):
                named = color_class(attribute) if quantity in PAINTED else ""
                yield Wish(attribute, quantity, named, effects=effects, strength=attribute.strength, vague=vague)
        return
    entry = vocabulary.entries.get(attribute.entry)
    if entry is None:
        return
    found = _denied(entry, vocabulary) if attribute.negated else entry.wishes
    mild = attribute.negated and entry.opposite and not any(m.effects for m in entry.never)
    strength = 0.6 if mild else attribute.strength  # "not glossy" is a mild "matte"
    wishes = [_wish(own, attribute, strength) for own in found]
    vague = entry.slot in ("lighting", "grade") and len(entry.classes) > 1
    for wish in wishes:
        if wish.effects or wish.claims or wish.named:
            yield replace(wish, breadth=breadth_of(wishes), vague=vague)


def _wish(own: EntryWish, attribute: Attribute, strength: float) -> Wish:
    """An entry's wish, adapted to the target and the strength of a word of the prompt."""
    quantity = quantities().by_name[own.quantity]
    named = own.named
    # Classes of light describe the key or all light, and classes of matter surfaces of the subject.
    if own.quantity in ("direction", "hardness", "light_color") and (
        attribute.lights or attribute.role in ("rim", "fill")
    ):
        named = ""
    if own.quantity in ("color", "finish", "substance") and (
        attribute.region == "surroundings" or attribute.kind in ("light", "fog", "tone", "shadow")
    ):
        named = ""
    if named and attribute.strength < _SOFT:
        named = quantity.softer.get(named, named) if quantity.softly else ""
    claims = (*(() if attribute.negated else own.claims), *quantity.classes.get(named, ()))
    # "a cool rim light" leaves the world as it is
    elsewhere = (attribute.lights or attribute.role) and own.quantity == "surroundings_color"
    effects = () if elsewhere else _allowed(own.effects, attribute)
    return Wish(attribute, own.quantity, named, named or own.named, effects, claims, strength)


def _allowed(effects: Iterable[Effect], attribute: Attribute) -> tuple[Effect, ...]:
    """Those of `effects` whose parameters a word of the attribute's slot may change: a mood changes no materials."""
    return tuple(e for e in effects if may_serve(OWNERS[e.owner], attribute.slot, attribute.cause))


def _denied(entry: VocabularyEntry, vocabulary: Vocabulary) -> list[EntryWish]:
    """Wishes of a negated word: the entry's `never` wishes, else its opposite's, else effects that set the defaults."""
    opposite = vocabulary.opposite(entry)
    # An opposite may have classes in common with the word: pastel and noir are both muted.
    shared = entry.classes.items() & opposite.classes.items() if opposite else set()
    other = [m for m in opposite.wishes if (m.quantity, m.named) not in shared] if opposite else []
    acting = [m for m in entry.never if m.effects] or [m for m in other if m.effects]
    if not acting and opposite is None:
        for m in entry.wishes:  # plain ranges of one number return to the default; lights stay
            plain = [e for e in m.effects if e.mode == "" and len(e.lower) == 1 and OWNERS[e.owner] != "light"]
            defaults = [(e, (FAMILIES[e.family].default,)) for e in plain]
            acting.append(replace(m, effects=tuple(Effect(e.owner, e.name, "", value, value) for e, value in defaults)))
    naming = [m for m in entry.never if m.named] or [m for m in other if m.named]
    named = {m.quantity: m.named for m in naming}
    doing = {m.quantity: m.effects for m in acting}
    return [EntryWish(q, named.get(q, ""), doing.get(q, ())) for q in dict.fromkeys([*named, *doing])]
