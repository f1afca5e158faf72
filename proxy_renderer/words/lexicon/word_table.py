# SPDX-License-Identifier: Apache-2.0
"""Words as small vectors: words.safetensors has one for every English word that may speak of a look.

`lab/train/text/words.py` makes it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from .vocabulary import Vocabulary, shipped_vocabulary

if TYPE_CHECKING:
    import numpy as np

FILE = Path(__file__).with_name("words.safetensors")
KINDS = ("known", "adjective", "noun")
"""How a word of the table may speak of a look: by heart, before any noun, or as a matter ("made of tinfoil")."""

_SHORTEST, _SHORTEST_LACKED = 4, 2  # letters of a stem; what is not there has more


@dataclass(frozen=True)
class WordTable:
    """Words that may speak of a look, and others.

    Attributes:
        index: Word -> row.
        stems: Stem -> row; words known by heart come first.
        vectors: (N, D) unit vectors.
        kinds: (N,) indices into KINDS.
        common: Frequent English words that say nothing about looks.
    """

    index: dict[str, int]
    stems: dict[str, int]
    vectors: np.ndarray
    kinds: np.ndarray
    common: frozenset[str]

    def is_english(self, word: str) -> bool:
        """Whether it is a word at all."""
        return any(w in self.common or w in self.index for w in (word, word.removesuffix("s")))

    def find(self, word: str) -> int | None:
        """The row of a word, or of one with the same stem: "soaking" is found as "soaked"."""
        if word in self.index:
            return self.index[word]
        short = stem(word)
        row = self.stems.get(short)
        # Of words that say something else ("robot"), only derived ones may be meant as known ones ("soaking").
        taken = row is not None and self.is_english(word) and (word == short or self.kinds[row] > 0)
        return None if taken else row

    def rows(self, word: str) -> list[int]:
        """Rows that make up a word: its own, or those of a compound's two parts ("thundercloud")."""
        row = self.find(word)
        if row is not None or self.is_english(word) or word.startswith(_denials()):
            return [] if row is None else [row]
        for cut in sorted(range(3, len(word) - 2), key=lambda c: abs(2 * c - len(word))):
            parts = word[:cut], word[cut:]
            found = [r for r in map(self.find, parts) if r is not None]
            if found and all(map(self.is_english, parts)):
                return found
        return []

    def vector(self, phrase: str) -> np.ndarray | None:
        """Unit vector of a word or phrase; the mean of its words where the phrase as a whole has none."""
        import numpy as np

        if phrase in self.index:
            return self.vectors[self.index[phrase]]
        rows = [row for word in phrase.split() for row in self.rows(word)]
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
    """What is left of a word without its endings: "gloominess" and "gloomy" have the same stem."""
    endings = shipped_vocabulary().made(_endings)
    while len(word) > _SHORTEST and word.endswith(endings):
        shorter = {base for e in endings if _SHORTEST <= len(base := word.removesuffix(e)) < len(word)}
        if not shorter:
            break
        word = min(shorter, key=len)
    if len(word) > _SHORTEST and word[-1] == word[-2]:  # "walnutty", "foggy"
        word = word[:-1]
    return word.removesuffix("i") if len(word) > _SHORTEST else word


def _endings(vocabulary: Vocabulary) -> tuple[str, ...]:
    """What ends words without a change of what they say of looks."""
    return tuple(sorted(vocabulary.words["endings"]))


def denied(word: str) -> str:
    """What a word says is not there: "moonless", "unpolished"; "" for other words."""
    for ending in shipped_vocabulary().words["lacks"]:
        if len(base := word.removesuffix(ending)) < len(word):
            return base if len(base) > _SHORTEST_LACKED else ""
    bases = (word.removeprefix(prefix) for prefix in _denials() if word.startswith(prefix))
    return next((stem(base) for base in bases if base in table().index), "")


def _denials() -> tuple[str, ...]:
    """What words begin with that say what is not there."""
    return tuple(shipped_vocabulary().words["denials"])
