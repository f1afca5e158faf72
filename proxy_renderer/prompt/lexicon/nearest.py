# SPDX-License-Identifier: Apache-2.0
"""Words that the vocabulary does not have fall to the nearest entry, with a confidence: a guess, and said to be one.

words.safetensors holds a small vector for every English word that may speak of a look; `train/text/words.py` makes it.
"""

from __future__ import annotations

from collections.abc import Iterable
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
SURE = 0.4
"""Confidence below which a word is left out rather than guessed."""

_NEAREST, _SHARPNESS = 8, 12.0  # words that vote for their entries, and how much more the nearer ones count
_ENDINGS = (
    "like", "ness", "iness", "ing", "ings", "ed", "ly", "ily", "y", "ic", "ical", "ia", "s", "es", "ish", "ment", "ity", "e",
    "er", "ier", "iest", "en", "ous", "al",
)  # fmt: skip
_DENIALS, _LACK = ("non", "anti", "un"), "less"
_SAME_SORT = 0.45  # cosine of two things that may stand for each other
_SHORTEST = 4  # letters of a stem


@dataclass(frozen=True)
class Guess:
    """What a word was taken for.

    Attributes:
        entry: Name of a vocabulary entry.
        near: The known word that it is nearest to.
        confidence: In [0, 1]: how near, and how much the nearest known words agree.
        place: Whether it is a place, and stands where the prompt says what is all around: what it describes is known.
    """

    entry: str
    near: str
    confidence: float
    place: bool = False


@dataclass(frozen=True)
class WordTable:
    """Words that may speak of a look, and others.

    Attributes:
        index: Word -> row.
        stems: Stem -> row; words known by heart come first.
        vectors: (N, D) unit vectors.
        kinds: (N,) indices into KINDS.
        common: Frequent English words that say nothing about looks.
        things: Names of things -> row of `sorts`.
        sorts: (M, E) unit vectors: things of the same sort are near each other.
    """

    index: dict[str, int]
    stems: dict[str, int]
    vectors: np.ndarray
    kinds: np.ndarray
    common: frozenset[str]
    things: dict[str, int]
    sorts: np.ndarray

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
        if row is not None or self.is_english(word) or word.startswith(_DENIALS):
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

    def same_sort(self, thing: str, names: Iterable[str]) -> str:
        """The name of the thing that is of the same sort, judged by last words; "" if none is, by far enough."""
        own = self.sort(thing)
        if own is None:
            return ""
        rows = [(self.sort(name), name) for name in names]
        near = max(((float(own @ sort), name) for sort, name in rows if sort is not None), default=(0.0, ""))
        return near[1] if near[0] > _SAME_SORT else ""

    def sort(self, name: str) -> np.ndarray | None:
        """Unit vector of the sort of a thing, by its last word; None where that is not known."""
        last = name.rpartition(" ")[2]
        row = self.things.get(last, self.things.get(last.removesuffix("s")))
        return None if row is None else self.sorts[row]


@cache
def table() -> WordTable:
    """The table that is shipped."""
    import numpy as np
    from safetensors import safe_open

    with safe_open(FILE, framework="numpy") as file:
        words, things, common = (file.metadata()[name].split("\n") for name in ("words", "things", "common"))
        tensors = {name: file.get_tensor(name) for name in ("vectors", "things", "kinds")}

    def directions(name: str) -> np.ndarray:
        vectors = tensors[name].astype(np.float32)
        return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-9)

    kinds = tensors["kinds"]
    stems: dict[str, int] = {}
    for i in np.argsort(kinds, kind="stable"):
        if " " not in words[i]:
            stems.setdefault(stem(words[i]), int(i))
    index = {word: i for i, word in enumerate(words)}
    sorts = {word: i for i, word in enumerate(things)}
    return WordTable(
        index, stems, directions("vectors"), kinds, frozenset(common), sorts, directions("things")
    )


def stem(word: str) -> str:
    """What is left of a word without its endings: "gloominess" and "gloomy" have the same stem."""
    shorter = True
    while shorter:
        fitting = [
            word.removesuffix(e) for e in _ENDINGS if word.endswith(e) and len(word) - len(e) >= _SHORTEST
        ]
        shorter = bool(fitting)
        word = min(fitting, key=len) if fitting else word
    if len(word) > _SHORTEST and word[-1] == word[-2]:  # "walnutty", "foggy"
        word = word[:-1]
    return word.removesuffix("i") if len(word) > _SHORTEST else word


def _denied(word: str) -> str:
    """What a word says is not there: "moonless", "unpolished"; "" for other words."""
    if word.endswith(_LACK):
        return word.removesuffix(_LACK) if len(word) > len(_LACK) + 2 else ""
    prefix = next((p for p in _DENIALS if word.startswith(p)), "")
    base = word.removeprefix(prefix)
    return stem(base) if prefix and base in table().index else ""


class Nearest:
    """The entries of a vocabulary as places in the table's space."""

    def __init__(self, vocabulary: Vocabulary) -> None:
        import numpy as np

        self._table = table()
        known = [(w, e, self._table.vector(w)) for w, e in vocabulary.synonyms.items()]
        self._known = [(word, entry) for word, entry, vector in known if vector is not None]
        self._places = np.stack([vector for _, _, vector in known if vector is not None])

    def guess(self, word: str) -> Guess | None:
        """The entry that a word is nearest to; None for words that say nothing about looks."""
        found = self.meant(word)
        if found is None or found[2] < SURE:
            return None
        entry, near, confidence = found
        return Guess(entry, near, round(confidence, 2))

    def meant(self, word: str) -> tuple[str, str, float] | None:
        """Entry, nearest known word and confidence of a word; None where it has no vector."""
        import numpy as np

        likeness = self._likeness(word)
        if likeness is None:
            return None
        best = np.argsort(-likeness)[:_NEAREST]
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
        if denied := _denied(word):  # "moonless" is no moonlight
            likeness[[i for i, (known, _) in enumerate(self._known) if known.startswith(denied)]] = -1.0
        return likeness


@cache
def _shipped() -> Nearest:
    return Nearest(shipped_vocabulary())


def nearest(vocabulary: Vocabulary) -> Nearest:
    """The nearest-entry search of a vocabulary; the shipped one's is made once."""
    return _shipped() if vocabulary is shipped_vocabulary() else Nearest(vocabulary)
