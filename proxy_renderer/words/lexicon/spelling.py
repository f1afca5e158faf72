# SPDX-License-Identifier: Apache-2.0
"""Words as they are compared and looked for: without accents, without the ending of a plural, one of many."""

from __future__ import annotations

import re
import tomllib
import unicodedata
from collections.abc import Iterable
from functools import cache
from pathlib import Path

_LETTERS = str.maketrans({"ß": "ss", "ł": "l", "ø": "o", "đ": "d", "æ": "ae", "œ": "oe"})
"""Letters that are no others with an accent -> how they are written without them."""
_EAST_ASIAN = ("\u2e80", "\uf900")
"""The first letter of those scripts, and what follows their last one."""
_SIBILANTS = ("sses", "nses", "xes", "ches", "shes")


def folded(word: str) -> str:
    """A word in lower case and without accents."""
    if word.isascii():
        return word.lower()
    if (
        _EAST_ASIAN[0] <= min(word) and max(word) < _EAST_ASIAN[1]
    ):  # most of the lexicons: no case, no accents
        return unicodedata.normalize("NFC", word)
    parts = unicodedata.normalize("NFKD", word.lower().translate(_LETTERS))
    return unicodedata.normalize("NFC", "".join(c for c in parts if not 0x300 <= ord(c) < 0x370))


def as_spelled(word: str) -> str:
    """A word in lower case with its accents, each letter one character."""
    return unicodedata.normalize("NFC", word.lower()).replace("’", "'")


def singular(word: str) -> str:
    """A word without the ending of an English plural."""
    if word in _plurals():
        return _plurals()[word]
    if word.endswith("ies") and len(word) > 4:
        return word[:-3] + "y"
    if word.endswith(_SIBILANTS):
        return word[:-2]
    return word[:-1] if word.endswith("s") and not word.endswith("ss") and len(word) > 3 else word


@cache
def _plurals() -> dict[str, str]:
    """Plurals that no ending tells -> the word for one."""
    rows = tomllib.loads(Path(__file__).with_name("names.toml").read_text("utf-8"))
    return dict(pair.split("/") for pair in rows["plurals"].split())


def any_of(phrases: Iterable[str]) -> str:
    """A pattern of any of the phrases, the longest that fits."""
    return "(?:" + "|".join(map(re.escape, sorted(phrases, key=len, reverse=True))) + ")"
