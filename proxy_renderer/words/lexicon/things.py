# SPDX-License-Identifier: Apache-2.0
"""What things are called besides: synonyms (things.toml), and names in the languages that scenes are named in."""

from __future__ import annotations

import tomllib
from collections import defaultdict
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path

from .entries import normalize
from .languages import lexicons
from .spelling import folded, singular
from .vocabulary import shipped_vocabulary
from .word_table import table

_SHORTEST = 4  # letters of a word that may be a part of a compound ("Obermaterial")
_WORDS = 16_384  # words whose senses are remembered


@dataclass(frozen=True)
class ThingWords:
    """Names of the same thing.

    Attributes:
        rows: Word -> the rows that it is in, each named by its first word.
        joined: Of those, the words that a name without spaces may contain, the longest first.
    """

    rows: dict[str, frozenset[str]]
    joined: tuple[str, ...]

    def senses(self, word: str) -> frozenset[str]:
        """What a word may name, itself included.

        Args:
            word: One word, or a few; of a prompt, or of a name in a scene.
        """
        plain = singular(folded(word))
        found = self.rows.get(plain, frozenset())
        if not found and not word.isascii():
            parts = [part for part in self.joined if part in plain and not part.isascii()]
            found = frozenset().union(*(self.rows[part] for part in parts))
        if not found and not table().is_english(plain.rpartition(" ")[2]):  # "black" does not end in "Lack"
            ends = (plain[start:] for start in range(len(plain) - _SHORTEST + 1))
            found = next((self.rows[end] for end in ends if end in self.rows), found)
        return found | {plain}


@lru_cache(_WORDS)
def senses(word: str) -> frozenset[str]:
    """What a word may name by the words that are shipped, see `ThingWords.senses`."""
    return thing_words().senses(word)


@cache
def english_things() -> frozenset[str]:
    """Names of things in English that are no places, by the words that are shipped."""
    is_english = table().is_english
    every = ((name, *others.split(", ")) for name, others in _tables()["things"].items())
    return frozenset(
        normalize(word)
        for name, *others in every
        for word in (name, *(each for each in others if all(map(is_english, each.split()))))
    )


@cache
def _tables() -> dict[str, dict[str, str]]:
    tables: dict[str, dict[str, str]] = tomllib.loads(
        Path(__file__).with_name("things.toml").read_text("utf-8")
    )
    return tables


@cache
def thing_words() -> ThingWords:
    """The words that are shipped."""
    named = _tables()["things"] | _tables()["more"]
    rows: dict[str, set[str]] = defaultdict(set)
    for name, others in named.items():
        for word in (name, *others.split(",")):
            rows[singular(folded(normalize(word)))].add(name)
    kinds = shipped_vocabulary().nouns  # "light" is any light, not the one that is called so
    for lexicon in lexicons():
        matter = [(name, words) for name, words in lexicon.looks.items() if name in named]  # "Leder"
        things = [
            (name, words) for name, words in lexicon.things.items() if name in named or name not in kinds
        ]
        for name, words in (*matter, *things):
            for word in (name, *words):
                rows[singular(folded(normalize(word)))].add(name)
    frozen = {word: frozenset(names) for word, names in rows.items()}
    return ThingWords(frozen, tuple(sorted(frozen, key=len, reverse=True)))
