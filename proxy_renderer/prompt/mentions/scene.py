# SPDX-License-Identifier: Apache-2.0
"""What words may name in a scene: sets of materials and of lights, each with how it was found."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from functools import lru_cache

from ..lexicon.vocabulary import Vocabulary
from ..names import is_detail, limbs, plain_name
from ..types import GLOW, SceneDescription
from .names import best, fit, guessed_fit, parts, stuff_of
from .nouns import Named

_TYPES = {"SUN": "sun", "SPOT": "spot"}
"""Types of lights that people call by name."""
_OF_ITS_KIND = ("exact", "last", "whole", "synonym")
"""Ways to fit the name of a thing that is what a word says, or a limb of it."""
_OF_THE_WORD = ("exact", "last", "part")
"""Ways to fit a name that has the very word: "stone" in "Ruin_Stone" and "Stone_Mossy"."""
_SAID = 512  # words of prompts whose names are remembered
_Found = tuple[Iterable[str], tuple[str, ...]]
"""Names, and the signs by which they were found."""


class _Fits:
    """How words fit names; of thousands, many have the same parts.

    Args:
        said: Words of the prompt, as `parts` gives them.
        guess: Whether things of nearly the same spelling count.
    """

    def __init__(self, said: tuple[str, ...], guess: bool, vocabulary: Vocabulary) -> None:
        self._said, self._guess, self._vocabulary = said, guess, vocabulary
        self._ways: dict[tuple[str, ...], str] = {}

    def __call__(self, names: Mapping[str, tuple[str, ...]]) -> dict[str, str]:
        """The names that the words fit, with the way."""
        return {name: way for name, its in names.items() if (way := self._way(its))}

    def _way(self, name: tuple[str, ...]) -> str:
        if name not in self._ways:
            self._ways[name] = (
                guessed_fit(self._said[0], name, self._vocabulary)
                if self._guess
                else fit(self._said, name, self._vocabulary)
            )
        return self._ways[name]


class SceneIndex:
    """Finds what words may name; `SceneDescription.made` keeps it with the scene."""

    def __init__(self, words: SceneDescription, vocabulary: Vocabulary) -> None:
        self.words, self._vocabulary = words, vocabulary
        self._materials = {name: parts(name) for name in words.materials}
        self._objects = {name: parts(name) for name in words.objects}
        self._groups = {name: parts(name) for name in words.groups}
        self._lights = {name: parts(name) for name in words.lights}
        self._stuff = {name: stuff_of(name, vocabulary) for name in words.materials}
        self._found = lru_cache(_SAID)(self._find)
        self._limbs = limbs(words)
        self._worn_by_limbs = {name for worn in self._limbs.values() for name in worn}

    def named(self, said: tuple[str, ...], plural: bool = False, guess: bool = False) -> list[Named]:
        """All that words may name.

        Args:
            said: Words of the prompt, as `parts` gives them.
            plural: Whether they speak of several, so that all of the kind may be meant, and not only what is called exactly so.
            guess: Whether things of nearly the same spelling count.
        """
        return list(self._found(said, plural, guess))

    def _find(self, said: tuple[str, ...], plural: bool, guess: bool) -> list[Named]:
        fits = _Fits(said, guess, self._vocabulary)
        found: dict[tuple[str, frozenset[str]], set[str]] = defaultdict(set)
        for kind, named in (("things", self._of_things(fits, plural)), ("lights", self._of_lights(fits))):
            for names, signs in named:
                if every := frozenset(names):
                    found[kind, every] |= {*signs, *(("several",) if len(every) > 1 else ())}
        return [Named(kind, names, frozenset(signs)) for (kind, names), signs in found.items()]

    def objects(self, said: tuple[str, ...]) -> list[str]:
        """The objects whose names words fit best.

        Args:
            said: Words of the prompt, as `parts` gives them.
        """
        ways = _Fits(said, False, self._vocabulary)(self._objects)
        surest = best(ways.values())
        return [name for name, way in ways.items() if way == surest]

    def is_several(self, named: Named) -> bool:
        """Whether several objects wear what is named."""
        worn = self.words.object_materials.values()
        return sum(not named.names.isdisjoint(its) for its in worn) > 1

    def worn(self, name: str) -> frozenset[str]:
        """The materials of an object."""
        return frozenset(self.words.object_materials.get(name, ()))

    def _of_things(self, fits: _Fits, plural: bool) -> Iterator[_Found]:
        sources = (("material", self._materials), ("object", self._objects), ("group", self._groups))
        for source, names in sources:
            ways = fits(names)
            surest = best(ways.values())
            for way in dict.fromkeys(ways.values()):  # in an order that is the same in every process
                if way == "whole" and surest == "exact" and not plural:  # a duck is not its head alone
                    continue
                chosen = [name for name, its in ways.items() if its == way]
                signs = (f"{source} {way}", *(() if way == surest else ("less sure",)))
                yield from self._chosen(source, chosen, signs)
            of_word = [name for name, way in ways.items() if way in _OF_THE_WORD]
            if source == "material" and len({ways[name] for name in of_word}) > 1:
                yield from self._chosen(source, of_word, (f"{source} {surest}", "any of it"))
            kind = [name for name, way in ways.items() if way in _OF_ITS_KIND]
            if plural and source != "material" and len({ways[name] for name in kind}) > 1:
                yield from self._chosen(source, kind, (f"{source} {surest}", "every one"))

    def _chosen(self, source: str, chosen: list[str], signs: tuple[str, ...]) -> Iterator[_Found]:
        """The materials of what was chosen: all of them, without details, and the first one of each object."""
        if source == "material":
            yield from self._split([m for n in chosen for m in self._with_limbs(n)], (*signs, "whole"))
            return
        groups = self.words.groups if source == "group" else {}
        every = (o for name in chosen for o in groups.get(name, (name,)))
        objects = [o for o in every if self.words.object_materials.get(o)]
        own = [m for o in objects for m in self.words.object_materials[o]]
        worn = [*own, *(m for o in objects for m in self._limbs[o])]
        signs = (*signs, "of one object") if len(objects) == 1 else signs
        yield from self._split(worn, (*signs, "whole"))
        yield [m for m in worn if not is_detail(m)], (*signs, "without details")
        stuff = {word for m in own for word in self._stuff[m]}
        alike = [m for m in worn if m in own or stuff.issuperset(self._stuff[m])]
        if {*alike} < {*worn}:
            yield alike, (*signs, "of the same stuff")
        if self._worn_by_limbs.isdisjoint(worn):  # limbs look like their whole
            yield from self._split([self.words.object_materials[o][0] for o in objects], (*signs, "first"))

    def _split(self, names: list[str], signs: tuple[str, ...]) -> Iterator[_Found]:
        """Materials, and apart from each other those of subject and surroundings."""
        yield names, signs
        for region in dict.fromkeys(self.words.materials.get(n) for n in names):
            mine = [n for n in names if self.words.materials.get(n) == region]
            if len(mine) < len(names):
                yield mine, (*signs, f"only {region}")

    def _with_limbs(self, material: str) -> list[str]:
        """A material, and what the limbs wear of an object that is called like it."""
        worn, called = self.words.object_materials, plain_name(material)
        wearers = [o for o in worn if material in worn[o] and plain_name(o) == called]
        return [material, *(m for o in wearers for m in self._limbs.get(o, ()))]

    def _of_lights(self, fits: _Fits) -> Iterator[_Found]:
        words, lamps, shown = self.words, fits(self._lights), fits(self._objects)
        if surest := best(lamps.values()):
            yield [n for n, way in lamps.items() if way == surest], (f"light {surest}",)
        yield (
            fits({n: (_TYPES[x.type],) for n, x in words.lights.items() if x.type in _TYPES}),
            ("light type",),
        )
        glows = fits({n: self._materials[n] for n in words.glows})
        yield [GLOW + n for n in glows], (f"glow {best(glows.values())}",)
        lit = [n for n in words.glows if any(n in words.object_materials[o] for o in shown)]
        yield [GLOW + n for n in lit], (f"glow on object {best(shown.values())}",)
        yield [n for n, x in words.lights.items() if {*x.objects} & {*shown}], ("lights it",)
