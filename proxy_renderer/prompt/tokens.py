# SPDX-License-Identifier: Apache-2.0
"""Cuts a prompt into clauses of tokens; a token knows every role that its phrase can play."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from functools import cached_property

from ..color.shades import shade
from ..schema import Values
from .lexicon.nearest import Guess, nearest, table
from .lexicon.tinges import compound, parted, tending, unslashed
from .lexicon.vocabulary import Vocabulary, VocabularyEntry, normalize
from .names import SceneName, in_parts, scene_names
from .types import SceneWords

_LONGEST = 5  # words in a phrase
_COMPARED = ("finish", "grade", "mood", "atmosphere")
"""Slots of words of which there can be more: "glossier", "moodier", "drier"."""
_BREAK = re.compile(r"[.,;:!?()\[\]{}<>|\n\"*#=+]|\s[-–—/]\s|/")


@dataclass
class Token:
    """One word or known phrase of the prompt.

    Attributes:
        text: As the prompt has it, normalized.
        entry: Vocabulary entry that it names; "" for none.
        color: sRGB of the color that it names.
        adjective: A key of the vocabulary's adjectives; "" for none.
        noun: Kind of thing that it names; "" for none.
        scene: The thing in the scene that it names.
        strength: What it multiplies the next look word with, if it is an intensity.
        lists: Names of the grammar lists that it is in: "negation", "link", ...
        name: The spelling that the vocabulary knows.
        guess: It is misspelled or unknown, and this is the nearest known word.
        near: What an unknown word may mean; the parser decides whether it stands where a look word can.
        shades: What shade words before it do to a material's color, see `types.Attribute`.
    """

    text: str
    entry: str = ""
    color: Values | None = None
    adjective: str = ""
    noun: str = ""
    scene: SceneName | None = None
    strength: float | None = None
    lists: frozenset[str] = field(default_factory=frozenset)
    name: str = ""
    guess: str = ""
    near: Guess | None = None
    shades: tuple[tuple[float, float, float, float], ...] = ()

    @property
    def known(self) -> bool:
        """Whether it plays any role."""
        look = self.entry or self.color or self.adjective or self.noun or self.scene
        return bool(look or self.strength or self.lists)


class Lexer:
    """Finds the longest known phrases; built once per prompt, as scenes bring their own names."""

    def __init__(self, vocabulary: Vocabulary, words: SceneWords) -> None:
        self.vocabulary = vocabulary
        self.names, self._in_parts = scene_names(words), in_parts(words)

    @cached_property
    def _spelling(self) -> list[str]:
        v = self.vocabulary
        return sorted(w for w in {*v.synonyms, *v.colors, *v.adjectives} if " " not in w and len(w) > 3)

    def clauses(self, prompt: str) -> list[list[Token]]:
        """Tokens of each clause of a prompt."""
        text = unslashed(re.sub(r"\s*&\s*", " and ", prompt), self.vocabulary.colors)
        text = normalize(text)
        words = [re.findall(r"[^\W_]+(?:'[a-z]+)?", part) for part in _BREAK.split(text)]
        return [self._tokens(self._gathered(self._parted(self._spelled(part)))) for part in words if part]

    def _spelled(self, words: list[str]) -> list[str]:
        """The words that are meant by those typed in a hurry."""
        return [w if w in self._in_names else self.vocabulary.typed.get(w, w) for w in words]

    @cached_property
    def _in_names(self) -> frozenset[str]:
        """All words of names in the scene."""
        return frozenset(word for name in self.names for word in name.split())

    def _parted(self, words: list[str]) -> list[str]:
        """The words, with a space in "bluegreen" and "lightblue"."""
        v = self.vocabulary
        known = v.synonyms.keys() | v.nouns.keys() | self.names.keys()
        return [
            part for word in words for part in ([word] if word in known else parted(word, v.colors, v.shades))
        ]

    def _gathered(self, words: list[str]) -> list[str]:
        """ "Deep glossy blue" as "glossy deep blue": a shade is its color's, whatever stands between them."""
        v, words = self.vocabulary, list(words)
        for i in range(len(words) - 2):
            shade_, between, color = words[i : i + 3]
            entry = self._entry(between)
            finish = entry is not None and entry.slot in ("finish", "material") and between not in v.colors
            if shade_ in v.shades and finish and color in v.colors:
                words[i : i + 2] = between, shade_
        return words

    def _tokens(self, words: list[str]) -> list[Token]:
        tokens: list[Token] = []
        start = 0
        while start < len(words):
            for count in range(min(_LONGEST, len(words) - start), 0, -1):
                part = words[start : start + count]
                if self._ends_in_thing(part):
                    continue
                composed = None if self._cuts_a_phrase(words, start, start + count) else self._composed(part)
                token = composed or self._phrase(" ".join(part))
                if token.known or count == 1:
                    tokens.append(token if token.known else self._guess(token))
                    start += count
                    break
        return tokens

    def _phrase(self, text: str) -> Token:
        v = self.vocabulary
        for spelling in (text, text.removesuffix("s"), text.removesuffix("es"), text.removesuffix("ed")):
            if len(spelling) < 3 and spelling != text:
                continue
            if text == spelling + "ed" and (
                " " in text or spelling in v.nouns
            ):  # "car parked" is no car park
                continue
            token = Token(
                text,
                v.synonyms.get(spelling, ""),
                v.colors.get(spelling),
                spelling if spelling in v.adjectives else "",
                v.nouns.get(spelling, "") or self._head_noun(spelling),
                self.names.get(spelling),
                v.intensity.get(spelling),
                frozenset(kind for kind, phrases in v.lists.items() if spelling in phrases),
            )
            if token.known:
                token.name = spelling
                token.color = token.color or tending(text, v.colors)
                return token
        return self._compared(text) or Token(text, color=tending(text, v.colors))

    def _compared(self, text: str) -> Token | None:
        """ "Cooler" and "glossiest" as what they compare: an adjective, a finish or a mood."""
        v = self.vocabulary
        for stem in (stem for degree in v.endings for stem in v.stems(text, degree)):
            entry = self._entry(stem)
            compares = entry is not None and entry.slot in _COMPARED
            if stem in v.adjectives or stem in v.colors or compares:
                return replace(self._phrase(stem), text=text)
        return None

    def _head_noun(self, text: str) -> str:
        """Phrases for a setting end in the thing itself: "minimal backdrop"."""
        v, entry = self.vocabulary, self._entry(text)
        return v.nouns.get(text.rpartition(" ")[2], "") if entry and entry.slot == "setting" else ""

    def _ends_in_thing(self, words: list[str]) -> bool:
        """Whether a phrase is a look and a thing of this scene: "terracotta pot", or "turquoise water" where water is."""
        v, last = self.vocabulary, words[-1]
        if len(words) < 2 or last not in self.names or " ".join(words) in self.names:
            return False
        first = " ".join(words[:-1])
        looks = first in v.colors or (first in v.shades and " ".join(words) not in v.synonyms)
        may_be_thing = last not in v.colors and (last not in v.synonyms or looks)
        return may_be_thing and self._phrase(first).known

    def _cuts_a_phrase(self, words: list[str], start: int, end: int) -> bool:
        """Whether words from start to end take the first word of a listed phrase: "warm golden" of "golden hour"."""
        later = range(end + 1, min(end + _LONGEST, len(words) + 1))
        synonyms = self.vocabulary.synonyms
        return any(" ".join(words[i:j]) in synonyms for i in range(start + 1, end) for j in later)

    def _composed(self, words: list[str]) -> Token | None:
        """A color or material with the words that shift it: "warm golden", "very dark blue", "dark walnut"."""
        return self._tinged(words) or self._shaded(words) or self._shaded_material(words)

    def _tinged(self, words: list[str]) -> Token | None:
        colors = self.vocabulary.colors
        made_of = words[0] in colors and self._entry(words[0])  # "ruby red lips" are red
        color = None if made_of else compound(words, colors)
        return Token(" ".join(words), color=color, name=" ".join(words)) if color else None

    def _shaded(self, words: list[str]) -> Token | None:
        """A color with shade words before it: "very dark blue", "dusty rose"."""
        v = self.vocabulary
        for split in range(1, len(words)):
            last = " ".join(words[split:])
            color = v.colors.get(last) or v.colors.get(last.removesuffix("s"))
            color = color or compound(words[split:], v.colors)
            leading = words[:split]
            if (
                last in v.colors
                and words[split] in v.shades
                and all(v.intensity.get(w, 0) > 1 for w in leading)
            ):
                leading = [words[split]]  # "very dark blue" is darker than the dark blue of the list
            if (
                color
                and all(w in v.shades or v.intensity.get(w) for w in leading)
                and leading[-1] in v.shades
            ):
                if " ".join(words) in v.colors or self._is_grade(last):
                    return None
                shades = self._shades(leading)
                for arguments in shades:
                    color = shade(color, *arguments)
                both = _lightness_only(leading) and last in v.adjectives
                name = " ".join([*leading, last if last in v.colors else last.removesuffix("s")])
                return Token(
                    " ".join(words), "", color, last if both else "", name=name, shades=shades if both else ()
                )
        return None

    def _entry(self, text: str) -> VocabularyEntry | None:
        """What a phrase means on its own, if it is one."""
        return self.vocabulary.entries.get(self.vocabulary.synonyms.get(text, ""))

    def _is_grade(self, text: str) -> bool:
        """Whether a color's name says how a picture is graded: "faded sepia" is both, and no paler brown."""
        entry = self._entry(text)
        return entry is not None and entry.slot == "grade"

    def _shaded_material(self, words: list[str]) -> Token | None:
        """A material with its own color, lighter or darker: "dark oak", "very pale wood"."""
        v = self.vocabulary
        for split in range(1, len(words)):
            leading, rest = words[:split], " ".join(words[split:])
            entry = self._entry(rest)
            fits = leading[-1] in v.shades and all(w in v.shades or v.intensity.get(w) for w in leading)
            if not (entry and entry.slot == "material" and fits and _lightness_only(leading)):
                continue
            colored = any(e.name == "base_color" and e.mode in ("", "color") for e in entry.effects)
            if colored and " ".join(words) not in v.synonyms:
                return Token(" ".join(words), entry.name, name=rest, shades=self._shades(leading))
        return None

    def _shades(self, leading: list[str]) -> tuple[tuple[float, float, float, float], ...]:
        """Arguments of `color.shade` for shade words, the one next to the color first."""
        v, found = self.vocabulary, []
        for position in range(len(leading) - 1, -1, -1):
            if leading[position] in v.shades:
                before = leading[position - 1] if position else ""
                found.append(_shade(v.shades[leading[position]], v.intensity.get(before, 1.0)))
        return tuple(found)

    def _may_be_called(self, word: str) -> list[str]:
        """Names of what a thing may be: "a red car" is none of its four wheels, nor its bonnet."""
        if word.endswith("s"):
            return list(self.names)
        return [
            name
            for name, thing in self.names.items()
            if not (thing.several or (self._in_parts and thing.region == "subject"))
        ]

    def _guess(self, token: Token) -> Token:
        """The nearest known word, where it can only be a slip of the keyboard."""
        if same := table().same_sort(token.text, self._may_be_called(token.text)):
            token.scene, token.guess, token.name = self.names[same], self.names[same].name, same
            return token
        token.near = nearest(self.vocabulary).guess(token.text)
        if len(token.text) < 4 or table().is_english(token.text):
            return token
        swapped = [w for w in self._spelling if _is_swapped(w, token.text)]
        for known in swapped or [
            *(
                get_close_matches(token.text, self.names, 1, 0.86)
                or get_close_matches(token.text, self._spelling, 3, 0.84)
            )
        ]:
            if known[0] == token.text[0]:
                meant = self._phrase(known)
                meant.text, meant.guess = token.text, known
                return meant  # a slip of the keyboard is likelier than a rare word
        return token


def _is_swapped(word: str, typed: str) -> bool:
    """Whether two letters inside a word changed places: "wihte", "balck"."""
    if len(word) != len(typed):
        return False
    return sum(a != b for a, b in zip(word, typed, strict=True)) == 2 and sorted(word) == sorted(typed)


def _shade(row: dict[str, float], strength: float) -> tuple[float, float, float, float]:
    """Arguments of `color.shade` for one shade word; "very" does the same to it again, "slightly" half of it."""
    strength = strength**2 if strength > 1 else strength
    lightness = max(1 - (1 - row.get("lightness", 1.0)) * strength, 0.05)
    tinted = 1 - (1 - row.get("chroma", 1.0)) * strength
    return lightness, tinted, row.get("towards", 60.0), row.get("warmth", 0.0) * strength


def _lightness_only(leading: list[str]) -> bool:
    """Whether shade words say how light a thing is, and nothing that a light or a finish could mean too."""
    return leading[-1] in ("dark", "darker", "light", "lighter", "pale")
