# SPDX-License-Identifier: Apache-2.0
"""Loads vocabulary.toml and colors.txt: all that the parser and planner know of words."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Container
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

from ...color.floats import srgb_from_hex
from ...schema import Values, VibeError
from . import kelvins
from .entries import Effect, VocabularyEntry, normalize, parse_effect, read_entry
from .rigs import rig_table

_SHORTEST_STEM = 2  # letters; a stem has more
T = TypeVar("T")


@dataclass(frozen=True)
class Vocabulary:
    """All that the parser and planner know.

    Attributes:
        entries: Name -> entry.
        synonyms: Phrase -> entry name.
        colors: Color name -> sRGB.
        shades: Shade word -> keyword arguments: lightness, towards, chroma, warmth.
        intensity: Phrase -> strength.
        lists: "negation", "link", "around", ... -> phrases.
        nouns: Phrase -> kind of thing.
        painted: Kind of thing -> what a color word does to it.
        adjectives: Word -> kind of thing (or "otherwise") -> entry name.
        absent: Kind of thing -> entry that the lack of it means: "no shadows".
        picks: Word -> which one of several it picks out, as in `mentions.picked`.
        words: "lightness", "off", "leave", ... -> words that are looked for by themselves.
        roles: Word of a light's name -> the role of that light.
        typed: What is typed in a hurry -> the word that is meant.
        elsewhere: Kind of thing -> entry or adjective -> entry, where words say nothing of it themselves: "a calm lamp".
        endings: "comparative" or "superlative" -> how such words end.
    """

    entries: dict[str, VocabularyEntry]
    synonyms: dict[str, str]
    colors: dict[str, Values]
    shades: dict[str, dict[str, float]]
    intensity: dict[str, float]
    lists: dict[str, frozenset[str]]
    nouns: dict[str, str]
    painted: dict[str, tuple[Effect, ...]]
    adjectives: dict[str, dict[str, str]]
    absent: dict[str, str]
    picks: dict[str, str]
    words: dict[str, frozenset[str]]
    roles: dict[str, str]
    typed: dict[str, str]
    elsewhere: dict[str, dict[str, str]]
    endings: dict[str, str]
    _made: dict[Callable[[Vocabulary], Any], Any] = field(
        init=False, repr=False, compare=False, default_factory=dict
    )

    def made(self, make: Callable[[Vocabulary], T]) -> T:
        """What is made of it, once and for all."""
        if make not in self._made:
            self._made[make] = make(self)
        made: T = self._made[make]
        return made

    def entry(self, phrase: str) -> VocabularyEntry | None:
        """What a phrase means on its own; None where it is no look."""
        return self.entries.get(self.synonyms.get(phrase, ""))

    def opposite(self, entry: VocabularyEntry) -> VocabularyEntry | None:
        """The entry that an entry names as its opposite; None where it names none."""
        return self.entries.get(entry.opposite)

    def slot(self, phrase: str) -> str:
        """The slot of what a phrase means on its own; "" where it is no look."""
        entry = self.entry(phrase)
        return entry.slot if entry else ""

    def stems(self, word: str, degree: str) -> tuple[str, ...]:
        """What a word may be made of if it compares: "cold" of "colder", "dry" of "drier".

        Args:
            degree: "comparative" or "superlative".
        """
        base = word.removesuffix(self.endings[degree])
        compares = base != word and len(base) > _SHORTEST_STEM
        return (base, base + "e", base[:-1], base[:-1] + "y") if compares else ()


def as_meant(word: str) -> str:
    """A word as the readers have it: normalized, and spelled out where it was typed in a hurry."""
    plain = normalize(word)
    return shipped_vocabulary().typed.get(plain, plain)


def _read_colors(text: str) -> dict[str, Values]:
    rows = (line.rsplit(" ", 1) for line in text.splitlines() if line and not line.startswith("#"))
    return {normalize(name): srgb_from_hex(code) for name, code in rows}


def load(text: str, colors: str) -> Vocabulary:
    """Builds a vocabulary from the text of a .toml file and of a color list.

    Raises:
        VibeError: Something in it is not what it should be; says what.
    """
    try:
        rows = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise VibeError(f"The vocabulary cannot be read: {error}.", "Mend that line.") from error
    looks = {normalize(name): row for name, row in rows["look"].items()} | kelvins.entries()
    entries = {name: read_entry(name, row) for name, row in looks.items()}
    synonyms: dict[str, str] = {}
    for word, name in ((word, entry.name) for entry in entries.values() for word in entry.words):
        synonyms.setdefault(word, name)
    synonyms |= {name: name for name in entries}  # at their places, which decide between words as near
    adjectives = {
        normalize(w): {k: normalize(e) for k, e in kinds.items()} for w, kinds in rows["adjective"].items()
    } | kelvins.adjectives()
    _check_links(entries, adjectives)
    grammar = rows["grammar"]
    return Vocabulary(
        entries,
        synonyms,
        _read_colors(colors),
        {normalize(w): row for w, row in rows["shades"].items()},
        {normalize(w): strength for w, strength in grammar["intensity"].items()},
        {kind: _words(words) for kind, words in grammar["lists"].items()},
        _by_word(grammar["nouns"]),
        {kind: tuple(map(parse_effect, effects)) for kind, effects in rows["painted"].items()},
        adjectives,
        grammar.get("absent", {}),
        _by_word(grammar["picks"]),
        {kind: _words(words) for kind, words in grammar["words"].items()},
        _by_word(grammar["roles"]),
        _by_word(grammar["typed"]),
        _read_elsewhere(rows["elsewhere"], entries, adjectives),
        grammar["endings"],
    )


def _with_rigs(vocabulary: Vocabulary) -> Vocabulary:
    """A vocabulary with the words of the rigs: those that it lacks are look words of their own."""
    entries, synonyms = dict(vocabulary.entries), dict(vocabulary.synonyms)
    for rig in {rig.name: rig for rig in rig_table().rigs.values()}.values():
        known = next((entry for entry in rig.entries if entry in vocabulary.entries), rig.name)
        if known == rig.name:
            entries.setdefault(rig.name, VocabularyEntry(rig.name, "lighting", rig.words, phrase=rig.name))
        synonyms |= dict.fromkeys((word for word in rig.words if word not in vocabulary.entries), known)
    return replace(vocabulary, entries=entries, synonyms=synonyms)


def _check_links(entries: dict[str, VocabularyEntry], adjectives: dict[str, dict[str, str]]) -> None:
    """Raises VibeError where an opposite, or what an adjective stands for, is no entry."""
    for entry in entries.values():
        check_opposite(entry, entries)
    for word, kinds in adjectives.items():
        if unknown := ", ".join({*kinds.values()} - entries.keys()):
            problem = f"Vocabulary: the adjective '{word}' names no entry '{unknown}'."
            raise VibeError(problem, "Name an entry.")


def check_opposite(entry: VocabularyEntry, entries: Container[str]) -> None:
    """Raises VibeError where the opposite of an entry is none."""
    if entry.opposite and normalize(entry.opposite) not in entries:
        problem = f"Vocabulary: '{entry.name}' has the unknown opposite '{entry.opposite}'."
        raise VibeError(problem, "Name an entry.")


def _read_elsewhere(
    rows: dict[str, dict[str, str]],
    entries: dict[str, VocabularyEntry],
    adjectives: dict[str, dict[str, str]],
) -> dict[str, dict[str, str]]:
    """The rows of [elsewhere], by the words that they list."""
    found: dict[str, dict[str, str]] = {kind: {} for kind in rows}
    for kind, entry, word in (
        (k, e, normalize(w)) for k in rows for e in rows[k] for w in rows[k][e].split(",")
    ):
        if entry not in entries or (word not in entries and word not in adjectives):
            unknown = word if entry in entries else entry
            raise VibeError(
                f"Vocabulary: '{unknown}' at a {kind} is neither entry nor adjective.", "Name one."
            )
        if word in found[kind]:
            raise VibeError(f"Vocabulary: '{word}' at a {kind} is in two rows.", "Keep one.")
        found[kind][word] = entry
    return found


def _words(text: str) -> frozenset[str]:
    return frozenset(map(normalize, text.split(",")))


def _by_word(rows: dict[str, str]) -> dict[str, str]:
    """Each of the words of rows -> the name of its row."""
    return {normalize(word): name for name, words in rows.items() for word in words.split(",")}


@cache
def shipped_vocabulary() -> Vocabulary:
    """The vocabulary that is shipped."""
    folder = Path(__file__).parent
    text, colors = (folder / name for name in ("vocabulary.toml", "colors.txt"))
    return _with_rigs(load(text.read_text("utf-8"), colors.read_text("utf-8")))
