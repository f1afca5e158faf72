# SPDX-License-Identifier: Apache-2.0
"""Decides what each look word describes, given the nouns around it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from ..schema import VibeError
from .lexicon.vocabulary import Vocabulary
from .things import Thing, Word
from .types import Attribute, Parsed
from .unclaimed import BOUND_SLOTS, Unclaimed

_LESS = 0.7  # how much of the opposite "less" asks for
_PAINTED = ("background", "backdrop", "wall", "walls")
"""Ends of names of settings that are a surface behind the subject."""


class Binder:
    """Collects attributes.

    Attributes:
        attributes: Bound so far, in the order of the text.
        ignored: Words that describe nothing here.
        things: Nouns met so far.
        cause: The mood that the text stands for; "" for the prompt itself.
    """

    def __init__(self, vocabulary: Vocabulary, cause: str, read_means: Callable[[str, str], Parsed]) -> None:
        self.vocabulary, self.cause, self._read_means = vocabulary, cause, read_means
        self.attributes: list[Attribute] = []
        self.ignored: list[str] = []
        self.things: list[Thing] = []
        self.unclaimed = Unclaimed(self.attributes, self.things, vocabulary)

    def slot(self, entry: str) -> str:
        """The slot of a vocabulary entry."""
        return self.vocabulary.entries[entry].slot

    def is_material(self, word: Word) -> bool:
        """Whether a word names what things are made of."""
        return bool(word.token.entry) and self.slot(word.token.entry) == "material"

    def directs_light(self, entry: str) -> bool:
        """Whether a word says where light comes from."""
        effects = self.vocabulary.entries[entry].effects
        return self.slot(entry) == "lighting" and any(
            e.name in ("azimuth", "elevation") and not e.weak for e in effects
        )

    def bind(self, words: list[Word], thing: Thing, final: bool = False) -> list[Word]:
        """Binds words to a thing; returns those that do not describe such a thing.

        "Black and soft light": what stands before an "and" does not describe a light after it,
        unless it could hardly describe anything else ("warm and soft light", "red and blue light").
        """
        left = []
        words = self._as_colors(words)
        for position, word in enumerate(words):
            in_list = word.token.color and any(not w.barred and w.token.color for w in words[position:])
            suits = thing.kind in self.vocabulary.adjectives.get(word.token.adjective, {})
            held_back = word.barred and not final and not thing.matter and not in_list and not suits
            if held_back or not self._bind_word(word, thing):
                left.append(word)
                self.ignored += [word.text] if final else []
        return left

    def _as_colors(self, words: list[Word]) -> list[Word]:
        """Words that name a material and its color, as the color alone before another material: "emerald velvet"."""
        made = [self.is_material(w) for w in words]
        return [
            replace(w, token=replace(w.token, entry="", adjective=""))
            if w.token.color and not w.barred and any(made[i + 1 :])
            else w
            for i, w in enumerate(words)
        ]

    def bind_rest(self, words: list[Word], last: Thing | None, linked: bool, around: bool) -> None:
        """The end of a clause: what still waits describes the last noun, the surroundings, or the subject."""
        subject = Thing("subject", "subject")
        if last and last.kind == "nowhere" and linked:
            self.ignored += [w.text for w in words]
            return
        colored = any(w.token.color for w in words)
        if around:
            thing = Thing("surroundings", "surroundings", "surroundings")
        elif last and (linked or last.kind == "subject" or (not last.matter and not colored)):
            thing = last
        else:
            loose = [w for w in words if w.token.adjective and not (w.token.entry or w.token.color)]
            words = [w for w in words if w not in loose]
            self.bind(loose, Thing("whole", region="whole"), final=True)
            thing = subject
            first = len(self.attributes)
            said, words = words, self.bind(words, subject)
            self.unclaimed.add(first, said)
        self.bind(self.bind(words, thing), subject, final=True)

    def _bind_word(self, word: Word, thing: Thing) -> bool:
        token = word.token
        kinds = self.vocabulary.adjectives.get(token.adjective, {})
        slot = self.slot(token.entry) if token.entry else ""
        kind = "place" if "place" in kinds and self._is_place(thing) else thing.kind
        if kind in kinds:
            self._add_adjective(word, kinds[kind], thing)
        elif slot in BOUND_SLOTS and (thing.matter or slot == "setting"):
            self.add(
                word,
                token.entry,
                thing if slot != "setting" else Thing("surroundings", region="surroundings"),
            )
        elif token.color and thing.kind in self.vocabulary.painted:
            sky = Thing("sky", thing.name, "surroundings")
            self.add(word, token.name or token.text, sky if self._is_hour(thing) else thing)
        elif "otherwise" in kinds and not (token.color and thing.kind == "whole"):
            self._add_adjective(word, kinds["otherwise"], thing)
        else:
            return False
        return True

    def _is_place(self, thing: Thing) -> bool:
        """Whether it is somewhere to be, a kitchen or a beach; a studio's background can be painted."""
        entry = self.vocabulary.synonyms.get(thing.name, "")
        somewhere = thing.kind == "surroundings" and not thing.name.endswith(_PAINTED)
        return somewhere and bool(entry) and self.slot(entry) == "setting"

    def _is_hour(self, thing: Thing) -> bool:
        """Whether it is a time of day with a sky of its own, which colors describe: "purple sunset", but not "sunset light"."""
        return thing.kind == "light" and thing.name in self.vocabulary.lists["hour"]

    def _add_adjective(self, word: Word, entry: str, thing: Thing) -> None:
        slot = self.slot(entry)
        if slot == "setting" and thing.kind not in ("surroundings", "sky"):
            thing = Thing("surroundings", thing.name, "surroundings")
        elif slot not in BOUND_SLOTS:
            thing = replace(thing, region="whole", owners=())
        self.add(word, entry, thing)

    def add(self, word: Word, entry: str, thing: Thing) -> None:
        """Records an attribute; a mood brings those that it stands for."""
        known = entry in self.vocabulary.entries
        opposite = self.vocabulary.entries[entry].opposite if known and word.less else ""
        if opposite and self.slot(entry) != "atmosphere":  # less fog is still fog
            entry, word = opposite, replace(word, strength=_LESS)
        attribute = Attribute(
            word=word.text,
            entry=entry,
            slot=self.slot(entry) if known else "color",
            region=thing.region,
            kind=thing.kind,
            strength=word.strength,
            negated=word.negated,
            owners=thing.owners,
            role=thing.role,
            color=None if known else word.token.color,
            thing=thing.name,
            cause=self.cause,
            guess=bool(word.token.guess),
            shades=word.token.shades if known else (),
            lights=thing.lights,
        )
        self.attributes.append(attribute)
        means = self.vocabulary.entries[entry].means if known else ""
        if means and self.cause:
            raise VibeError(
                f"Vocabulary: '{self.cause}' stands for '{entry}', which itself stands for other words."
            )
        if means and not word.negated:
            inner = self._read_means(means, entry)
            guess = bool(word.token.guess)
            self.attributes += [
                replace(a, strength=a.strength * word.strength, guess=guess) for a in inner.attributes
            ]
