# SPDX-License-Identifier: Apache-2.0
"""What things are called besides: synonyms, and the languages that scenes are named in; see the head of things.toml."""

from __future__ import annotations

import tomllib
import unicodedata
from collections import defaultdict
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from .vocabulary import normalize

_SHORTEST = 4  # letters of a word that may be a part of a compound ("Obermaterial")
_SIBILANTS = ("ses", "xes", "ches", "shes")


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
        if not found:
            ends = [w for w in self.joined if plain.endswith(w) and len(w) >= _SHORTEST]
            found = self.rows[ends[0]] if ends else found
        return found | {plain}


def folded(word: str) -> str:
    """A word in lower case and without accents."""
    parts = unicodedata.normalize("NFKD", word.lower().replace("ß", "ss"))
    return unicodedata.normalize("NFC", "".join(c for c in parts if not 0x300 <= ord(c) < 0x370))


def singular(word: str) -> str:
    """A word without the ending of an English plural."""
    if word.endswith("ies") and len(word) > 4:
        return word[:-3] + "y"
    if word.endswith(_SIBILANTS):
        return word[:-2]
    return word[:-1] if word.endswith("s") and not word.endswith("ss") and len(word) > 3 else word


@cache
def senses(word: str) -> frozenset[str]:
    """What a word may name by the words that are shipped, see `ThingWords.senses`."""
    return thing_words().senses(word)


@cache
def thing_words() -> ThingWords:
    """The words that are shipped."""
    table = tomllib.loads(Path(__file__).with_name("things.toml").read_text("utf-8"))["things"]
    rows: dict[str, set[str]] = defaultdict(set)
    for name, others in table.items():
        for word in (name, *others.split(",")):
            rows[singular(folded(normalize(word)))].add(name)
    frozen = {word: frozenset(names) for word, names in rows.items()}
    return ThingWords(frozen, tuple(sorted(frozen, key=len, reverse=True)))
