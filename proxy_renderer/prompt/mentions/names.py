# SPDX-License-Identifier: Apache-2.0
"""How well words of a prompt fit the names in a scene."""

from __future__ import annotations

import re
from collections.abc import Iterable
from difflib import SequenceMatcher, get_close_matches
from functools import cache

from ..lexicon.entries import normalize
from ..lexicon.spelling import folded, singular
from ..lexicon.things import senses, thing_words
from ..lexicon.vocabulary import shipped_vocabulary
from ..lexicon.word_table import table
from ..names import name_words

FITS = (
    "exact", "all", "last", "whole", "synonym", "part", "part's synonym", "detail's whole", "alike", "misspelled",
)  # fmt: skip
"""How words may fit a name, the surest way first."""
_ALIKE = 0.5  # cosine of things that may stand for each other
_MISSPELLED = 0.8  # share of letters that are right
_SURFACE = ("material", "finish")
_SHORTEST = 4  # letters of a word that may be misspelled


@cache
def parts(name: str) -> tuple[str, ...]:
    """What a name is made of: "SM_WoodTable.001" -> ("wood", "table"); a letter comes first, as in ("l", "lamp")."""
    spaced = re.sub(r"(?<=[a-z0-9])(?=[A-Z])|[\W_]|\d+", " ", name)
    words = [singular(folded(w)) for w in normalize(spaced).split()]
    letters = [w for w in words if w.isascii() and len(w) == 1]
    words = [w for w in words if len(w) > 1 or not w.isascii()]
    while len(words) > 1 and words[-1] in name_words("counted"):
        words.pop()
    return (*letters, *([w for w in words if w not in name_words("pipeline")] or words))


@cache
def fit(words: tuple[str, ...], name: tuple[str, ...]) -> str:
    """How words fit a name.

    Args:
        words: Of the prompt, as `parts` gives them.
        name: Parts of the name.

    Returns:
        One of `FITS`; "" if they do not.
    """
    if not (words and name):
        return ""
    joined = "".join(words)
    if words in (name, tuple(n for n in name if len(n) > 1)) or joined == "".join(name):
        return "exact"
    if len(words) > 1:
        meant = all(w in name or any(_means(w, n, words) for n in name) for w in words)
        return "all" if meant or joined in name else ""
    (word,) = words
    head = _head(name)
    if word in (name[-1], head[-1], "".join(name[-2:])):
        return "last"
    if word in name:
        return _as_part(name, "part")
    mine = senses(word)
    if mine & (senses(name[-1]) | senses(head[-1]) | senses(" ".join(name))):
        return "synonym"
    return _as_part(name, "part's synonym") if any(mine & senses(n) for n in name[:-1]) else ""


def _means(word: str, part: str, words: tuple[str, ...]) -> bool:
    """Whether a word stands for a part of a name; not "rubber" for "tire" in "rubber tire", where it is a look."""
    said = _is_of_surfaces(word) and any(senses(w) & senses(part) for w in words if w != word)
    return bool(senses(word) & senses(part)) and not said


def _head(name: tuple[str, ...]) -> tuple[str, ...]:
    """A name without what it says of the look at its end: "armor" of "armor steel", "frame" of "frame black"."""
    end = len(name)
    while end > 1 and _is_of_surfaces(name[end - 1]):
        end -= 1
    return name if _is_of_surfaces(name[end - 1]) else name[:end]


@cache
def _is_of_surfaces(word: str) -> bool:
    """Whether a word of a name says what a thing is made of, or its color or finish."""
    vocabulary = shipped_vocabulary()
    return word in vocabulary.colors or vocabulary.slot(word) in _SURFACE


def _as_part(name: tuple[str, ...], otherwise: str) -> str:
    """Of "car" in "car shell" and in "car wheel": a limb stands for the whole, a detail does not."""
    if name[-1] in name_words("details"):
        return "detail's whole"
    return "whole" if name[-1] in name_words("limbs") and otherwise == "part" else otherwise


@cache
def guessed_fit(word: str, name: tuple[str, ...]) -> str:
    """How a word that fits no name may still mean one: as a thing of the same sort, or misspelled."""
    if not name:
        return ""
    if not table().is_english(word) and len(word) >= _SHORTEST:
        near = max(SequenceMatcher(None, word, part).ratio() for part in name)
        meant = _corrected(word)
        if near >= _MISSPELLED or (meant and senses(meant) & (senses(name[-1]) | senses(_head(name)[-1]))):
            return "misspelled"
    return "alike" if table().likeness(word, name[-1]) > _ALIKE else ""


@cache
def _corrected(word: str) -> str:
    """The known thing that a misspelled word is nearest to; "" if none is near."""
    known = [w for w in thing_words().rows if w[0] == word[0]]
    return next(iter(get_close_matches(word, known, 1, _MISSPELLED)), "")


def best(found: Iterable[str]) -> str:
    """The surest of several ways to fit; "" for none."""
    return min((f for f in found if f), key=FITS.index, default="")
