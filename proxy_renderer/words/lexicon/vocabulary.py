# SPDX-License-Identifier: Apache-2.0
"""The vocabulary (vocabulary.toml and colors.txt): all that parser and planner know of words, with mixed colors and kelvins."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Container
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

from ...color.floats import srgb_from_hex
from ...color.shades import mixable, shade, tinged
from ...schema import Values, VibeError
from .entries import Effect, VocabularyEntry, listed, normalize, parse_effect, read_entry
from .quantities import COLORS
from .rigs import rig_table

_SHORTEST_STEM = 2  # characters; a stem has more
# Colors between colors
_ALONE = 0.7  # factor on chroma of a color that is only "greenish"
_TINGE = 0.4  # share of the first color in "greenish blue"
_HALF = 0.5  # in "green blue"
_KIND = 2 / 3  # in "khaki green"
_BASIC = frozenset([*COLORS, "gray"])
_KINDS = _BASIC - {"white", "black"}  # colors that have kinds: "navy white" is two colors
# Color temperatures
_LEAST, _MOST, _STEP = 1300, 15500, 100  # kelvins of the entries
_REACH = 0.03  # share by which a light's kelvins may differ from those of the prompt
_WARM = 4800  # kelvins below which light is warm
_COOL = 7200  # above which it is cool
T = TypeVar("T")


@dataclass(frozen=True)
class Vocabulary:
    """All that parser and planner know of words."""

    entries: dict[str, VocabularyEntry]  # name -> entry
    synonyms: dict[str, str]  # phrase -> entry name
    colors: dict[str, Values]  # color name -> sRGB
    shades: dict[str, dict[str, float]]  # shade word -> keyword arguments: lightness, towards, chroma, warmth
    intensity: dict[str, float]  # phrase -> strength
    lists: dict[str, frozenset[str]]  # "negation", "link", "around", ... -> phrases
    nouns: dict[str, str]  # phrase -> kind of thing
    painted: dict[str, tuple[Effect, ...]]  # kind of thing -> effects of a color word on it
    adjectives: dict[str, dict[str, str]]  # word -> kind of thing (or "otherwise") -> entry name
    absent: dict[str, str]  # kind of thing -> entry that the lack of it means: "no shadows"
    words: dict[str, frozenset[str]]  # "lightness", "off", ... -> words that are looked for by themselves
    roles: dict[str, str]  # word of a light's name -> the role of that light
    typed: dict[str, str]  # word that is typed in a hurry -> the word that is meant
    # kind of thing -> entry or adjective -> entry, where words say nothing of it themselves: "a calm lamp"
    elsewhere: dict[str, dict[str, str]]
    endings: dict[str, str]  # "comparative" or "superlative" -> how such words end
    _made: dict[Callable[[Vocabulary], Any], Any] = field(init=False, repr=False, compare=False, default_factory=dict)

    def made(self, make: Callable[[Vocabulary], T]) -> T:
        """An object that is made of the vocabulary once and kept with it."""
        if make not in self._made:
            self._made[make] = make(self)
        made: T = self._made[make]
        return made

    def entry(self, phrase: str) -> VocabularyEntry | None:
        """The entry of a phrase on its own; None where it is no look."""
        return self.entries.get(self.synonyms.get(phrase, ""))

    def opposite(self, entry: VocabularyEntry) -> VocabularyEntry | None:
        """The entry that an entry names as its opposite; None where it names none."""
        return self.entries.get(entry.opposite)

    def slot(self, phrase: str) -> str:
        """The slot of a phrase on its own; "" where it is no look."""
        entry = self.entry(phrase)
        return entry.slot if entry else ""

    def role(self, name: str) -> str:
        """The role of a light that words name: the key of "key light"; "" for none."""
        return next((self.roles[word] for word in name.split() if word in self.roles), "")

    def stems(self, word: str, degree: str) -> tuple[str, ...]:
        """Words that a "comparative" or "superlative" may be made of: "cold" of "colder", "dry" of "drier"."""
        base = word.removesuffix(self.endings[degree])
        compares = base != word and len(base) > _SHORTEST_STEM
        return (base, base + "e", base[:-1], base[:-1] + "y") if compares else ()


GLOWING = "glowing"  # the entry of what emits light


@cache
def shipped_vocabulary() -> Vocabulary:
    """The vocabulary that is shipped, with the words of the rigs."""
    folder = Path(__file__).parent
    text, colors = (folder / name for name in ("vocabulary.toml", "colors.txt"))
    vocabulary = load(text.read_text("utf-8"), colors.read_text("utf-8"))
    entries, synonyms = dict(vocabulary.entries), dict(vocabulary.synonyms)
    for rig in {rig.name: rig for rig in rig_table().rigs.values()}.values():
        known = next((entry for entry in rig.entries if entry in vocabulary.entries), rig.name)
        if known == rig.name:
            entries.setdefault(rig.name, VocabularyEntry(rig.name, "lighting", rig.words, phrase=rig.name))
        synonyms |= dict.fromkeys((word for word in rig.words if word not in vocabulary.entries), known)
    synonyms |= hour_phrases()
    return replace(vocabulary, entries=entries, synonyms=synonyms)


def load(text: str, colors: str) -> Vocabulary:
    """A vocabulary from the text of a .toml file and of a color list. Raises VibeError, which says what is wrong in it."""
    try:
        rows = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise VibeError(f"The vocabulary cannot be read: {error}.", "Mend that line.") from error
    named = (line.rsplit(" ", 1) for line in colors.splitlines() if line and not line.startswith("#"))
    kelvins = {kelvin_entry(kelvins): _kelvin_rows(kelvins) for kelvins in range(_LEAST, _MOST + 1, _STEP)}
    looks = {normalize(name): row for name, row in rows["look"].items()} | kelvins
    entries = {name: read_entry(name, row) for name, row in looks.items()}
    synonyms: dict[str, str] = {}
    for entry in entries.values():
        check_opposite(entry, entries)
        for word in entry.words:
            synonyms.setdefault(word, entry.name)
    synonyms |= {name: name for name in entries}  # in their order, which decides between equally near words
    adjectives = {normalize(w): {k: normalize(e) for k, e in kinds.items()} for w, kinds in rows["adjective"].items()}
    adjectives |= {name: dict.fromkeys(("light", "fill", "rim", "otherwise"), name) for name in kelvins}
    elsewhere = {kind: _by_word(each) for kind, each in rows["elsewhere"].items()}
    said = [(word, name) for word, kinds in adjectives.items() for name in kinds.values()]
    said += [both for words in elsewhere.values() for both in words.items()]
    for word, name in said:
        if name not in entries:
            raise VibeError(f"Vocabulary: the word '{word}' names no entry '{name}'.", "Name an entry.")
    grammar = rows["grammar"]
    return Vocabulary(
        entries,
        synonyms,
        {normalize(name): srgb_from_hex(code) for name, code in named},
        {normalize(w): row for w, row in rows["shades"].items()},
        {normalize(w): strength for w, strength in grammar["intensity"].items()},
        {kind: frozenset(listed(words)) for kind, words in grammar["lists"].items()},
        _by_word(grammar["nouns"]),
        {kind: tuple(map(parse_effect, effects)) for kind, effects in rows["painted"].items()},
        adjectives,
        grammar.get("absent", {}),
        {kind: frozenset(listed(words)) for kind, words in grammar["words"].items()},
        _by_word(grammar["roles"]),
        _by_word(grammar["typed"]),
        elsewhere,
        grammar["endings"],
    )


def check_opposite(entry: VocabularyEntry, entries: Container[str]) -> None:
    """Raises VibeError if an entry names an opposite that is no entry."""
    if entry.opposite and normalize(entry.opposite) not in entries:
        problem = f"Vocabulary: '{entry.name}' has the unknown opposite '{entry.opposite}'."
        raise VibeError(problem, "Name an entry.")


@cache
def _hours() -> dict[str, Any]:
    return tomllib.loads(Path(__file__).with_name("hours.toml").read_text("utf-8"))


@cache
def hour_phrases() -> dict[str, str]:
    """Phrase for a time of day, or for where light comes from -> its entry."""
    return _by_word(_hours()["phrases"])


def hour_entry(hour: int) -> str:
    """The name of the entry of an hour by the clock, from 0 to 23."""
    since: dict[str, str] = _hours()["from_hour"]
    return since[max((start for start in since if int(start) <= hour), key=int)]


def _by_word(rows: dict[str, str]) -> dict[str, str]:
    """Each of the words of rows -> the name of its row."""
    return {word: name for name, words in rows.items() for word in listed(words)}


# Color temperatures as numbers: "3200 K key light", "a 5600 kelvin softbox"


def kelvin_entry(kelvins: float) -> str:
    """The name of the entry of a color temperature, the nearest that lights can have."""
    return f"{min(max(round(kelvins / _STEP) * _STEP, _LEAST), _MOST)} kelvin"


def _kelvin_rows(kelvins: int) -> dict[str, Any]:
    tint = "warm" if kelvins < _WARM else "cool" if kelvins > _COOL else ""
    range_ = f"{kelvins * (1 - _REACH):.0f}..{kelvins * (1 + _REACH):.0f}"
    return {
        "slot": "lighting",
        "wishes": [*([f"light_color is {tint}"] if tint else []), f"lights/temperature {range_} !1"],
        "phrase": f"{tint or 'neutral'} light",
    }


# Colors between colors: "greenish", "gray-blue", "reddish brown", "khaki green", "bluegreen"


def tending(word: str, colors: dict[str, Values]) -> Values | None:
    """The color that "greenish" and "lemony" tend to; None for other words."""
    if word.removesuffix("y") != word and word[:-1] in colors:
        return colors[word[:-1]]
    color = colors.get(_color_stem(word, colors))
    return shade(color, chroma=_ALONE) if color else None


def compound(words: list[str], colors: dict[str, Values]) -> Values | None:
    """The color of two color words: "khaki green"; None if the list has it, or if they are no color, or two: "teal orange"."""
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


def parted(word: str, colors: dict[str, Values], shades: dict[str, dict[str, float]]) -> list[str]:
    """The words of a color's name that is written as one, "bluegreen" and "lightblue"; else the word alone."""
    for second in _BASIC:
        first = word.removesuffix(second)
        if first != word and word not in colors and (first in colors or first in shades):
            return [first, second]
    return [word]


def _color_stem(word: str, colors: dict[str, Values]) -> str:
    """The color's name in "greenish", "bluey" and "reddy"; "" for other words."""
    for ending in ("ish", "y"):
        base = word.removesuffix(ending)
        found = next((s for s in (base, base[:-1], base + "e") if base != word and s in colors), "")
        if found:
            return found
    return ""
