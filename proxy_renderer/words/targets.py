# SPDX-License-Identifier: Apache-2.0
"""Targets: what the look words of a prompt may describe in its scene, and what a word is there ("gold" is a metal on a bowl)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from .lexer import Token
from .lexicon.entries import OWNERS
from .lexicon.vocabulary import Vocabulary
from .names import is_detail
from .passage import Passage, PromptLook
from .scene import NounMention, taken
from .types import SceneWords

MATTER = ("things", "subject", "surroundings", "others")
"""Kinds of targets that have a surface."""
ROLES = ("key", "fill", "rim")
"""Kinds of targets that are the lights of a role."""
LAMPS = ("lights", *ROLES)
"""Kinds of targets that are some of the lights."""
UNNAMED = ("subject", "surroundings", "light", "sky", "air", "picture", "none")
"""Kinds of targets that a prompt need not name."""
TINGE = "tinge"
"""Kind of target of a word that only says which shade the color after it is: "fire red"."""
NOWHERE = ("none", TINGE)
"""Kinds of targets that change nothing."""
SURFACE = ("finish", "material", "color")
"""Slots of words about a surface."""
_OF_NOUNS = {
    "surroundings": "surroundings", "sky": "sky", "light": "light", "fill": "fill", "rim": "rim", "fog": "air",
    "shadow": "shadow", "highlight": "highlight", "tone": "picture", "subject": "subject", "others": "others", "unknown": "subject",
}  # fmt: skip
"""Kind of noun -> kind of target."""
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
"""Kind of target -> slots of words that describe it, besides surfaces and particular lights."""


@dataclass(frozen=True)
class Target:
    """Something that a look word may describe.

    Attributes:
        kind: "things", "lights", "shadow", "highlight", one of the labels of `UNNAMED`, "others", "key", "fill", "rim" or `TINGE`.
        names: Of the materials or lights; empty where the kind says it all.
        mention: Number of the mention that names it; -1 if none does.
        signs: How its names were found.
    """

    kind: str
    names: frozenset[str] = frozenset()
    mention: int = -1
    signs: frozenset[str] = field(default=frozenset(), compare=False)

    def __str__(self) -> str:
        return f"{self.kind}: {' + '.join(sorted(self.names))}" if self.names else self.kind


@dataclass(frozen=True)
class Sense:
    """The sense of a look word at a target.

    Attributes:
        entry: Of the vocabulary; "" for the color that the word names.
        slot: Of the entry.
        way: "row" of the vocabulary's adjectives, "own" entry, "color", "otherwise", or "elsewhere".
    """

    entry: str
    slot: str
    way: str


@dataclass(frozen=True)
class TargetPair:
    """A look word with something that it may describe.

    Attributes:
        sense: Of the word there.
        features: Facts about the two, each once, in order: sums are the same in every process.
        names_itself: The look word is in the noun that names the target: "sunlight".
        chosen: Name of the target that the artist has chosen; "" where the reader has.
    """

    look: PromptLook
    target: Target
    sense: Sense
    features: tuple[str, ...]
    names_itself: bool = False
    chosen: str = ""


@dataclass(frozen=True)
class PromptPairs:
    """A prompt with its open questions: `pairs` has those of each look word, in the order of the passage's."""

    passage: Passage
    mentions: list[NounMention]
    pairs: list[list[TargetPair]]


def targets(mentions: list[NounMention], words: SceneWords) -> list[Target]:
    """All targets of a prompt."""
    found = [Target(kind) for kind in UNNAMED]
    for number, mention in enumerate(mentions):
        found += (Target(named.kind, named.names, number, named.signs) for named in mention.named)
        if kind := mention.role or _OF_NOUNS.get(mention.noun, ""):
            theirs = frozenset(name for name, light in words.lights.items() if light.role == kind)
            names = rest(mentions, words) if kind == "others" else theirs
            found.append(Target(kind, names, number, frozenset({f"noun {mention.noun}"})))
        if not mention.excepted:
            found += _without(number, mention, mentions, words)
    return found


def _without(
    number: int, mention: NounMention, mentions: list[NounMention], words: SceneWords
) -> Iterator[Target]:
    """Materials of a noun without those of other nouns: "the robot, not the cables", "the hut red, its roof black"."""
    things = [(n.names, n.signs) for n in mention.named if n.kind == "things"]
    excepted = taken((m for m in mentions if m.excepted), words)
    for names, signs in things:
        if names & excepted and names - excepted:
            yield Target("things", names - excepted, number, signs | {"without what is spared"})
    others = [taken([m], words) for m in mentions if m.members == 1 and m is not mention and not m.excepted]
    for names, signs in things:
        parts = frozenset().union(*(other for other in others if other < names))
        if parts and names - parts:
            yield Target("things", names - parts, number, signs | {"without what else is named"})


def rest(
    mentions: list[NounMention], words: SceneWords, described: frozenset[str] = frozenset()
) -> frozenset[str]:
    """All materials that a prompt neither names nor leaves out; details only if nothing else is left.

    Args:
        described: Materials that are something else's.
    """
    left = frozenset(words.materials) - taken(mentions, words) - described
    return frozenset(n for n in left if not is_detail(n)) or left


def sense_at(token: Token, kind: str, vocabulary: Vocabulary) -> Sense | None:
    """The sense of a word at a kind of target; None if it cannot describe it."""
    if kind in NOWHERE:
        return Sense("", "", "own")
    rows = vocabulary.adjectives.get(token.adjective, {})
    senses = [("row", rows.get(k, "")) for k in _KINDS[kind]] + [("own", token.entry)]
    if kind == "picture" and token.entry and vocabulary.entries[token.entry].slot == "grade":
        senses.reverse()  # "dark" says more than "dark tones"
    if token.color:
        senses.append(("color", ""))
    senses.append(("otherwise", rows.get("otherwise", "")))
    for way, entry in [*senses, *(("elsewhere", e) for e in _elsewhere(token, kind, vocabulary))]:
        if way == "color":
            return Sense("", "color", way)
        blooms = way == "row" and kind == "light" and entry == rows.get(kind)  # "a glowing light"
        if entry and (blooms or _describes(entry, kind, vocabulary)):
            return Sense(entry, vocabulary.entries[entry].slot, way)
    return None


def _elsewhere(token: Token, kind: str, vocabulary: Vocabulary) -> Iterator[str]:
    """Senses at a kind of target of which a word says nothing itself; of a mood, those of the parts of its meaning."""
    rows = [vocabulary.elsewhere.get(k, {}) for k in _KINDS[kind]]
    said = [token.adjective, token.entry]
    for part in vocabulary.entries[token.entry].means.split(", ") if token.entry else ():
        words = part.split()  # without how strongly: "slightly dim light" as "dim light"
        ends = (" ".join(words[start:]) for start in range(len(words)))
        said.append(next((vocabulary.synonyms[end] for end in ends if end in vocabulary.synonyms), ""))
    yield from (row[word] for word in said for row in rows if word in row)


def _describes(entry: str, kind: str, vocabulary: Vocabulary) -> bool:
    """Whether an entry says something of a kind of target."""
    slot = vocabulary.entries[entry].slot
    if kind in LAMPS:
        effects = vocabulary.entries[entry].effects
        return any(OWNERS[e.owner] == "light" and not e.weak for e in effects) and slot == "lighting"
    return (kind in MATTER and slot in SURFACE) or slot in _SLOTS.get(kind, ())
