# SPDX-License-Identifier: Apache-2.0
"""Places that nobody listed: "inside of a casino" is the nearest setting that the vocabulary has, said to be guessed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cache
from typing import TYPE_CHECKING

from .lexicon.nearest import Guess, table
from .lexicon.things import english_things
from .lexicon.vocabulary import Vocabulary, shipped_vocabulary
from .tokens import Token

if TYPE_CHECKING:
    import numpy as np

_ALIKE = 0.5
"""Cosine of a place with a setting at least; and more than with any thing that is no setting."""


class SettingIndex:
    """The settings of a vocabulary by the sort of place that they are, and what is no place.

    Args:
        vocabulary: What is known.
    """

    def __init__(self, vocabulary: Vocabulary) -> None:
        named = {w: e for w, e in vocabulary.synonyms.items() if vocabulary.entries[e].slot == "setting"}
        around = {w for w, kind in vocabulary.nouns.items() if kind == "surroundings"}
        self._entries = named
        self._names, self._settings = _sorts(w for w in named if " " not in w)
        _, self._others = _sorts(sorted(english_things() - named.keys() - around))

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


def guess_places(tokens: Sequence[Token], vocabulary: Vocabulary) -> None:
    """Marks unknown words that say what is all around with the nearest place.

    Args:
        tokens: Of a clause; changed.
        vocabulary: What is known.
    """
    unknown = [i for i, t in enumerate(tokens) if not (t.known or t.near or t.guess)]
    around = [tokens[i] for i in unknown if _is_around(tokens[:i])]
    if around:
        index = _shipped() if vocabulary is shipped_vocabulary() else SettingIndex(vocabulary)
        for token in around:
            token.near = index.guess(token.text)


@cache
def _shipped() -> SettingIndex:
    return SettingIndex(shipped_vocabulary())


def _sorts(names: Iterable[str]) -> tuple[list[str], np.ndarray]:
    """Those of the names whose sort is known, and the unit vectors of their sorts (n, E)."""
    import numpy as np

    known = [(name, vector) for name in names if (vector := table().sort(name)) is not None]
    return [name for name, _ in known], np.stack([vector for _, vector in known])


def _is_around(before: Sequence[Token]) -> bool:
    """Whether what follows these tokens is said to be all around: "in a", "feels like the inside of an old"."""
    for token in reversed(before):
        if "place" in token.lists:
            return True
        if not (token.entry or token.color or token.adjective or "stop" in token.lists):
            return False
    return False
