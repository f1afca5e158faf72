# SPDX-License-Identifier: Apache-2.0
"""What a look word becomes where it describes a kind of thing: "gold" is a metal on a bowl and a color on light."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from ..lexicon.entries import OWNERS
from ..lexicon.vocabulary import Vocabulary
from ..tokens import Token
from .targets import LAMPS, MATTER, NOWHERE

SURFACE = ("finish", "material", "color")
"""Slots of words about a surface."""
_KINDS = {
    "things": ("thing", "subject", "surroundings"), "subject": ("thing", "subject"), "surroundings": ("surroundings", "subject", "thing"),
    "others": ("thing", "subject", "surroundings"), "lights": ("lamp", "light"), "key": ("lamp", "light"),
    "fill": ("lamp", "fill", "light"), "rim": ("lamp", "rim", "light"), "light": ("light",), "shadow": ("shadow",), "highlight": ("highlight",),
    "sky": ("sky",), "air": ("fog",), "picture": ("tone",),
}  # fmt: skip
"""Kind of target -> kinds of things that the vocabulary's adjectives know, the first one first."""
_SLOTS = {
    "surroundings": ("setting",), "sky": ("setting", "lighting", "atmosphere"), "air": ("atmosphere",),
    "light": ("lighting",), "shadow": ("lighting", "grade"), "highlight": ("lighting", "grade", "finish"), "picture": ("lighting", "atmosphere", "grade", "mood", "setting"),
}  # fmt: skip
"""Kind of target -> slots of words that describe it, beside surfaces and particular lights."""


@dataclass(frozen=True)
class Becoming:
    """What a look word is at a target.

    Attributes:
        entry: Of the vocabulary; "" for the color that the word names.
        slot: Of the entry.
        way: "row" of the vocabulary's adjectives, "own" entry, "color", "otherwise", or "elsewhere".
    """

    entry: str
    slot: str
    way: str


def becoming(token: Token, kind: str, vocabulary: Vocabulary) -> Becoming | None:
    """What a word becomes at a kind of target; None if it cannot describe it."""
    if kind in NOWHERE:
        return Becoming("", "", "own")
    rows = vocabulary.adjectives.get(token.adjective, {})
    said = [("row", rows.get(k, "")) for k in _KINDS[kind]] + [("own", token.entry)]
    if kind == "picture" and token.entry and vocabulary.entries[token.entry].slot == "grade":
        said.reverse()  # "dark" says more than "dark tones"
    if token.color:
        said.append(("color", ""))
    said.append(("otherwise", rows.get("otherwise", "")))
    for way, entry in [*said, *(("elsewhere", e) for e in _elsewhere(token, kind, vocabulary))]:
        if way == "color":
            return Becoming("", "color", way)
        told = way == "row" and kind == "light" and entry == rows.get(kind)  # "a glowing light" blooms
        if entry and (told or _describes(entry, kind, vocabulary)):
            return Becoming(entry, vocabulary.entries[entry].slot, way)
    return None


def _elsewhere(token: Token, kind: str, vocabulary: Vocabulary) -> Iterator[str]:
    """What a word is at a kind of target of which it says nothing itself; of a mood, what a part of its meaning is there."""
    rows = [vocabulary.elsewhere.get(k, {}) for k in _KINDS[kind]]
    means = vocabulary.entries[token.entry].means if token.entry else ""
    for said in (token.adjective, token.entry, *_parts(means, vocabulary)):
        yield from (row[said] for row in rows if said in row)


def _parts(means: str, vocabulary: Vocabulary) -> Iterator[str]:
    """The entries that a mood stands for, without how strongly: "slightly dim light" as "dim light"."""
    for part in means.split(", "):
        words = part.split()
        ends = (" ".join(words[start:]) for start in range(len(words)))
        yield next((vocabulary.synonyms[end] for end in ends if end in vocabulary.synonyms), "")


def _describes(entry: str, kind: str, vocabulary: Vocabulary) -> bool:
    """Whether an entry says something of a kind of target."""
    slot = vocabulary.entries[entry].slot
    if kind in LAMPS:
        effects = vocabulary.entries[entry].effects
        return any(OWNERS[e.owner] == "light" and not e.weak for e in effects) and slot == "lighting"
    if kind in MATTER and slot in SURFACE:
        return True
    return slot in _SLOTS.get(kind, ())
