# SPDX-License-Identifier: Apache-2.0
"""Known words that an unknown word may stand for, the nearest first: offered for a click, never acted on.

A guess by meaning is right too rarely, at any confidence: of 649 on which the reader acted in labeled sentences 140 said nothing
of a look, 12 of the 24 surest ones among them ("class" as classy). Only spelling is corrected without asking (`lexer.py`).
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from .vocabulary import Vocabulary
from .word_table import denied, stem, table

if TYPE_CHECKING:
    import numpy as np

_MAY_BE = 0.4
"""Confidence from which a word may speak of a look, and names no thing."""
_NEAREST, _SHARPNESS = 8, 12.0  # words that vote for their entries, and how much more the nearer ones count


class Nearest:
    """The entries of a vocabulary as places in the table's space."""

    def __init__(self, vocabulary: Vocabulary) -> None:
        import numpy as np

        self._table = table()
        known = [(w, e, self._table.vector(w)) for w, e in vocabulary.synonyms.items()]
        self._known = [(word, entry) for word, entry, vector in known if vector is not None]
        self._places = np.stack([vector for _, _, vector in known if vector is not None])
        self._denying: dict[str, list[int]] = defaultdict(list)
        for place, (word, _) in enumerate(self._known):
            self._denying[denied(word)].append(place)

    def may_be_a_look(self, word: str) -> bool:
        """Whether an unknown word may speak of a look, so that known ones are offered in its place."""
        found = self.meant(word)
        return found is not None and found[2] >= _MAY_BE

    def meant(self, word: str) -> tuple[str, str, float] | None:
        """Entry, nearest known word and confidence of a word; None where it has no vector."""
        likeness = self._likeness(word)
        return None if likeness is None else self._voted(likeness, likeness.argsort())

    def _voted(self, likeness: np.ndarray, order: np.ndarray) -> tuple[str, str, float]:
        """The entry for which the nearest words are, the nearest of these, and how sure that is.

        Args:
            order: Of those that vote, the nearest last.
        """
        import numpy as np

        best = order[: -_NEAREST - 1 : -1]
        votes: dict[str, float] = {}
        for i in best:
            entry = self._known[i][1]
            votes[entry] = votes.get(entry, 0.0) + float(np.exp(_SHARPNESS * likeness[i]))
        entry = max(votes, key=votes.__getitem__)
        first = next(i for i in best if self._known[i][1] == entry)
        agreement = votes[entry] / sum(votes.values())
        return entry, self._known[first][0], float(likeness[first]) * (0.5 + 0.5 * agreement)

    def choices(self, word: str, count: int) -> list[str]:
        """Known words that a word may be taken for, each of another entry, the nearest first; none where it has no vector."""
        likeness = self._likeness(word)
        if likeness is None:
            return []
        chosen: dict[str, str] = {}
        for i in (-likeness).argsort():
            known, entry = self._known[i]
            chosen.setdefault(entry, known)
            if len(chosen) == count:
                break
        return list(chosen.values())

    def _likeness(self, word: str) -> np.ndarray | None:
        """Cosines of a word with the known words; None where it has no vector."""
        vector = self._table.vector(word)
        if vector is None:
            return None
        likeness = self._places @ vector
        if lacking := denied(word):  # "moonless" is no moonlight
            likeness[[i for i, (known, _) in enumerate(self._known) if known.startswith(lacking)]] = -1.0
        likeness[self._denying.get(stem(word), [])] = -1.0  # "wrinkled" is not unwrinkled
        return likeness
