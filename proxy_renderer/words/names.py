# SPDX-License-Identifier: Apache-2.0
"""Names in a scene: as somebody would say them, which are parts of others, and how well words of a prompt fit them."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable
from difflib import SequenceMatcher, get_close_matches
from functools import cache, lru_cache
from pathlib import Path

from ..schema.parameters import Region
from .lexicon.entries import normalize
from .lexicon.languages import english_things, folded, senses, singular, thing_words
from .lexicon.vocabulary import Vocabulary
from .lexicon.word_table import table
from .types import SceneDescription

FITS = (
    "exact", "all", "last", "whole", "synonym", "part", "part's synonym", "detail's whole", "misspelled",
)  # fmt: skip
"""Ways in which words fit a name, the surest first."""
_MISSPELLED = 0.8  # share of the characters of a misspelled name that are right
_SHORTEST = 4  # characters of a word that may be misspelled
_NAMES, _WORDS = 16_384, 1024  # names of scenes, and words of prompts, that are cached


@cache
def name_words(kind: str) -> frozenset[str]:
    """Words of one row of lexicon/names.toml: "pipeline", "counted", "primitives", "order", "limbs" or "details"."""
    path = Path(__file__).with_name("lexicon") / "names.toml"
    rows: dict[str, str] = tomllib.loads(path.read_text("utf-8"))
    return frozenset(rows[kind].split())


def _spaced(name: str) -> list[str]:
    """ "SM_WoodTable.001" -> ["sm", "wood", "table"]."""
    return normalize(re.sub(r"(?<=[a-z0-9])(?=[A-Z])|[\W_]|\d+", " ", name)).split()


@lru_cache(_NAMES)
def plain_name(name: str) -> str:
    """A name as somebody would say it: "WoodTable.001" -> "wood table", "SM_Cup.001_low" -> "cup", "Tyre Two" -> "tyre"."""
    every = _spaced(name)
    words = [w for w in every if w not in name_words("pipeline") and len(w) > 1] or every
    while len(words) > 1 and words[-1] in name_words("order"):
        words.pop()
    return " ".join(words)


def kind_of(material: str) -> str:
    """A name without numbers: materials of one kind are painted alike. A name of numbers alone is a kind of its own."""
    plain = plain_name(material)
    return plain if set(plain.split()) - name_words("pipeline") else material


def is_detail(material: str) -> bool:
    """Whether a name is that of a part with a color of its own: tyres, eyes, windows."""
    last = plain_name(material).rpartition(" ")[2]
    return not name_words("details").isdisjoint((last, last.removesuffix("s")))


def scene_names(words: SceneDescription) -> frozenset[str]:
    """Whole names in a scene, their last words, and the wholes of limbs: "car" of "CarShellNew"."""
    spoken = {plain_name(words.subject)}
    for name in map(plain_name, (*words.objects, *words.materials)):
        whole, _, last = name.rpartition(" ")
        spoken |= {name, last, whole if last in name_words("limbs") else ""}
    return frozenset(name for name in spoken if len(name) > 2)


def limbs(words: SceneDescription) -> dict[str, tuple[str, ...]]:
    """Object -> materials of its parts that are objects of their own: the duck's head, the only teapot's lid."""
    parts_of_things = name_words("limbs") | name_words("details")
    heads: dict[Region, set[str]] = {"subject": set(), "surroundings": set()}
    theirs: dict[Region, dict[str, list[str]]] = {"subject": {}, "surroundings": {}}
    for name, region in words.objects.items():
        whole, _, last = plain_name(name).rpartition(" ")
        if last not in parts_of_things:
            heads[region].add(plain_name(name))
        elif last in name_words("limbs"):
            theirs[region].setdefault(whole, []).append(name)
    found = {}
    for name, region in words.objects.items():
        spoken, alone = plain_name(name), heads[region] == {plain_name(name)}
        wholes = {spoken, *([""] if alone else [])} if spoken in heads[region] else set()
        mine = [limb for whole, its in theirs[region].items() if whole in wholes for limb in its]
        found[name] = tuple(dict.fromkeys(m for limb in mine for m in words.object_materials.get(limb, ())))
    return found


@lru_cache(_NAMES)
def parts(name: str) -> tuple[str, ...]:
    """Words of a name: "SM_WoodTable.001" -> ("wood", "table"); a single letter comes first, as in ("l", "lamp")."""
    every = [singular(folded(w)) for w in _spaced(name)]
    letters = [w for w in every if w.isascii() and len(w) == 1]
    words = [w for w in every if w not in letters]
    while len(words) > 1 and words[-1] in name_words("counted"):
        words.pop()
    return (*letters, *([w for w in words if w not in name_words("pipeline")] or words))


def fit(words: tuple[str, ...], name: tuple[str, ...], vocabulary: Vocabulary) -> str:
    """The way in which words fit a name, one of `FITS`; "" if they do not.

    Args:
        words: Of the prompt, as `parts` gives them.
    """
    if not (words and name):
        return ""
    joined = "".join(words)
    if words in (name, tuple(n for n in name if len(n) > 1)) or joined == "".join(name):
        return "exact"
    # a look stands only for itself: "rubber tire" is no "tire", "oak floor" no "floor wood"
    if len(words) > 1:
        found = (
            w in name or (_shares_a_sense(w, name) and not _is_of_surfaces(w, vocabulary)) for w in words
        )
        return "all" if all(found) or joined in name else ""
    (word,) = words
    ends = (name[-1], _head(name, vocabulary)[-1])
    if word in ends or word == "".join(name[-2:]):
        return "last"
    if word in name:
        return _part_fit(word, name, "part", vocabulary)
    if _shares_a_sense(word, (*ends, " ".join(name))):
        return "synonym"
    return _part_fit(word, name, "part's synonym", vocabulary) if _shares_a_sense(word, name[:-1]) else ""


def _shares_a_sense(word: str, others: Iterable[str]) -> bool:
    return any(senses(word) & senses(other) for other in others)


def _is_of_surfaces(word: str, vocabulary: Vocabulary) -> bool:
    """Whether a word of a name says what a thing is made of, or its color or finish."""
    return word in vocabulary.colors or vocabulary.slot(word) in ("material", "finish")


def _head(name: tuple[str, ...], vocabulary: Vocabulary) -> tuple[str, ...]:
    """A name up to its noun: "frame" of "frame black", "bathtub" of "bathtub freestanding"."""
    ends = [n for n, word in enumerate(name, 1) if not _is_of_surfaces(word, vocabulary)]
    things = [n for n in ends if name[n - 1] in thing_words().rows]
    return name[: max(things or ends, default=None)]


def _part_fit(word: str, name: tuple[str, ...], way: str, vocabulary: Vocabulary) -> str:
    """The way of a word inside a name. A limb stands for the whole ("car shell"), a detail does not, nor what is in a place ("garage door")."""
    if name[-1] in name_words("details") or vocabulary.slot(word) in ("setting", "mood"):
        return "detail's whole"
    if name[-1] in name_words("limbs"):
        return "whole" if way == "part" else "synonym"
    return way


def guessed_fit(word: str, name: tuple[str, ...], vocabulary: Vocabulary) -> str:
    """ "misspelled" where a word that fits no name is one with a mistake; else ""."""
    if not name or table().is_english(word) or len(word) < _SHORTEST:
        return ""
    near = max(SequenceMatcher(None, word, part).ratio() for part in name)
    meant = _corrected(word)
    known = bool(meant) and _shares_a_sense(meant, (name[-1], _head(name, vocabulary)[-1]))
    return "misspelled" if near >= _MISSPELLED or known else ""


@lru_cache(_WORDS)
def _corrected(word: str) -> str:
    """The known thing that a misspelled word is nearest to; "" if none is near."""
    known = [w for w in sorted(english_things()) if w[0] == word[0]]
    return next(iter(get_close_matches(word, known, 1, _MISSPELLED)), "")


def best(found: Iterable[str]) -> str:
    """The surest of several ways to fit; "" for none."""
    return min((f for f in found if f), key=FITS.index, default="")
