# SPDX-License-Identifier: Apache-2.0
"""What one word wants of one parameter, and how that is said."""

from __future__ import annotations

from dataclasses import dataclass

from ..prompt.lexicon.entries import OWNERS
from ..prompt.types import Attribute

_USUAL = {
    "material": ("roughness", "specular", "coat", "coat_roughness", "sheen"),
    "atmosphere": ("color", "temperature", "tint", "gain", "midtone", "strength"),
}
"""What other words may say better than a word of this slot."""


@dataclass(frozen=True)
class Demand:
    """What one word wants of one parameter instance.

    Attributes:
        vague: What it is about is said better by other words.
        usual: It is what a place usually has: it counts only where no other word is about the parameter.
        start: Where the search begins, as `PlanEntry.start`.
        any_hue: As `PlanEntry.any_hue`.
    """

    key: str
    lower: tuple[float, ...]
    upper: tuple[float, ...]
    attribute: Attribute
    reason: str
    weak: bool
    priority: int
    vague: bool = False
    usual: bool = False
    start: tuple[float, ...] | None = None
    any_hue: bool = False

    @property
    def rank(self) -> tuple[bool, bool, bool, int, bool]:
        """Where a demand stands; the least comes first.

        Words of the prompt before those that a mood stands for, a finish, a color or a time of day before what a
        material, a weather or a place usually has, what a word is mainly about before what another one implies, and a word for one
        thing before one for several; defaults last.
        """
        usual = self.usual or self.key.rpartition("/")[2] in _USUAL.get(self.attribute.slot, ())
        return self.weak, bool(self.attribute.cause), usual, self.priority, self.vague


def lacking(owner: str) -> str:
    """What a scene has not got, for an effect's owner."""
    if owner in ("rim", "fill", "others"):
        return f"the scene has no light that could be the {'second' if owner == 'others' else owner} light; add one"
    return f"the scene has no {OWNERS[owner]} whose values may change so"


def reason_of(attribute: Attribute, phrase: str) -> str:
    """Quotes the word: "'glossy': glossy, with bright reflections", "'warm' in 'cosy'"."""
    if attribute.cause:
        return f"'{attribute.cause}' means '{attribute.word}'"
    what = f" on the {attribute.thing}" if attribute.color and attribute.thing else ""
    return f"'{attribute.word}'{what}" + (
        f" ({phrase})"
        if phrase and not (attribute.negated or attribute.shades) and phrase != attribute.word
        else ""
    )
