# SPDX-License-Identifier: Apache-2.0
"""Words that the vocabulary does not have fall to the nearest entry, with a confidence: a guess, and said to be one."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from .things import english_things
from .vocabulary import Vocabulary
from .word_table import denied, stem, table

if TYPE_CHECKING:
    import numpy as np

SURE = 0.4
"""Confidence below which a word is left out rather than guessed."""
_SURE_ELSEWHERE = 0.5
"""The same for what it means besides."""

_NEAREST, _SHARPNESS = 8, 12.0  # words that vote for their entries, and how much more the nearer ones count
_ALIKE = 0.5
"""Cosine of a place with a setting at least; and more than with any thing that is no setting."""


@dataclass(frozen=True)
class Guess:
    """What a word was taken for.

    Attributes:
        entry: Name of a vocabulary entry.
        near: The known word that it is nearest to.
        confidence: In [0, 1]: how near, and how much the nearest known words agree.
        others: The nearest entries of other slots, the nearest first: what it means where the first says nothing.
        place: Whether it is a place, and stands where the prompt says what is all around: what it describes is known.
    """

    entry: str
    near: str
    confidence: float
    others: tuple[str, ...] = ()
    place: bool = False


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
        slots = [vocabulary.entries[entry].slot for _, entry in self._known]
        self._of_slot = {slot: np.flatnonzero([slot == s for s in slots]) for slot in sorted({*slots})}

    def guess(self, word: str) -> Guess | None:
        """The entry that a word is nearest to; None for words that say nothing about looks."""
        found = self.meant(word)
        if found is None or found[2] < SURE:
            return None
        entry, near, confidence = found
        return Guess(entry, near, round(confidence, 2), self._others(word))

    def meant(self, word: str) -> tuple[str, str, float] | None:
        """Entry, nearest known word and confidence of a word; None where it has no vector."""
        likeness = self._likeness(word)
        return None if likeness is None else self._voted(likeness, likeness.argsort())

    def _others(self, word: str) -> tuple[str, ...]:
        """The nearest entry of each slot, if it is sure enough, the surest first."""
        likeness = self._likeness(word)
        if likeness is None:
            return ()
        of_slots = (self._voted(likeness, its[likeness[its].argsort()]) for its in self._of_slot.values())
        sure = [found for found in of_slots if found[2] >= _SURE_ELSEWHERE]
        return tuple(entry for entry, _, _ in sorted(sure, key=lambda found: -found[2]))

    def _voted(self, likeness: np.ndarray, order: np.ndarray) -> tuple[str, str, float]:
        """The entry for which the nearest words are, the nearest of these, and how sure that is.

        Args:
            likeness: Of all known words.
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


class Places:
    """The settings of a vocabulary by the sort of place that they are, and what is no place.

    Args:
        vocabulary: What is known.
    """

    def __init__(self, vocabulary: Vocabulary) -> None:
        self._entries = {
            w: e for w, e in vocabulary.synonyms.items() if vocabulary.entries[e].slot == "setting"
        }
        around = {w for w, kind in vocabulary.nouns.items() if kind == "surroundings"}
        self._names, self._settings = _sorts(w for w in self._entries if " " not in w)
        _, self._others = _sorts(sorted(english_things() - self._entries.keys() - around))

    def guess(self, word: str) -> Guess | None:
        """The setting of the same sort as an unknown place: a casino is one like a tavern; None for what is no place.

        Args:
            word: Of a prompt, where it says what is all around.
        """
        own = table().sort(word)
        if own is None:
            return None
        likeness = self._settings @ own
        near, best = self._names[int(likeness.argmax())], float(likeness.max())
        if best < max(_ALIKE, float((self._others @ own).max())):
            return None
        return Guess(self._entries[near], near, round(best, 2), place=True)


def _sorts(names: Iterable[str]) -> tuple[list[str], np.ndarray]:
    """Those of the names whose sort is known, and the unit vectors of their sorts (n, E)."""
    import numpy as np

    known = [(name, vector) for name in names if (vector := table().sort(name)) is not None]
    return [name for name, _ in known], np.stack([vector for _, vector in known])
