# SPDX-License-Identifier: Apache-2.0
"""Says in the artist's own words what a glossed prompt was understood as."""

from __future__ import annotations

import re
from dataclasses import replace

from ..lexicon.entries import normalize
from ..types import Attribute, Parsed
from .gloss import Gloss
from .pieces import Piece

_TOKEN = re.compile(r"[^\W_]+")
_QUOTED = re.compile(r"(?<=')[^']+(?=')")
_NEAR = 6  # words that may stand between a look word and its intensity


class Retelling:
    """Finds the artist's words for English ones."""

    def __init__(self, gloss: Gloss) -> None:
        self.gloss = gloss
        self._words: list[tuple[str, Piece]] = []
        for piece in gloss.pieces:
            self._words += [(word, piece) for word in _TOKEN.findall(normalize(piece.english))]
        self._taken: set[int] = set()

    def retell(self, parsed: Parsed) -> None:
        """Puts the artist's words in place of the English ones, wherever people read them.

        Args:
            parsed: What was understood of the gloss; is changed.
        """
        parsed.attributes = [self._attribute(attribute) for attribute in parsed.attributes]
        for thing in parsed.objects:
            thing.attributes = {
                slot: ", ".join(map(self.said, words.split(", "))) for slot, words in thing.attributes.items()
            }
        parsed.ignored = [self.said(text) for text in parsed.ignored]
        parsed.guesses = {self.said(word): entry for word, entry in parsed.guesses.items()}
        parsed.notes = [_QUOTED.sub(lambda m: self.said(m[0]), text) for text in parsed.notes]

    def said(self, english: str) -> str:
        """The artist's words for English ones; these themselves where they are not from the prompt."""
        found = self._find(english, again=True)
        return self._text(found) if found else english

    def english(self, word: str) -> str:
        """The English words for one of the prompt; "" where the prompt lacks it."""
        start = self.gloss.prompt.casefold().find(word.casefold())
        end = start + len(word)
        meant = (piece for piece in self.gloss.pieces if piece.start < end and start < piece.end)
        return " ".join(piece.english for piece in meant) if start >= 0 else ""

    def _attribute(self, attribute: Attribute, again: bool = False) -> Attribute:
        if attribute.cause:
            return replace(attribute, cause=self.said(attribute.cause))
        found = self._find(attribute.word, again)
        if not found:
            return attribute
        look = self._words[found[-1]][1]
        start = next(p.start for p in self._pieces(found) if p.end <= look.start + 1 or p is look)
        return replace(attribute, word=self._text(found), english=attribute.word, place=(start, look.end))

    def _find(self, english: str, again: bool) -> list[int]:
        """Where words stand: the last ones together, those before them near; none where the last is not there."""
        words = _TOKEN.findall(normalize(english))
        said = [word for word, _ in self._words]
        for count in range(len(words), 0, -1):
            ends = (end for end in range(count, len(said) + 1) if said[end - count : end] == words[-count:])
            end = next((end for end in ends if again or end not in self._taken), 0)
            if end:
                self._taken.add(end)
                start = end - count
                near = range(max(start - _NEAR, 0), start)
                before = [i for word in words[:-count] for i in near if said[i] == word]
                return [*before, *range(start, end)]
        return []

    def _pieces(self, found: list[int]) -> list[Piece]:
        return sorted({self._words[i][1] for i in found}, key=lambda piece: (piece.start, piece.end))

    def _text(self, found: list[int]) -> str:
        """The prompt's words, in its order."""
        spans = sorted({(piece.start, piece.end) for piece in self._pieces(found)})
        text, last = "", spans[0][0]
        for start, end in spans:
            gap = self.gloss.prompt[last:start]
            text += (" " if gap.strip() else gap) + self.gloss.prompt[start:end]
            last = end
        return text
