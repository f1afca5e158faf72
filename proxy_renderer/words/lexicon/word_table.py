# SPDX-License-Identifier: Apache-2.0
"""Words as small vectors (words.safetensors, made by `lab/train/text/words.py`), and the known look words nearest to others."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from .vocabulary import Vocabulary, hour_phrases, shipped_vocabulary

if TYPE_CHECKING:
    import numpy as np

FILE = Path(__file__).with_name("words.safetensors")
KINDS = ("known", "adjective", "noun")
"""Kinds of words of the table: known look words, adjectives that may be look words, and nouns that may be substances."""

_SHORTEST = 4  # characters of a stem
_MAY_BE = 0.56  # least cosine with a known look word, for a word that may be a look word


@dataclass(frozen=True)
class WordTable:
    """Vectors of words that are or may be look words, and a list of other English words."""

    index: dict[str, int]  # word -> row
    stems: dict[str, int]  # stem -> row; known look words come first
    vectors: np.ndarray  # (N, D) unit vectors
    kinds: np.ndarray  # (N,) indices into KINDS
    common: frozenset[str]  # frequent English words that say nothing about looks

    def is_english(self, word: str) -> bool:
        """True if the table has a word, or its singular."""
        return any(w in self.common or w in self.index for w in (word, word.removesuffix("s")))

    def find(self, word: str) -> int | None:
        """The row of a word, or of one with the same stem: "soaking" is found as "soaked"."""
        if word in self.index:
            return self.index[word]
        short = stem(word)
        row = self.stems.get(short)
        # An English word of its own meaning ("robot") is not found by its stem; a derived one ("soaking") may be.
        taken = row is not None and self.is_english(word) and (word == short or self.kinds[row] > 0)
        return None if taken else row

    def vector(self, phrase: str) -> np.ndarray | None:
        """Unit vector of a word or phrase; the mean of its words where the phrase as a whole has none."""
        import numpy as np

        if phrase in self.index:
            return self.vectors[self.index[phrase]]
        rows = [row for word in phrase.split() if (row := self.find(word)) is not None]
        if not rows:
            return None
        mean = self.vectors[rows].mean(0)
        return mean / max(float(np.linalg.norm(mean)), 1e-9)


@cache
def table() -> WordTable:
    """The table that is shipped."""
    import numpy as np
    from safetensors import safe_open

    with safe_open(FILE, framework="numpy") as file:
        words, common = (file.metadata()[name].split("\n") for name in ("words", "common"))
        raw, kinds = file.get_tensor("vectors").astype(np.float32), file.get_tensor("kinds")
    vectors = raw / np.maximum(np.linalg.norm(raw, axis=1, keepdims=True), 1e-9)
    stems: dict[str, int] = {}
    for i in np.argsort(kinds, kind="stable"):
        if " " not in words[i]:
            stems.setdefault(stem(words[i]), int(i))
    index = {word: i for i, word in enumerate(words)}
    return WordTable(index, stems, vectors, kinds, frozenset(common))


def stem(word: str) -> str:
    """A word without its endings: "gloominess" and "gloomy" have the same stem."""
    endings = tuple(sorted(shipped_vocabulary().words["endings"]))
    while len(word) > _SHORTEST and word.endswith(endings):
        shorter = {base for e in endings if _SHORTEST <= len(base := word.removesuffix(e)) < len(word)}
        if not shorter:
            break
        word = min(shorter, key=len)
    if len(word) > _SHORTEST and word[-1] == word[-2]:  # "walnutty", "foggy"
        word = word[:-1]
    return word.removesuffix("i") if len(word) > _SHORTEST else word


class Nearest:
    """Known words that an unknown word may stand for, the nearest first: offered for a click, never used automatically.

    A guess by meaning is right too rarely; only spelling is corrected without asking, see `lexer`.
    """

    def __init__(self, vocabulary: Vocabulary) -> None:
        import numpy as np

        self._table = table()
        # no phrases such as "just after sunrise", whose vectors say nothing about single words
        words = {w: e for w, e in vocabulary.synonyms.items() if w not in hour_phrases()}
        known = [(w, e, self._table.vector(w)) for w, e in words.items()]
        self._known = [(word, entry) for word, entry, vector in known if vector is not None]
        self._places = np.stack([vector for _, _, vector in known if vector is not None])

    def may_be_a_look(self, word: str) -> bool:
        """True if an unknown word may speak of a look, so that known ones are offered in its place."""
        vector = self._table.vector(word)
        return vector is not None and float((self._places @ vector).max()) >= _MAY_BE

    def choices(self, word: str, count: int) -> list[str]:
        """Known words that a word may be taken for, each of another entry, the nearest first; none where it has no vector."""
        vector = self._table.vector(word)
        if vector is None:
            return []
        chosen: dict[str, str] = {}
        for i in (-(self._places @ vector)).argsort():
            known, entry = self._known[i]
            chosen.setdefault(entry, known)
        return list(chosen.values())[:count]
