# SPDX-License-Identifier: Apache-2.0
"""Cuts a prompt into clauses of tokens: words and known phrases with every role that they can play."""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from operator import ne

from ..color.floats import is_hex, srgb_from_hex
from ..color.shades import mixable, shade, tinged
from ..schema import Values
from .lexicon.entries import normalize
from .lexicon.languages import Nearest, singular, table, thing_words
from .lexicon.quantities import COLORS
from .lexicon.vocabulary import Vocabulary
from .names import scene_names
from .types import SceneDescription

TIES = ("link", "around", "joiner", "comparison", "exception")  # they say how neighbors belong together
_LONGEST = 5  # words in a phrase
_SHORTEST, _SHORTEST_FOREIGN = 4, 6  # characters of a word that may be mistyped
_COMPARED = ("finish", "grade", "mood", "atmosphere")  # slots of "glossier", "moodier", "drier"
_NAME_ALIKE, _ALIKE = 0.86, 0.84  # least similarity, by difflib, of a mistyped name and of any other word
# Colors between colors
_ALONE = 0.7  # factor on chroma of a color that is only "greenish"
_TINGE = 0.4  # share of the first color in "greenish blue"
_HALF = 0.5  # in "green blue"
_KIND = 2 / 3  # in "khaki green"
_BASIC = frozenset([*COLORS, "gray"])
_KINDS = _BASIC - {"white", "black"}  # colors that have kinds: "navy white" is two colors
_BREAK = re.compile(r"[.,;:!?()\[\]{}<>|\n\"*=+]|#(?![0-9a-f]{6}\b)|\s[-–—/]\s|/|(?<=\bon)\s(?=with\b)")
_WORD = re.compile(r"#[0-9a-f]{6}\b|[^\W_]+(?:'[a-z]+)?")  # a word, or a color by its number: "#c8102e"
_SLASH = re.compile(r"(?<=[A-Za-z])/(?=[A-Za-z])")  # "blue/green"


@dataclass
class Token:
    """One word or known phrase of the prompt, with every role that it can play."""

    text: str  # as the prompt has it, normalized
    entry: str = ""  # name of the vocabulary entry that it means
    color: Values | None = None  # sRGB, if it names a color
    adjective: str = ""  # a key of the vocabulary's adjectives
    noun: str = ""  # kind of thing that it names: "light", "fog", "surroundings"
    scene: bool = False  # it names a thing in the scene
    strength: float | None = None  # factor on the next look word, if it is an intensity
    lists: frozenset[str] = field(default_factory=frozenset)  # the vocabulary's grammar lists with it: "link", ...
    name: str = ""  # the spelling that the vocabulary knows
    guess: str = ""  # the known word that is meant, if it is misspelled
    unsure: bool = False  # unknown, but near to look words by meaning: not used, and known words are offered for it
    shades: tuple[tuple[float, float, float, float], ...] = ()  # of the shade words before it, see `types.Attribute`
    clause: int = 0  # number of its clause
    wished: bool = False  # it is part of a request that values cannot fulfill: "remove the chair"
    presents: tuple[Token, ...] = ()  # looks that it has now: of the roof, "red" in "the roof from red to grey"
    change: int = 0  # number of the change phrase ("roof from red to grey") with this object or wished look; 0: none

    @property
    def known(self) -> bool:
        """True if it has any role: look, noun, name in the scene, intensity or word of the grammar."""
        return bool(self.names_a_look or self.noun or self.scene or self.strength or self.lists)

    @property
    def ties(self) -> bool:
        """True if it only says how its neighbors belong together: "of", "with", "than"."""
        return not (self.entry or self.lists.isdisjoint(TIES))

    @property
    def filler(self) -> bool:
        """True if it says nothing: articles and the like."""
        return "stop" in self.lists and not (self.names_a_look or self.noun)

    @property
    def names_a_look(self) -> bool:
        """True if it can be a look word."""
        return bool(self.entry or self.color or self.adjective)


class Lexer:
    """Cuts a prompt into tokens, the longest known phrases first; made for each prompt, because its scene adds names.

    `foreign` has words of another language; only long ones ("travertin") are taken for misspelled English.
    """

    def __init__(self, vocabulary: Vocabulary, words: SceneDescription, foreign: Collection[str] = ()) -> None:
        self.vocabulary, self.foreign = vocabulary, {*map(normalize, foreign)}
        self.names = {name for name in scene_names(words) if not self._is_look(name)}
        self._in_names = {word for name in self.names for word in name.split()}

    def _is_look(self, name: str) -> bool:
        """True if a name in the scene only describes a look, such as "matte black"; in a prompt, it means that look."""
        v, words = self.vocabulary, name.split()
        looks = (word in v.colors or word in v.adjectives or v.slot(word) == "finish" for word in words)
        return len(words) > 1 and all(looks) and v.nouns.keys().isdisjoint(words)

    def clauses(self, prompt: str) -> list[list[Token]]:
        """The clauses of a prompt, each as the list of its tokens."""
        text = normalize(_SLASH.sub(" ", prompt.replace("&", " and ")))
        words = [_WORD.findall(part) for part in _BREAK.split(text)]
        return [self._tokens(self._spelled(part)) for part in words if part]

    def _spelled(self, words: list[str]) -> list[str]:
        """The words of a clause, with hurried spellings, a final "on" and compounds ("bluegreen") written in full."""
        v, found = self.vocabulary, list[str]()
        if len(words) > 1 and words[-1] in v.words["burns"]:
            (burning,) = v.words["burning"]
            words = [*words[:-1], *burning.split()]
        for word in (w if w in self._in_names else v.typed.get(w, w) for w in words):
            known = any(word in table for table in (v.synonyms, v.nouns, self.names, v.colors))
            splits = ((word.removesuffix(second), second) for second in _BASIC if word.endswith(second))
            parted = next((two for two in splits if two[0] in v.colors or two[0] in v.shades), (word,))
            found += [word] if known else parted
        return found

    def _tokens(self, words: list[str]) -> list[Token]:
        tokens: list[Token] = []
        start = 0
        while start < len(words):
            if tokens and self._places(words[start:], tokens[-1]):
                tokens.append(replace(self._phrase(f"from {words[start]}"), text=words[start]))
                start += 1
                continue
            for count in range(min(_LONGEST, len(words) - start), 0, -1):
                part = words[start : start + count]
                if self._ends_in_thing(part):
                    continue
                cuts = self._cuts_a_phrase(words, start, start + count)
                token = (None if cuts else _composed(part, self.vocabulary)) or self._phrase(" ".join(part))
                if token.known or count == 1:
                    tokens.append(token if token.known else self._guess(token))
                    start += count
                    break
        return tokens

    def _places(self, words: list[str], light: Token) -> bool:
        """True if `words`, after the token `light`, say where that comes from: "behind it", not "behind the hills"."""
        is_light = light.noun == "light" or self.vocabulary.slot(light.entry) == "lighting"
        if light.scene or not is_light or words[0] not in self.vocabulary.words["placed"]:
            return False
        return len(words) < 3 or (what := self._phrase(words[2])).scene or what.noun == "subject"

    def _cuts_a_phrase(self, words: list[str], start: int, end: int) -> bool:
        """True if words[start:end] split a known phrase that is not of surfaces: "warm golden" splits "golden hour"."""
        later = range(end + 1, min(end + _LONGEST, len(words) + 1))
        phrases = (" ".join(words[i:j]) for i in range(start + 1, end) for j in later)
        return any(self.vocabulary.slot(phrase) not in ("", "finish", "material") for phrase in phrases)

    def _ends_in_thing(self, words: list[str]) -> bool:
        """True if `words` are a look and then an object of the scene, so two tokens: "terracotta pot"."""
        v, last, first, whole = self.vocabulary, words[-1], " ".join(words[:-1]), " ".join(words)
        if len(words) < 2 or last not in self.names:
            return False
        if whole in self.names and v.slot(first) != "material":  # "leather seat" is of leather all the same
            return False
        if v.nouns.get(whole) in ("rim", "fill"):  # "rim light" is one noun, though the scene has a rim and a light
            return False
        looks = first in v.colors or (first in v.shades and whole not in v.synonyms)
        may_be_thing = last not in v.colors and (last not in v.synonyms or looks)
        return may_be_thing and self._phrase(first).known

    def _phrase(self, text: str) -> Token:
        """The token of a phrase, known as it stands, without an ending or as a comparative ("cooler"), or unknown."""
        v = self.vocabulary
        if is_hex(text):
            return Token(text, color=srgb_from_hex(text))
        # "lemony", or "greenish", which is a paler green
        lemony = v.colors.get(text[:-1]) if text.endswith("y") else None
        greenish = v.colors.get(_color_stem(text, v.colors))
        tint = lemony or (shade(greenish, chroma=_ALONE) if greenish else None)
        # Base forms; "car parked" is not a form of "car park", nor "walled" of "wall"
        bases = [text.removesuffix("s"), text.removesuffix("es")]
        past = text.removesuffix("ed")
        bases += [] if " " in text or past in v.nouns else [past]
        for token in map(self._spelled_so, (text, *(base for base in bases if len(base) > 2))):
            if token.known:
                return replace(token, text=text, color=token.color or tint)
        for stem in (stem for degree in v.endings for stem in v.stems(text, degree)):
            if stem in v.adjectives or stem in v.colors or v.slot(stem) in _COMPARED:
                return replace(self._phrase(stem), text=text)
        return Token(text, color=tint)

    def _spelled_so(self, spelling: str) -> Token:
        """The token of exactly this spelling, with every role that it has in the vocabulary and the scene."""
        v = self.vocabulary
        # phrases for a setting end in the thing: "minimal backdrop"
        last = spelling.rpartition(" ")[2] if v.slot(spelling) == "setting" else ""
        return Token(
            spelling,
            v.synonyms.get(spelling, ""),
            v.colors.get(spelling),
            spelling if spelling in v.adjectives else "",
            v.nouns.get(spelling) or v.nouns.get(last, ""),
            spelling in self.names,
            v.intensity.get(spelling),
            frozenset(kind for kind, phrases in v.lists.items() if spelling in phrases),
            name=spelling,
        )

    def _guess(self, token: Token) -> Token:
        """The token of the known word that an unknown token misspells; else the same token. Sets its `unsure`, too."""
        text, foreign = token.text, token.text in self.foreign
        is_thing = singular(text) in thing_words()
        token.unsure = not (foreign or is_thing) and self.vocabulary.made(Nearest).may_be_a_look(text)
        if len(text) < (_SHORTEST_FOREIGN if foreign else _SHORTEST) or table().is_english(text):
            return token
        spelling = self.vocabulary.made(_misspellable)
        swapped = [w for w in spelling if sorted(w) == sorted(text) and sum(map(ne, w, text)) == 2]  # "wihte", "balck"
        near = swapped or get_close_matches(text, self.names, 1, _NAME_ALIKE)
        near = near or get_close_matches(text, spelling, 3, _ALIKE)
        # if the first character is right, an error is likelier than a rare word
        known = next((w for w in near if w[0] == text[0]), "")
        return replace(self._phrase(known), text=text, guess=known) if known else token


def _misspellable(v: Vocabulary) -> list[str]:
    return sorted(w for w in {*v.synonyms, *v.colors, *v.adjectives} if " " not in w and len(w) > 3)


# Colors and materials with words that shift them: "warm golden", "very dark blue", "dark walnut", "khaki green"


def _composed(words: list[str], v: Vocabulary) -> Token | None:
    """The token of a color or material after words that shift it: "very dark blue"; None for other words."""
    text = " ".join(words)
    if v.slot(text) == "grade":  # "deep blacks" are shadows
        return None
    if color := _compound(words, v.colors):
        return Token(text, color=color, name=text)
    for split in range(1, 1 if text in v.colors else len(words)):
        leading, rest = words[:split], words[split:]
        listed = " ".join(rest) in v.colors and rest[0] in v.shades
        if listed and all(v.intensity.get(w, 0) > 1 for w in leading):  # "very dark blue" is darker than "dark blue"
            leading = rest[:1]
        leads = leading[-1] in v.shades and all(w in v.shades or w in v.intensity for w in leading)
        if leads and (token := _shaded(leading, rest, v)):
            return token
    return None


def _shaded(leading: list[str], rest: list[str], v: Vocabulary) -> Token | None:
    """The token of a color or material `rest` after shade words `leading`: "dusty rose", "dark oak"; or None."""
    last = " ".join(rest)
    name = last if last in v.colors else last.removesuffix("s")
    text, entry = " ".join([*leading, last]), v.entry(last)
    color = v.colors.get(name) or _compound(rest, v.colors)
    # Arguments of `color.shade`, those of the word next to the color first; an intensity scales the next word's
    shades = []
    for before, word in [*zip(["", *leading], leading, strict=False)][::-1]:
        if word in v.shades:
            row, strength = v.shades[word], v.intensity.get(before, 1.0)
            strength = max(strength, strength**2)
            lightness = max(1 - (1 - row.get("lightness", 1.0)) * strength, 0.05)
            chroma = 1 - (1 - row.get("chroma", 1.0)) * strength
            shades.append((lightness, chroma, row.get("towards", 60.0), row.get("warmth", 0.0) * strength))
    if color and v.slot(last) != "grade":  # "faded sepia" is no paler brown
        for arguments in shades:
            color = shade(color, *arguments)
        # "dark copper": a color, and what the adjective means elsewhere
        both = leading[-1] in v.words["lightness"] and last in v.adjectives
        token = Token(text, color=color, name=" ".join([*leading, name]))
        return replace(token, adjective=last, shades=tuple(shades)) if both else token
    tints = entry and entry.slot == "material" and any(e.name == "base_color" for e in entry.effects)
    if entry and tints and leading[-1] in v.words["lightness"] and text not in v.synonyms:
        return Token(text, entry.name, name=text, shades=tuple(shades))
    return None


def _compound(words: list[str], colors: dict[str, Values]) -> Values | None:
    """The color, sRGB, of two words that mix, as "khaki green"; None if `colors` has the phrase or they do not mix."""
    if len(words) != 2 or " ".join(words) in colors or words[1] not in colors:
        return None
    first, base = words[0], colors[words[1]]
    if first not in colors:
        tinge = colors.get(_color_stem(first, colors))
        return tinged(base, tinge, _TINGE) if tinge else None
    two = first == words[1] or (first in _BASIC - _KINDS) or words[1] not in _KINDS
    if two or not mixable(base, colors[first]):
        return None
    return tinged(base, colors[first], _HALF if first in _BASIC else _KIND)


def _color_stem(word: str, colors: dict[str, Values]) -> str:
    """The color's name in a word such as "greenish", "bluey" or "reddy"; "" for other words."""
    for ending in ("ish", "y"):
        base = word.removesuffix(ending)
        found = next((s for s in (base, base[:-1], base + "e") if base != word and s in colors), "")
        if found:
            return found
    return ""
