# SPDX-License-Identifier: Apache-2.0
"""What a mood stands for: the row `means` of its entry, plain look words between commas."""

from __future__ import annotations

from math import prod

from ...schema import VibeError
from ...schema.spec import Region
from ..lexer import Lexer
from ..lexicon.vocabulary import Vocabulary
from ..tokens import Token
from ..types import Attribute, SceneWords

KIND_OF_SLOT = {
    "lighting": "light", "atmosphere": "fog", "grade": "tone", "setting": "surroundings",
    "finish": "subject", "material": "subject", "color": "subject",
}  # fmt: skip
"""What a word of a slot is about, where no noun says it."""
_LAMPS = ("fill", "rim")
_Row = tuple[Attribute, ...]


def stands_for(entry: str, vocabulary: Vocabulary) -> _Row:
    """The attributes that a mood brings.

    Args:
        entry: Of the mood.
        vocabulary: What words mean.

    Raises:
        VibeError: The row says something that is not known, or another mood.
    """
    rows = vocabulary.made(_none_read)
    row = rows.get(entry)
    if row is None:
        lexer, row = Lexer(vocabulary, SceneWords()), ()
        for tokens in lexer.clauses(vocabulary.entries[entry].means):
            row += _part(tokens, entry, vocabulary)
        rows[entry] = row
    return row


def _none_read(_: Vocabulary) -> dict[str, _Row]:
    """The moods of a vocabulary that were read."""
    return {}


def _part(tokens: list[Token], cause: str, vocabulary: Vocabulary) -> _Row:
    """The attributes of one part: intensities, look words, and what they describe."""
    looks = [t for t in tokens if t.entry or t.color]
    nouns = [t for t in tokens if t.noun]
    said = " ".join(t.text for t in tokens)
    if not looks:
        raise VibeError(
            f"Vocabulary: '{said}', for which '{cause}' stands, is no look.",
            "Use words that the vocabulary knows.",
        )
    strength = prod(t.strength for t in tokens if t.strength is not None and t not in looks)
    return tuple(_attribute(t, tokens, nouns, strength, cause, vocabulary) for t in looks)


def _attribute(
    token: Token, tokens: list[Token], nouns: list[Token], strength: float, cause: str, vocabulary: Vocabulary
) -> Attribute:
    entry = vocabulary.entries.get(token.entry)
    if entry and entry.means:
        raise VibeError(
            f"Vocabulary: '{cause}' stands for '{entry.name}', which itself stands for other words."
        )
    slot = entry.slot if entry else "color"
    named = nouns[-1] if nouns and slot in ("color", "finish", "material", "setting") else token
    kind = named.noun or KIND_OF_SLOT[slot]
    region: Region = kind if kind in ("subject", "surroundings") else "whole"  # type: ignore[assignment]
    said = " ".join(t.text for t in tokens if t is not named or t is token)
    return Attribute(
        said, token.entry or token.name or token.text, slot, region, kind, strength,
        role=kind if kind in _LAMPS else "", color=None if entry else token.color, thing=named.text, cause=cause,
    )  # fmt: skip
