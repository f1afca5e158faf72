# SPDX-License-Identifier: Apache-2.0
"""What look words of a prompt may describe in its scene."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from ..mentions.nouns import REGIONS, NounMention, materials_of, taken
from ..names import is_detail
from ..types import SceneDescription

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
_OF_NOUNS = {
    "surroundings": "surroundings", "sky": "sky", "light": "light", "fill": "fill", "rim": "rim", "fog": "air",
    "shadow": "shadow", "highlight": "highlight", "tone": "picture", "subject": "subject", "others": "others", "unknown": "subject",
}  # fmt: skip


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


def targets(mentions: list[NounMention], words: SceneDescription) -> list[Target]:
    """All of a prompt."""
    found = [Target(kind) for kind in UNNAMED]
    for number, mention in enumerate(mentions):
        found += _of_mention(number, mention, mentions, words)
    return found


def _of_mention(
    number: int, mention: NounMention, mentions: list[NounMention], words: SceneDescription
) -> Iterator[Target]:
    for named in mention.named:
        yield Target(named.kind, named.names, number, named.signs)
    kind = mention.role or _OF_NOUNS.get(mention.noun, "")
    if kind:
        theirs = frozenset(name for name, light in words.lights.items() if light.role == kind)
        names = rest(mentions, words) if kind == "others" else theirs
        yield Target(kind, names, number, frozenset({f"noun {mention.noun}"}))
    if not mention.spared:
        yield from _without(number, mention, mentions, words)


def _without(
    number: int, mention: NounMention, mentions: list[NounMention], words: SceneDescription
) -> Iterator[Target]:
    """What a noun names without what other nouns name of it: "the robot, not the cables", "the hut red, its roof black"."""
    things = [(n.names, n.signs) for n in mention.named if n.kind == "things"]
    spared = taken((m for m in mentions if m.spared), words)
    whole = _region(mention, mentions, words)
    for names, signs in (*things, (whole, frozenset({"a region"}))):
        if names & spared and names - spared:
            yield Target("things", names - spared, number, signs | {"without what is spared"})
    others = [taken([m], words) for m in mentions if m.members == 1 and m is not mention and not m.spared]
    for names, signs in things:
        parts = frozenset().union(*(other for other in others if other < names))
        if parts and names - parts:
            yield Target("things", names - parts, number, signs | {"without what else is named"})


def _region(mention: NounMention, mentions: list[NounMention], words: SceneDescription) -> frozenset[str]:
    """The part of the picture that a noun means from which something is left out later: "her outfit, not the ribbon"."""
    before = any(m.spared and m.start > mention.end for m in mentions)
    return materials_of(REGIONS.get(mention.noun, ""), words) if before else frozenset()


def rest(
    mentions: list[NounMention], words: SceneDescription, described: frozenset[str] = frozenset()
) -> frozenset[str]:
    """All materials that a prompt neither names nor leaves out; details only if nothing else is left.

    Args:
        described: Materials that are something else's.
    """
    left = frozenset(words.materials) - taken(mentions, words) - described
    return frozenset(n for n in left if not is_detail(n)) or left
