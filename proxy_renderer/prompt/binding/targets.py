# SPDX-License-Identifier: Apache-2.0
"""What look words of a prompt may describe in its scene."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from ..mentions.scene import NounMention
from ..types import SceneWords

MATTER = ("things", "subject", "surroundings", "others")
"""Kinds of targets that have a surface."""
LAMPS = ("lights", "key", "fill", "rim")
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


def targets(mentions: list[NounMention], words: SceneWords) -> list[Target]:
    """All of a prompt.

    Args:
        mentions: The prompt's.
        words: The names in the scene.
    """
    found = [Target(kind) for kind in UNNAMED]
    for number, mention in enumerate(mentions):
        found += _of_mention(number, mention, words)
    return found


def _of_mention(number: int, mention: NounMention, words: SceneWords) -> Iterator[Target]:
    for named in mention.named:
        yield Target(named.kind, named.names, number, named.signs)
    kind = mention.role or _OF_NOUNS.get(mention.noun, "")
    if kind:
        theirs = frozenset(name for name, light in words.lights.items() if light.role == kind)
        yield Target(kind, theirs, number, frozenset({f"noun {mention.noun}"}))
