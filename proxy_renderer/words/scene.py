# SPDX-License-Identifier: Apache-2.0
"""Finds the materials and lights that a noun may mean: by name ("lamp"), or by present look ("the navy surface")."""

import math
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

from ..color.floats import oklab_from_srgb
from ..schema import Values
from ..schema.material_copies import copied
from .lexer import Token
from .lexicon.vocabulary import Vocabulary
from .names import FITS, best, fit, limbs, parts, plain_name
from .passage import STRUCTURES
from .types import GLOW, MaterialLook, SceneDescription

REGIONS = {"surroundings": "surroundings", "subject": "subject", "unknown": "subject"}
"""Kind of a noun that names nothing in the scene -> the part of the image that it means."""
_WORDS = 512  # words of prompts whose names are cached
# Present looks
_NEAR = 0.11  # OKLab distance, see `_distance`, within which a material has the color of a name
_LIGHTNESS = 0.4  # weight of lightness in that distance
_CLEAR = 1.4  # multiple of the nearest distance beyond which a further material is no rival
_ALIKE = 0.05  # distance within which two materials have one color
_SAME = 0.1  # OKLab distance within which a part looks like its whole
_GRAY = 0.04  # chroma below which a hue says nothing
# range of a material's chroma that does not count as a distance, in multiples of the name's
_PALER, _STRONGER = 0.5, 1.6
_SEEN = 0.001  # least share of the image of a material that a noun can mean by its look
_MAIN = 3.0  # times that a material must be larger than rivals of nearly its color
_BY_LOOK = frozenset({"material exact", "by look"})


@dataclass(frozen=True)
class Named:
    """Materials or lights of the scene that one noun may name."""

    kind: str  # "things" or "lights"
    names: frozenset[str]  # of materials, or of lights; glows among lights start with `GLOW`
    signs: frozenset[str]  # how they were found: "object exact", "material part", "first", "several"


@dataclass(frozen=True)
class NounMention:
    """A noun, or several that belong together ("box and cup")."""

    start: int  # place of its first token
    end: int  # place of its last token
    text: str
    noun: str = ""  # kind by the vocabulary's nouns; "others" for "the rest", "unknown" for an unknown noun
    role: str = ""  # role of lights that it names: "key", "fill" or "rim"
    named: tuple[Named, ...] = ()  # what it may name in the scene
    members: int = 1  # number of nouns that it joins; 1 for a single noun
    excepted: bool = False  # the prompt leaves it out: "everything but the floor"

    def covers(self, index: int) -> bool:
        """True if the token at place `index` is part of this noun."""
        return self.start <= index <= self.end


def fit_signs(named: Named) -> dict[str, str]:
    """Sign that says how well words fit a name -> its way of `FITS`: "object exact" -> "exact"."""
    return {sign: way for sign in named.signs for way in FITS if sign.endswith(f" {way}")}


def fit_rank(named: Named) -> int:
    """Place in `FITS` of the surest way in which words fit the names: 0 for the surest; len(FITS) if none has a way."""
    return min((FITS.index(way) for way in fit_signs(named).values()), default=len(FITS))


def is_alike(one: Values | None, other: Values | None) -> bool:
    """True if people would call two sRGB colors the same; False if one is unknown."""
    return one is not None and other is not None and math.dist(*map(oklab_from_srgb, (one, other))) < _SAME


def surest(mention: NounMention, kind: str, first: str) -> Named | None:
    """The surest of what a noun names of a kind, "things" or "lights"; None if it names nothing of that kind.

    Of equally sure ones, one with a sign that begins with `first` is preferred: "material" or "object" for the source
    of the name, "first" or "whole" for the first or all materials of an object.
    """

    def rank(named: Named) -> tuple[int, bool]:
        return fit_rank(named), not any(sign.startswith(first) for sign in named.signs)

    return min((n for n in mention.named if n.kind == kind), key=rank, default=None)


def materials_of(region: str, words: SceneDescription) -> frozenset[str]:
    """The materials of "subject" or "surroundings"."""
    return frozenset(name for name, its in words.materials.items() if its == region)


def taken(mentions: Iterable[NounMention], words: SceneDescription) -> frozenset[str]:
    """Materials that nouns name in the surest way; an excepted noun that names none means its part of the image."""
    names: set[str] = set()
    for mention in mentions:
        best = surest(mention, "things", "object") if mention.members == 1 else None
        if mention.excepted and best is None:
            names |= materials_of(REGIONS.get(mention.noun, ""), words)
        names |= best.names if best else set()
    return frozenset(names)


class SceneIndex:
    """Finds the materials, lights and objects that words may name; `SceneDescription.made` keeps it with the scene."""

    def __init__(self, words: SceneDescription, vocabulary: Vocabulary) -> None:
        self.words, self._vocabulary = words, vocabulary
        self._materials = {name: parts(copied(name)[0]) for name in words.materials}
        self._objects = {name: parts(name) for name in words.objects}
        self._groups = {name: parts(name) for name in words.groups}
        self._lights = {name: parts(name) for name in words.lights}
        self._parts = limbs(words)
        self._limbs = {
            name: tuple(dict.fromkeys(m for part in its for m in self._alike(part, name)))
            for name, its in self._parts.items()
        }
        self._worn_by_limbs = {name for worn in self._limbs.values() for name in worn}
        # all that words of a prompt, as `parts` gives them, may name
        self.named: Callable[[tuple[str, ...]], list[Named]] = lru_cache(_WORDS)(self._named)

    def objects(self, said: tuple[str, ...]) -> list[str]:
        """Names of the objects that the words `said`, as `parts` gives them, fit best; [] if they fit none."""
        ways = self._ways(said, self._objects)
        surest = best(ways.values())
        return [name for name, way in ways.items() if way == surest]

    def parts_of(self, name: str) -> tuple[str, ...]:
        """Names of the limbs of object `name` that are objects, too, see `names.limbs`."""
        return self._parts.get(name, ())

    def _alike(self, part: str, whole: str) -> list[str]:
        """Materials of object `part` with a color of object `whole`, or of unknown color: not a couch's wooden legs."""
        looks = {name: look.color for name, look in self.words.looks.items() if look.color}
        own = [looks[m] for m in self.words.object_materials.get(whole, ()) if m in looks]
        worn = self.words.object_materials.get(part, ())
        return [m for m in worn if m not in looks or not own or any(is_alike(looks[m], each) for each in own)]

    def _named(self, said: tuple[str, ...]) -> list[Named]:
        found: dict[tuple[str, frozenset[str]], set[str]] = defaultdict(set)
        for kind, names, signs in self._found(said):
            if every := frozenset(names):
                found[kind, every] |= {*signs, *(("several",) if len(every) > 1 else ())}
        return [Named(kind, names, frozenset(signs)) for (kind, names), signs in found.items()]

    def _ways(self, said: tuple[str, ...], names: Mapping[str, tuple[str, ...]]) -> dict[str, str]:
        """Name that the words `said` fit -> the way, see `FITS`; `names`: name -> its words, as `parts` gives them."""
        ways = {its: fit(said, its, self._vocabulary) for its in {*names.values()}}
        return {name: ways[its] for name, its in names.items() if ways[its]}

    def _found(self, said: tuple[str, ...]) -> Iterator[tuple[str, Iterable[str], tuple[str, ...]]]:
        """Yields kind, names and signs, as in `Named`, of all that the words `said` may name; names may be empty."""
        worn, groups = self.words.object_materials, self.words.groups
        sources = {"material": self._materials, "object": self._objects, "group": self._groups}
        fitting = {source: self._ways(said, names) for source, names in sources.items()}
        for source, ways in fitting.items():
            surest = best(ways.values())
            # "duck" does not mean the duck's head alone
            theirs = {part for o, way in ways.items() if way == surest for part in self._parts.get(o, ())}
            for way in dict.fromkeys(ways.values()):  # in an order that is the same in every process
                chosen = [name for name, its in ways.items() if its == way and name not in theirs]
                signs = (f"{source} {way}", *(() if way == surest else ("less sure",)))
                objects: list[str] = []
                if source == "material":  # and what the limbs of an object with the material's name wear
                    called = (o for m in chosen for o in worn if plain_name(o) == plain_name(m) and m in worn[o])
                    every = [*chosen, *(limb for o in called for limb in self._limbs.get(o, ()))]
                else:
                    named = (o for name in chosen for o in (groups[name] if source == "group" else (name,)))
                    objects = [o for o in named if worn.get(o)]
                    every = [m for o in objects for m in (*worn[o], *self._limbs[o])]
                    signs = (*signs, "of one object") if len(objects) == 1 else signs
                yield "things", every, (*signs, "whole")
                for region in dict.fromkeys(self.words.materials.get(m) for m in every):
                    mine = [m for m in every if self.words.materials.get(m) == region]
                    if len(mine) < len(every):
                        yield "things", mine, (*signs, "whole", f"only {region}")
                if objects and self._worn_by_limbs.isdisjoint(every):  # limbs look like their whole
                    yield "things", [worn[o][0] for o in objects], (*signs, "first")
        lamps = self._ways(said, self._lights)
        surest = best(lamps.values())
        yield "lights", [name for name, way in lamps.items() if way == surest], (f"light {surest}",)
        glows = self._ways(said, {name: self._materials[name] for name in self.words.glows})
        yield "lights", [GLOW + name for name in glows], (f"glow {best(glows.values())}",)
        shown = fitting["object"]
        lit = [name for name in self.words.glows if any(name in worn[thing] for thing in shown)]
        yield "lights", [GLOW + name for name in lit], (f"glow on object {best(shown.values())}",)


class LookIndex:
    """Finds the materials that a noun means by their present look: by color and shape."""

    def __init__(self, words: SceneDescription, vocabulary: Vocabulary) -> None:
        self._vocabulary = vocabulary
        looks = words.looks.items()
        self._looks = {n: look for n, look in looks if look.share >= _SEEN and n in words.materials}

    def told(self, noun: Token, named: list[Named]) -> list[Named]:
        """Materials that `noun` clearly means by present color or shape, of `named` or, if that is empty, of all."""
        color = next((look.color for look in noun.presents if look.color), None)
        things = [n for n in named if n.kind == "things"]
        if noun.presents and things:
            return [replace(n, names=self._of_color(color, n.names) or n.names) for n in things]
        shaped = frozenset() if named else self.shaped(noun.text)
        if color and not named:
            shaped = self._of_color(color, shaped) or self._of_color(color, self._looks.keys())
        elif len(shaped) > 1 and not noun.text.endswith("walls"):
            return []
        return [Named("things", shaped, _BY_LOOK)] if shaped else []

    def shaped(self, noun: str) -> frozenset[str]:
        """Materials with the shape that a noun names ("roof", "floor"); empty if there are none."""
        words = {noun, noun.rpartition(" ")[2]}
        kinds = {kind for kind in STRUCTURES if words & self._vocabulary.words[kind]}
        there = frozenset[str]().union(*(look.structures for look in self._looks.values()))
        kinds = {"walls"} if "walls" in kinds & there else kinds
        return frozenset(name for name, look in self._looks.items() if kinds & look.structures)

    def _of_color(self, color: Values | None, names: Iterable[str]) -> frozenset[str]:
        """Those of the materials `names` that have a color; empty if a rival is about as near and not much smaller."""
        far = {n: _distance(color, self._looks[n]) for n in names if color and n in self._looks}
        nearest = min(far.values(), default=math.inf)
        if nearest >= _NEAR:
            return frozenset()
        alike = {n for n, distance in far.items() if distance <= nearest + _ALIKE}
        others = (n for n, distance in far.items() if distance < _CLEAR * (nearest + _ALIKE) and n not in alike)
        least = min(self._looks[n].share for n in alike)
        clear = all(least >= _MAIN * self._looks[n].share for n in others)
        return frozenset(alike if clear else ())


def _distance(color: Values, look: MaterialLook) -> float:
    """OKLab distance of a material's color from that of a name.

    Lightness counts less, and not at all for a material that glows; chroma counts only if it is far from the name's.
    """
    if look.color is None:
        return math.inf
    (light, *named), (own_light, *own) = oklab_from_srgb(color), oklab_from_srgb(look.color)
    strong, length = math.hypot(*named), math.hypot(*own)
    hues = min(strong, length) > _GRAY
    factor = min(max(strong / length, 1 / _STRONGER), 1 / _PALER) if hues else 1.0
    lighter = 0.0 if look.glows else _LIGHTNESS * (light - own_light)
    return math.hypot(lighter, *(a - factor * b for a, b in zip(named, own, strict=True)))
