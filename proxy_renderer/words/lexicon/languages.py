# SPDX-License-Identifier: Apache-2.0
"""Spelling, names of things in all languages (things.toml), and the lexicons of languages; the head of german.toml explains the format."""

import re
import tomllib
import unicodedata
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache
from itertools import product
from pathlib import Path

from .entries import normalize
from .vocabulary import shipped_vocabulary
from .word_table import table

_LETTERS = str.maketrans({"ß": "ss", "ł": "l", "ø": "o", "đ": "d", "æ": "ae", "œ": "oe"})
"""Letters that do not consist of a plain letter and an accent -> the plain letters that stand for them."""
_EAST_ASIAN = ("\u2e80", "\uf900")  # the first character of those scripts, and the one after their last
_SIBILANTS = ("sses", "nses", "xes", "ches", "shes")
TABLES = ("grammar", "behind", "looks", "things", "shades")  # if a wording is in several, the first counts
_SHORTEST = 4  # characters of a word that may be a part of a compound ("Obermaterial")
_CACHED = 16_384  # words whose bases and senses are cached
Wording = tuple[str, ...]  # word by word
Meaning = tuple[str, str]  # in English, "" for what English leaves out; and its table, one of `TABLES`


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


@cache
def _plurals() -> dict[str, str]:
    return dict(pair.split("/") for pair in name_words("plurals"))


def singular(word: str) -> str:
    """A word without the ending of an English plural."""
    if word in _plurals():
        return _plurals()[word]
    if word.endswith("ies") and len(word) > 4:
        return word[:-3] + "y"
    if word.endswith(_SIBILANTS):
        return word[:-2]
    return word[:-1] if word.endswith("s") and not word.endswith("ss") and len(word) > 3 else word


def any_of(phrases: Iterable[str]) -> str:
    """A pattern of any of the phrases, the longest that fits."""
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
        """All words in every form that `endings` allows; for languages with spaces they are many."""
        ends = ((w.removesuffix(base), t) for w in self.words for t, base in self.endings if w.endswith(base))
        return self.words | {stem + typed for stem, typed in ends if stem}

    def find(self, words: Sequence[str]) -> tuple[Wording, Meaning] | None:
        """The wording that words are a form of, and its meaning; None where they are none."""
        each = [_bases(self, folded(word)) for word in words]
        wording = next((wording for wording in product(*each) if wording in self.meanings), None)
        return (wording, self.meanings[wording]) if wording is not None else None


@lru_cache(_CACHED)
def _bases(lexicon: LanguageLexicon, word: str) -> tuple[str, ...]:
    """The words of a lexicon that one may be a form of, itself first."""
    ends = ((t, base) for t, base in lexicon.endings if word.endswith(t) and word != t)
    stems = (word.removesuffix(typed) + base for typed, base in ends)
    return tuple(dict.fromkeys(known for known in (word, *stems) if known in lexicon.words))


@cache
def lexicons() -> tuple[LanguageLexicon, ...]:
    """The lexicons that are shipped."""
    return tuple(map(load, sorted(Path(__file__).parents[1].joinpath("languages").glob("*.toml"))))


def load(path: Path) -> LanguageLexicon:
    """The lexicon of a file."""
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
    """What a word or a short phrase may mean, in a prompt or in a name: rows of things.toml, and its own singular."""
    rows, plain = thing_words(), singular(folded(word))
    found = rows.get(plain, frozenset())
    if not found and not word.isascii():
        found = frozenset().union(*(rows[part] for part in _spaceless() if part in plain))
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


@cache
def _spaceless() -> tuple[str, ...]:
    """Words that a name without spaces may contain, the longest first."""
    return tuple(sorted((word for word in thing_words() if not word.isascii()), key=len, reverse=True))
