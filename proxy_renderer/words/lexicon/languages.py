# SPDX-License-Identifier: Apache-2.0
"""Words beyond the vocabulary: lexicons of other languages, names of things (things.toml), English words as vectors.

The head of german.toml explains the lexicons; `lab/train/text/words.py` makes the vectors (words.safetensors).
"""

from __future__ import annotations

import re
import tomllib
import unicodedata
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

from .entries import normalize
from .vocabulary import Vocabulary, hour_phrases, shipped_vocabulary

if TYPE_CHECKING:
    import numpy as np

FILE = Path(__file__).with_name("words.safetensors")
KINDS = ("known", "adjective", "noun")
"""Kinds of words in `WordTable`: look words, adjectives that may be look words, and nouns that may be substances."""
_SHORTEST_STEM = 4  # characters of a stem
_MAY_BE = 0.56  # least cosine with a known look word, for a word that may be a look word
_LETTERS = str.maketrans({"ß": "ss", "ł": "l", "ø": "o", "đ": "d", "æ": "ae", "œ": "oe"})
"""Letters that do not consist of a plain letter and an accent -> the plain letters that stand for them."""
_EAST_ASIAN = ("\u2e80", "\uf900")  # the first character of those scripts, and the one after their last
_SIBILANTS = ("sses", "nses", "xes", "ches", "shes")
TABLES = ("grammar", "behind", "looks", "things", "shades")  # if a wording is in several, the first counts
_SHORTEST = 4  # characters of a word that may be a part of a compound ("Obermaterial")
_CACHED = 16_384  # words whose bases and senses are cached
Wording = tuple[str, ...]  # word by word
Meaning = tuple[str, str]  # English wording, "" for what English leaves out; and its table, one of `TABLES`


def folded(word: str) -> str:
    """A word in lower case and without accents."""
    if word.isascii():
        return word.lower()
    if _EAST_ASIAN[0] <= min(word) and max(word) < _EAST_ASIAN[1]:  # no case, no accents
        return unicodedata.normalize("NFC", word)
    letters = unicodedata.normalize("NFKD", word.lower().translate(_LETTERS))
    return unicodedata.normalize("NFC", "".join(c for c in letters if not 0x300 <= ord(c) < 0x370))


@cache
def name_words(kind: str) -> frozenset[str]:
    """Words of one row of names.toml: "pipeline", "counted", "primitives", "order", "limbs", "details" or "plurals"."""
    rows = tomllib.loads(Path(__file__).with_name("names.toml").read_text("utf-8"))
    return frozenset(rows[kind].split())


@lru_cache(_CACHED)
def singular(word: str) -> str:
    """A word without the ending of an English plural."""
    irregular = dict(pair.split("/") for pair in name_words("plurals"))
    if word in irregular:
        return irregular[word]
    if word.endswith("ies") and len(word) > 4:
        return word[:-3] + "y"
    if word.endswith(_SIBILANTS):
        return word[:-2]
    return word[:-1] if word.endswith("s") and not word.endswith("ss") and len(word) > 3 else word


def any_of(phrases: Iterable[str]) -> str:
    """A regular expression for any of the phrases; of several that fit, the longest one matches."""
    return "(?:" + "|".join(map(re.escape, sorted(phrases, key=len, reverse=True))) + ")"


@dataclass(frozen=True, eq=False)
class LanguageLexicon:
    """The words of a language, in lower case and without accents, as many type them."""

    name: str  # in English
    spaces: bool  # whether words are written apart
    endings: tuple[tuple[str, str], ...]  # pairs: ending as typed, ending in the lexicon
    meanings: dict[Wording, Meaning]
    looks: dict[str, list[str]]  # english look word -> its wordings in the language
    things: dict[str, list[str]]  # english name of a thing -> its names in the language

    @cached_property
    def words(self) -> frozenset[str]:
        """All words of its wordings."""
        return frozenset(word for wording in self.meanings for word in wording)

    @cached_property
    def forms(self) -> frozenset[str]:
        """All words of its wordings in every form that `endings` allows; very many for languages with spaces."""
        ends = ((w.removesuffix(base), t) for w in self.words for t, base in self.endings if w.endswith(base))
        return self.words | {stem + typed for stem, typed in ends if stem}

    def find(self, words: Sequence[str]) -> tuple[Wording, Meaning] | None:
        """The wording that `words` are an inflected form of, and its meaning; None if there is none."""
        each = [_bases(self, folded(word)) for word in words]
        wording = next((wording for wording in product(*each) if wording in self.meanings), None)
        return (wording, self.meanings[wording]) if wording is not None else None


@lru_cache(_CACHED)
def _bases(lexicon: LanguageLexicon, word: str) -> tuple[str, ...]:
    """The words of a lexicon of which `word` may be an inflected form, `word` itself first."""
    ends = ((t, base) for t, base in lexicon.endings if word.endswith(t) and word != t)
    stems = (word.removesuffix(typed) + base for typed, base in ends)
    return tuple(dict.fromkeys(known for known in (word, *stems) if known in lexicon.words))


@cache
def lexicons() -> tuple[LanguageLexicon, ...]:
    """The lexicons of all languages in words/languages."""
    return tuple(map(load, sorted(Path(__file__).parents[1].joinpath("languages").glob("*.toml"))))


def load(path: Path) -> LanguageLexicon:
    """The lexicon in a file such as german.toml."""
    content = tomllib.loads(path.read_text("utf-8"))
    rows = {name: {e: listed(row) for e, row in content.get(name, {}).items()} for name in TABLES}
    meanings: dict[Wording, Meaning] = {}
    every = ((name, e, wording) for name in TABLES for e in rows[name] for wording in rows[name][e])
    for name, english, wording in every:
        words = folded(wording).replace("’", "'").replace("'", "' ").replace("-", " ").split()
        meanings.setdefault(tuple(words), (english, name))
    own = content["language"]
    pairs = (pair.partition("/") for pair in listed(own.get("endings", "")))
    endings = tuple((typed, base) for typed, _, base in pairs)
    return LanguageLexicon(own["name"], own["spaces"], endings, meanings, rows["looks"], rows["things"])


def listed(row: str) -> list[str]:
    """The words of a row, which are separated by commas."""
    return [part.strip() for part in row.split(",") if part.strip()]


@lru_cache(_CACHED)
def senses(word: str) -> frozenset[str]:
    """Meanings of a word or short phrase of a prompt or name: the rows of things.toml with it, and its own singular."""
    rows, plain = thing_words(), singular(folded(word))
    found = rows.get(plain, frozenset())
    if not found and not word.isascii():
        found = frozenset().union(*(names for part, names in rows.items() if not part.isascii() and part in plain))
    if not found and not table().is_english(plain.rpartition(" ")[2]):  # "black" does not end in "Lack"
        ends = (plain[start:] for start in range(len(plain) - _SHORTEST + 1))
        found = next((rows[end] for end in ends if end in rows), found)
    return found | {plain}


@cache
def thing_words() -> dict[str, frozenset[str]]:
    """Word for a thing -> the rows of things.toml that it is in, each named by its first word; other languages, too."""
    tables = tomllib.loads(Path(__file__).with_name("things.toml").read_text("utf-8"))
    named: dict[str, str] = tables["things"] | tables["more"]
    kinds = shipped_vocabulary().nouns  # "light" is any light, not the one that is called so
    every = [(name, listed(others)) for name, others in named.items()]
    for lexicon in lexicons():
        every += [(name, words) for name, words in lexicon.looks.items() if name in named]  # "Leder"
        every += [(n, words) for n, words in lexicon.things.items() if n in named or n not in kinds]
    rows: dict[str, set[str]] = defaultdict(set)
    for name, words in every:
        for word in (name, *words):
            rows[singular(folded(normalize(word)))].add(name)
    return {word: frozenset(names) for word, names in rows.items()}


# English words as vectors


@dataclass(frozen=True)
class WordTable:
    """Vectors of words that are or may be look words, and a list of other English words."""

    index: dict[str, int]  # word -> row
    stems: dict[str, int]  # stem -> row; known look words come first
    vectors: np.ndarray  # (N, D) unit vectors
    kinds: np.ndarray  # (N,) indices into KINDS
    common: frozenset[str]  # frequent English words that say nothing about looks

    def is_english(self, word: str) -> bool:
        """True if the table has a word, or the word without a final "s", as a look word or another English word."""
        return any(w in self.common or w in self.index for w in (word, word.removesuffix("s")))

    def find(self, word: str) -> int | None:
        """The row of a word, or of one with the same stem ("soaked" for "soaking"); None if there is none."""
        if word in self.index:
            return self.index[word]
        short = stem(word)
        row = self.stems.get(short)
        # An English word of its own meaning ("robot") is not found by its stem; a derived one ("soaking") may be.
        taken = row is not None and self.is_english(word) and (word == short or self.kinds[row] > 0)
        return None if taken else row

    def vector(self, phrase: str) -> np.ndarray | None:
        """Unit vector, (D,), of a word or phrase, or of the mean of a phrase's words; None if no word has a vector."""
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
    """The shipped word table, read from words.safetensors."""
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
    while len(word) > _SHORTEST_STEM and word.endswith(endings):
        shorter = {base for e in endings if _SHORTEST_STEM <= len(base := word.removesuffix(e)) < len(word)}
        if not shorter:
            break
        word = min(shorter, key=len)
    if len(word) > _SHORTEST_STEM and word[-1] == word[-2]:  # "walnutty", "foggy"
        word = word[:-1]
    return word.removesuffix("i") if len(word) > _SHORTEST_STEM else word


class Nearest:
    """Finds known words that an unknown word may stand for, by meaning: offered for a click, never used automatically.

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
        """True if an unknown word may be a look word by its vector, so that known ones are offered in its place."""
        vector = self._table.vector(word)
        return vector is not None and float((self._places @ vector).max()) >= _MAY_BE

    def choices(self, word: str, count: int) -> list[str]:
        """Up to `count` known words near to `word`, each of another entry, the nearest first; [] without a vector."""
        vector = self._table.vector(word)
        if vector is None:
            return []
        chosen: dict[str, str] = {}
        for i in (-(self._places @ vector)).argsort():
            known, entry = self._known[i]
            chosen.setdefault(entry, known)
        return list(chosen.values())[:count]
