# SPDX-License-Identifier: Apache-2.0
"""A wish: what one word wants of one quantity. Ranges of parameters and claims about the image are computed from it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

from ..words.lexicon.entries import Effect
from ..words.lexicon.quantities import ClaimText, Quantity, quantities
from ..words.types import Attribute

_OWN: Mapping[str, tuple[str, ...]] = {
    "material": ("color", "substance", "glow"),
    "atmosphere": ("haze", "haze_color"),
    "setting": (),
}
"""Slots of words that say only what is usual of other quantities than these: a rainy day is gray, but not if it is said to be golden,
and gold is shiny, but not if it is matte."""
PAINTED = ("color", "surroundings_color")
"""Quantities of which a class is a basic color."""
_CHANGES = ("times", "plus", "shade")
"""Modes of effects that only change what is there."""
_MAIN = 1
"""Priority of what a word is mainly about."""


@dataclass(frozen=True)
class Wish:
    """What one word wants of one quantity.

    Attributes:
        attribute: The word, with what it describes: source and target.
        quantity: Name in `quantities.toml`.
        named: The class that it asks for: "glossy"; "" where it names none, or is a color.
        toward: The same where it is said too softly to ask for all of it: "slightly muted".
        effects: What it does to parameters; of a color word, what colors do to such a thing.
        claims: What the image has to look like, those of the class last.
        strength: 1 as named; less for "slightly" and for what is only denied, more for "very".
        breadth: How many things its word claims: what is about nothing else counts more.
        vague: Whether its word is about the light or the image as a whole, as a time of day and a style are.
    """

    attribute: Attribute
    quantity: str
    named: str = ""
    toward: str = ""
    effects: tuple[Effect, ...] = ()
    claims: tuple[ClaimText, ...] = ()
    strength: float = 1.0
    breadth: int = 0
    vague: bool = False

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
        """Whether a mood stands for it: the prompt does not say it."""
        return bool(self.attribute.cause)

    @property
    def is_seen(self) -> bool:
        """Whether it says what the image is to look like, and not only what may be done for it."""
        return bool(self.named) or self.is_measured

    @property
    def is_measured(self) -> bool:
        """Whether it claims something of the image, which a measure reads off it."""
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
    def rank(self) -> tuple[bool, int, bool, bool, int, bool, int, int]:
        """Who wins a conflict: the least.

        What is more than a default; what is said before what is implied, and that before what is usual; what is said of one
        thing before what is said of all; a named color before that of a material, and what only changes what is there last; what
        is not vague; what is about nothing else; what its word is mainly about.
        """
        default = not self.is_seen and all(e.weak for e in self.effects)
        general = not (self.attribute.owners or self.attribute.told_apart or self.attribute.role)
        painted = bool(self.attribute.color) and self.quantity != "light_color"
        changes = (
            self.quantity == "color" and bool(self.effects) and all(e.mode in _CHANGES for e in self.effects)
        )
        main = min((e.priority for e in self.effects if not e.weak), default=4)
        return (
            default,
            self.usual,
            self.implied,
            general,
            0 if painted else 2 if changes else 1,
            self.vague,
            self.breadth,
            main,
        )


def breadth_of(wishes: Iterable[Wish]) -> int:
    """How many things the wishes of one word claim of the image."""
    return len({(claim.measure, claim.part) for wish in wishes for claim in wish.claims})
