# SPDX-License-Identifier: Apache-2.0
"""Colors with the words right before them that change colors: "boring green" is a muted green, not gray for being boring."""

from __future__ import annotations

from dataclasses import replace

from ..color.shades import relative_shade
from .lexicon.entries import Effect
from .lexicon.vocabulary import Vocabulary
from .types import Attribute


def shaded(attribute: Attribute, word: str, entry: str, strength: float, vocabulary: Vocabulary) -> Attribute:
    """A color as a word before it makes it; itself where the word says nothing of colors, or it is none.

    Args:
        word: The word, as the prompt says it.
        entry: What the word is of a thing.
    """
    effect = _shade_of(entry, vocabulary)
    if effect is None or not attribute.color:
        return attribute
    lighter, share = ((a + b) / 2 for a, b in zip(effect.lower, effect.upper, strict=True))
    color = relative_shade(attribute.color, lighter, share, strength)
    return replace(attribute, word=f"{word} {attribute.word}", color=color)


def all_shaded(attributes: list[Attribute], prompt: str, vocabulary: Vocabulary) -> list[Attribute]:
    """The attributes, those of one thing that stand together as one: a word that changes colors, and a color.

    Args:
        attributes: In the order of the prompt.
    """
    found: list[Attribute] = []
    for attribute in attributes:
        before = found[-1] if found else attribute
        same = (before.kind, before.owners) == (attribute.kind, attribute.owners)
        whole = attribute
        if same and _only_shades(before) and f"{before.word} {attribute.word}" in prompt:
            whole = shaded(attribute, before.word, before.entry, before.strength, vocabulary)
        if whole is not attribute:
            found.pop()
        found.append(whole)
    return found


def _only_shades(attribute: Attribute) -> bool:
    """Whether a word may say nothing but how the color of a thing is changed."""
    return attribute.slot == "color" and not (attribute.color or attribute.negated or attribute.cause)


def _shade_of(entry: str, vocabulary: Vocabulary) -> Effect | None:
    """How an entry changes the color of a thing."""
    known = vocabulary.entries.get(entry)
    effects = known.effects if known and known.slot == "color" else ()
    return next((e for e in effects if (e.family, e.mode) == ("material/base_color", "shade")), None)
