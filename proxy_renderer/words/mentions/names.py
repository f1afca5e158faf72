# SPDX-License-Identifier: Apache-2.0
"""How well words of a prompt fit the names in a scene."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import SequenceMatcher, get_close_matches
from functools import lru_cache

from ..lexicon.spelling import folded, singular
from ..lexicon.things import english_things, senses, thing_words
from ..lexicon.vocabulary import Vocabulary
from ..lexicon.word_table import table
from ..names import name_words, spaced

FITS = (
    "exact", "all", "last", "whole", "synonym", "part", "part's synonym", "detail's whole", "misspelled",
)  # fmt: skip
"""How words may fit a name, the surest way first."""
_MISSPELLED = 0.8  # share of letters that are right
_SURFACE = ("material", "finish")
_PLACES = ("setting", "mood")
_SHORTEST = 4  # letters of a word that may be misspelled
_NAMES, _WORDS = 16_384, 1024  # names of scenes, and words of prompts, that are remembered


@lru_cache(_NAMES)
def parts(name: str) -> tuple[str, ...]:
    """What a name is made of: "SM_WoodTable.001" -> ("wood", "table"); a letter comes first, as in ("l", "lamp")."""
    every = [singular(folded(w)) for w in spaced(name)]
    letters = [w for w in every if w.isascii() and len(w) == 1]
    words = [w for w in every if w not in letters]
    while len(words) > 1 and words[-1] in name_words("counted"):
        words.pop()
    return (*letters, *([w for w in words if w not in name_words("pipeline")] or words))


def fit(words: tuple[str, ...], name: tuple[str, ...], vocabulary: Vocabulary) -> str:
    """How words fit a name.

    Args:
        words: Of the prompt, as `parts` gives them.
        vocabulary: Says which words of a name are about its surface.

    Returns:
        One of `FITS`; "" if they do not.
    """
    if not (words and name):
        return ""
    joined = "".join(words)
    if words in (name, tuple(n for n in name if len(n) > 1)) or joined == "".join(name):
        return "exact"
    if len(words) > 1:
        meant = all(w in name or any(_means(w, n, vocabulary) for n in name) for w in words)
        return "all" if meant or joined in name else ""
    (word,) = words
    mine, ends = senses(word), {name[-1], _head(name, vocabulary)[-1]}
    ways = (
        ("last", word in ends or word == "".join(name[-2:])),
        (_as_part(word, name, "part", vocabulary), word in name),
        ("synonym", _is_one_of(mine, (*ends, " ".join(name)))),
        (_as_part(word, name, "part's synonym", vocabulary), _is_one_of(mine, name[:-1])),
    )
    return next((way for way, holds in ways if holds), "")


def _is_one_of(mine: frozenset[str], others: Iterable[str]) -> bool:
    """Whether what a word may name is what one of other words may name."""
    return any(mine & senses(other) for other in others)


def _means(word: str, part: str, vocabulary: Vocabulary) -> bool:
    """Whether a word stands for a part of a name; a look only for itself: "rubber tire" is no "tire", "oak floor" no "floor wood"."""
    return bool(senses(word) & senses(part)) and not _is_of_surfaces(word, vocabulary)


def _head(name: tuple[str, ...], vocabulary: Vocabulary) -> tuple[str, ...]:
    """A name without what follows its noun: "frame" of "frame black", "tent" of "tent small", "bathtub" of "bathtub freestanding"."""
    ends = [
        n
        for n, word in enumerate(name, 1)
        if not (_is_of_surfaces(word, vocabulary) or _picks(word, vocabulary))
    ]
    things = [n for n in ends if name[n - 1] in thing_words().rows]
    return name[: max(things or ends, default=None)]


def _picks(word: str, vocabulary: Vocabulary) -> bool:
    """Whether a word of a name says which one of several alike things it is: "small", "left"."""
    return word in vocabulary.picks or word in name_words("order")


def _is_of_surfaces(word: str, vocabulary: Vocabulary) -> bool:
    """Whether a word of a name says what a thing is made of, or its color or finish."""
    return word in vocabulary.colors or vocabulary.slot(word) in _SURFACE


def stuff_of(name: str, vocabulary: Vocabulary) -> frozenset[str]:
    """The materials that a name speaks of: "bakelite" of "Handle_Bakelite", nothing of "Head"."""
    return frozenset(word for word in parts(name) if vocabulary.slot(word) == "material")


def _as_part(word: str, name: tuple[str, ...], otherwise: str, vocabulary: Vocabulary) -> str:
    """Of "car" in "car shell" and in "car wheel": a limb stands for the whole, a detail does not, nor what is in a place: "garage door"."""
    if name[-1] in name_words("details") or vocabulary.slot(word) in _PLACES:
        return "detail's whole"
    as_whole = {"part": "whole", "part's synonym": "synonym"}
    return as_whole[otherwise] if name[-1] in name_words("limbs") else otherwise


def guessed_fit(word: str, name: tuple[str, ...], vocabulary: Vocabulary) -> str:
    """How a word that fits no name may still mean one: "misspelled", or "" for no way."""
    if not name or table().is_english(word) or len(word) < _SHORTEST:
        return ""
    near = max(SequenceMatcher(None, word, part).ratio() for part in name)
    meant = _corrected(word)
    known = bool(meant) and _is_one_of(senses(meant), (name[-1], _head(name, vocabulary)[-1]))
    return "misspelled" if near >= _MISSPELLED or known else ""


@lru_cache(_WORDS)
def _corrected(word: str) -> str:
    """The known thing that a misspelled word is nearest to; "" if none is near."""
    known = [w for w in sorted(english_things()) if w[0] == word[0]]
    return next(iter(get_close_matches(word, known, 1, _MISSPELLED)), "")


def best(found: Iterable[str]) -> str:
    """The surest of several ways to fit; "" for none."""
    return min((f for f in found if f), key=FITS.index, default="")
