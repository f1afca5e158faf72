# SPDX-License-Identifier: Apache-2.0
"""Cuts a prompt into clauses of tokens."""

from __future__ import annotations

import re
from collections.abc import Collection, Container
from dataclasses import replace
from difflib import get_close_matches
from functools import cached_property
from operator import ne

from .lexicon.entries import normalize
from .lexicon.nearest import Nearest
from .lexicon.spelling import singular
from .lexicon.things import thing_words
from .lexicon.tinges import parted, tending, unslashed
from .lexicon.vocabulary import Vocabulary
from .lexicon.word_table import table
from .names import scene_names
from .tokens import Token, composed
from .types import SceneDescription

_LONGEST = 5  # words in a phrase
_SHORTEST, _SHORTEST_FOREIGN = 4, 6  # letters of a word that may be mistyped
_COMPARED = ("finish", "grade", "mood", "atmosphere")
"""Slots of words of which there can be more: "glossier", "moodier", "drier"."""
_NAME_ALIKE, _ALIKE = 0.86, 0.84  # share of letters that a mistyped name, and any other word, has right
_BREAK = re.compile(r"[.,;:!?()\[\]{}<>|\n\"*#=+]|\s[-–—/]\s|/")


class Lexer:
    """Finds the longest known phrases; built once per prompt, as scenes bring their own names.

    Args:
        foreign: Words of another language: only long ones may be English ones with a mistake, "travertin".
    """

    def __init__(
        self, vocabulary: Vocabulary, words: SceneDescription, foreign: Collection[str] = ()
    ) -> None:
        self.vocabulary, self.foreign = vocabulary, foreign
        self.names = scene_names(words)

    def clauses(self, prompt: str) -> list[list[Token]]:
        """Tokens of each clause of a prompt."""
        text = unslashed(re.sub(r"\s*&\s*", " and ", prompt), self.vocabulary.colors)
        text = normalize(text)
        words = [re.findall(r"[^\W_]+(?:'[a-z]+)?", part) for part in _BREAK.split(text)]
        return [self._tokens(self._gathered(self._parted(self._spelled(part)))) for part in words if part]

    def _spelled(self, words: list[str]) -> list[str]:
        """The words that are meant by those typed in a hurry, and by "on" at the end."""
        if len(words) > 1 and words[-1] in self.vocabulary.words["burns"]:
            (burning,) = self.vocabulary.words["burning"]
            words = [*words[:-1], *burning.split()]
        return [w if w in self._in_names else self.vocabulary.typed.get(w, w) for w in words]

    @cached_property
    def _in_names(self) -> frozenset[str]:
        """All words of names in the scene."""
        return frozenset(word for name in self.names for word in name.split())

    def _parted(self, words: list[str]) -> list[str]:
        """The words, with a space in "bluegreen" and "lightblue"."""
        v = self.vocabulary
        known = [any(word in table for table in (v.synonyms, v.nouns, self.names)) for word in words]
        each = zip(words, known, strict=True)
        return [
            part
            for word, is_known in each
            for part in ([word] if is_known else parted(word, v.colors, v.shades))
        ]

    def _gathered(self, words: list[str]) -> list[str]:
        """ "Deep glossy blue" as "glossy deep blue": a shade is its color's, whatever stands between them."""
        v, words = self.vocabulary, list(words)
        for i in range(len(words) - 2):
            shade_, between, color = words[i : i + 3]
            finish = v.slot(between) in ("finish", "material") and between not in v.colors
            if shade_ in v.shades and finish and color in v.colors:
                words[i : i + 2] = between, shade_
        return words

    def _tokens(self, words: list[str]) -> list[Token]:
        tokens: list[Token] = []
        start = 0
        while start < len(words):
            for count in range(min(_LONGEST, len(words) - start), 0, -1):
                part = words[start : start + count]
                if self._ends_in_thing(part) or self._begins_with_thing(words, start, start + count):
                    continue
                cuts = self._cuts_a_phrase(words, start, start + count)
                token = (None if cuts else composed(part, self.vocabulary)) or self._phrase(" ".join(part))
                if token.known or count == 1:
                    end = self._end(words, start, start + count, token.entry)
                    token = token if end == start + count else replace(token, text=" ".join(words[start:end]))
                    tokens.append(token if token.known else self._guess(token))
                    start = end
                    break
        return tokens

    def _phrase(self, text: str) -> Token:
        """What a phrase is: as it stands, without an ending, or as what it compares."""
        tint = tending(text, self.vocabulary.colors)
        for token in map(self._spelled_so, _spellings(text, self.vocabulary.nouns)):
            if token.known:
                return replace(token, text=text, color=token.color or tint)
        return self._compared(text) or Token(text, color=tint)

    def _spelled_so(self, spelling: str) -> Token:
        """A token with every role that a spelling has."""
        v, in_scene = self.vocabulary, spelling in self.names
        lists = (kind for kind, phrases in v.lists.items() if spelling in phrases)
        return Token(
            spelling,
            v.synonyms.get(spelling, ""),
            v.colors.get(spelling),
            spelling if spelling in v.adjectives else "",
            v.nouns.get(spelling, "") or self._head_noun(spelling),
            in_scene,
            v.intensity.get(spelling),
            frozenset(kind for kind in lists if kind != "beyond" or not in_scene),
            name=spelling,
        )

    def _compared(self, text: str) -> Token | None:
        """ "Cooler" and "glossiest" as what they compare: an adjective, a finish or a mood."""
        v = self.vocabulary
        for stem in (stem for degree in v.endings for stem in v.stems(text, degree)):
            if stem in v.adjectives or stem in v.colors or v.slot(stem) in _COMPARED:
                return replace(self._phrase(stem), text=text)
        return None

    def _head_noun(self, text: str) -> str:
        """Phrases for a setting end in the thing itself: "minimal backdrop"."""
        is_setting = self.vocabulary.slot(text) == "setting"
        return self.vocabulary.nouns.get(text.rpartition(" ")[2], "") if is_setting else ""

    def _ends_in_thing(self, words: list[str]) -> bool:
        """Whether a phrase is a look and a thing of this scene: "terracotta pot", or "turquoise water" where water is."""
        v, last = self.vocabulary, words[-1]
        first = " ".join(words[:-1])
        named = (
            " ".join(words) in self.names and v.slot(first) != "material"
        )  # "leather seat" is of leather all the same
        if len(words) < 2 or last not in self.names or named:
            return False
        looks = first in v.colors or (first in v.shades and " ".join(words) not in v.synonyms)
        may_be_thing = last not in v.colors and (last not in v.synonyms or looks)
        return may_be_thing and self._phrase(first).known

    def _begins_with_thing(self, words: list[str], start: int, end: int) -> bool:
        """Whether "the bottle green" is a thing of this scene and its color: no other thing follows that is bottle green."""
        definite = start > 0 and words[start - 1] in self.vocabulary.lists["definite"]
        if end - start != 2 or not definite or words[start] not in self.names:
            return False
        of_another = end < len(words) and (words[end] in self.names or words[end] in self.vocabulary.nouns)
        return words[start + 1] in self.vocabulary.colors and not of_another

    def _end(self, words: list[str], start: int, end: int, entry: str) -> int:
        """Where what names an entry ends: "light from the camera's side" is two phrases of one entry, the second inside of the first."""
        synonyms = self.vocabulary.synonyms
        later = range(min(end + _LONGEST - 1, len(words)), end, -1)
        ends = (
            j for j in later for i in range(start + 1, end) if synonyms.get(" ".join(words[i:j])) == entry
        )
        return next(ends, end) if entry else end

    def _cuts_a_phrase(self, words: list[str], start: int, end: int) -> bool:
        """Whether words from start to end take the first word of a listed phrase: "warm golden" of "golden hour"."""
        later = range(end + 1, min(end + _LONGEST, len(words) + 1))
        synonyms = self.vocabulary.synonyms
        return any(" ".join(words[i:j]) in synonyms for i in range(start + 1, end) for j in later)

    def _guess(self, token: Token) -> Token:
        """The known word that is meant, where the other one can only be a slip of the keyboard."""
        foreign = token.text in self.foreign
        is_thing = singular(token.text) in thing_words().rows
        token.unsure = not (foreign or is_thing) and self.vocabulary.made(Nearest).may_be_a_look(token.text)
        if len(token.text) < (_SHORTEST_FOREIGN if foreign else _SHORTEST) or table().is_english(token.text):
            return token
        spelling = self.vocabulary.made(_spelling)
        near = (
            [w for w in spelling if _is_swapped(w, token.text)]
            or get_close_matches(token.text, self.names, 1, _NAME_ALIKE)
            or get_close_matches(token.text, spelling, 3, _ALIKE)
        )
        known = next((w for w in near if w[0] == token.text[0]), "")  # likelier than a rare word
        return replace(self._phrase(known), text=token.text, guess=known) if known else token


def _spellings(text: str, nouns: Container[str]) -> list[str]:
    """A phrase, and what it may be a form of; "car parked" is no car park, and "walled" no wall."""
    bases = [text.removesuffix("s"), text.removesuffix("es")]
    past = text.removesuffix("ed")
    bases += [] if " " in text or past in nouns else [past]
    return [text, *(base for base in bases if len(base) > 2)]


def _spelling(v: Vocabulary) -> list[str]:
    """Look words that may be misspelled."""
    return sorted(w for w in {*v.synonyms, *v.colors, *v.adjectives} if " " not in w and len(w) > 3)


def _is_swapped(word: str, typed: str) -> bool:
    """Whether two letters inside a word changed places: "wihte", "balck"."""
    return sorted(word) == sorted(typed) and sum(map(ne, word, typed)) == 2
