# SPDX-License-Identifier: Apache-2.0
"""Names in a scene: their spoken forms, names that are parts of others, and how well words of a prompt fit them."""

import re
from collections import defaultdict
from collections.abc import Iterable
from functools import lru_cache

from ..schema.parameters import Region
from .lexicon.entries import normalize
from .lexicon.languages import folded, name_words, senses, singular
from .lexicon.vocabulary import Vocabulary
from .types import SceneDescription

FITS = ("exact", "all", "last", "whole", "synonym", "part", "detail's whole")
"""Ways in which words fit a name, the surest first."""
_NAMES = 16_384  # names of scenes that are cached


def _spaced(name: str) -> list[str]:
    """The words of a name in lower case: "SM_WoodTable.001" -> ["sm", "wood", "table"]."""
    return normalize(re.sub(r"(?<=[a-z0-9])(?=[A-Z])|[\W_]|\d+", " ", name)).split()


@lru_cache(_NAMES)
def plain_name(name: str) -> str:
    """A name as people say it: "WoodTable.001" -> "wood table", "SM_Cup.001_low" -> "cup", "Tyre Two" -> "tyre"."""
    every = _spaced(name)
    words = [w for w in every if w not in name_words("pipeline") and len(w) > 1] or every
    while len(words) > 1 and words[-1] in name_words("order"):
        words.pop()
    return " ".join(words)


def kind_of(material: str) -> str:
    """The kind of a material, which is its name without numbers; a name of numbers alone is its own kind."""
    plain = plain_name(material)
    return plain if set(plain.split()) - name_words("pipeline") else material


def is_detail(material: str) -> bool:
    """True if a material's name is that of a part with a color of its own: tyres, eyes, windows."""
    last = plain_name(material).rpartition(" ")[2]
    return not name_words("details").isdisjoint((last, last.removesuffix("s")))


def scene_names(words: SceneDescription) -> frozenset[str]:
    """Names of objects and materials, their last words, and names without a final limb: "car" of "CarShell"."""
    spoken = {plain_name(words.subject)}
    for name in map(plain_name, (*words.objects, *words.materials)):
        whole, _, last = name.rpartition(" ")
        spoken |= {name, last, whole if last in name_words("limbs") else ""}
    return frozenset(name for name in spoken if len(name) > 2)


def limbs(words: SceneDescription) -> dict[str, tuple[str, ...]]:
    """Object -> its limbs that are objects, too: "Duck Head" of "Duck", or "Lid" of the only whole object, a teapot."""
    heads: dict[Region, set[str]] = {"subject": set(), "surroundings": set()}
    theirs: dict[tuple[Region, str], list[str]] = defaultdict(list)
    for name, region in words.objects.items():
        whole, _, last = plain_name(name).rpartition(" ")
        if last in name_words("limbs"):
            theirs[region, whole].append(name)
        elif last not in name_words("details"):
            heads[region].add(plain_name(name))
    found = {}
    for name, region in words.objects.items():
        spoken, named = plain_name(name), heads[region]
        wholes = [spoken, ""] if named == {spoken} else [spoken] if spoken in named else []
        found[name] = tuple(limb for whole in wholes for limb in theirs.get((region, whole), ()))
    return found


@lru_cache(_NAMES)
def parts(name: str) -> tuple[str, ...]:
    """Singular words of a name: "SM_WoodTables.001" -> ("wood", "table"); single letters come first: ("l", "lamp")."""
    every = [singular(folded(w)) for w in _spaced(name)]
    letters = [w for w in every if w.isascii() and len(w) == 1]
    words = [w for w in every if w not in letters]
    while len(words) > 1 and words[-1] in name_words("counted"):
        words.pop()
    return (*letters, *([w for w in words if w not in name_words("pipeline")] or words))


def fit(words: tuple[str, ...], name: tuple[str, ...], vocabulary: Vocabulary) -> str:
    """The way in which words of a prompt, as `parts` gives them, fit a name: one of `FITS`; "" if they do not."""
    if not (words and name):
        return ""
    joined = "".join(words)
    if words in (name, tuple(n for n in name if len(n) > 1)) or joined == "".join(name):
        return "exact"
    # a word for a look has no synonyms here: "oak floor" does not fit "floor wood"
    if len(words) > 1:
        found = (w in name or (_shares_a_sense(w, name) and not is_of_surfaces(w, vocabulary)) for w in words)
        return "all" if all(found) or joined in name else ""
    (word,) = words
    if word in name_words("sides"):  # "from the right"
        return ""
    if word == name[-1] or word == "".join(name[-2:]):
        return "last"
    if word in name:
        if name[-1] in name_words("details"):
            return "detail's whole"
        return "whole" if name[-1] in name_words("limbs") else "part"  # "car shell" is the car, "robot eyes" are not it
    return "synonym" if _shares_a_sense(word, (name[-1], " ".join(name))) else ""


def _shares_a_sense(word: str, others: Iterable[str]) -> bool:
    return any(senses(word) & senses(other) for other in others)


def is_of_surfaces(word: str, vocabulary: Vocabulary) -> bool:
    """True if a word of a name says what a thing is made of, or its color or finish."""
    return word in vocabulary.colors or vocabulary.slot(word) in ("material", "finish")


def best(found: Iterable[str]) -> str:
    """The surest of several ways to fit, see `FITS`; "" if there is none."""
    return min((f for f in found if f), key=FITS.index, default="")
