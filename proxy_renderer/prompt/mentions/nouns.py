# SPDX-License-Identifier: Apache-2.0
"""The nouns of a prompt, and what they name in its scene."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from ..types import SceneDescription
from .names import FITS

REGIONS = {"surroundings": "surroundings", "subject": "subject", "unknown": "subject"}
"""Kinds of nouns that mean a part of the picture where nothing of the scene is called so -> the part."""

_VAGUE = FITS.index("misspelled")  # from here on a name is only guessed


@dataclass(frozen=True)
class Named:
    """Materials or lights that words may name.

    Attributes:
        kind: "things" or "lights".
        names: Of materials, or of lights; glows among lights start with `GLOW`.
        signs: How it was found: "object exact", "material part", "first", "several".
    """

    kind: str
    names: frozenset[str]
    signs: frozenset[str]


@dataclass(frozen=True)
class NounMention:
    """A noun, or several that belong together ("box and cup").

    Attributes:
        start: Place of its first item.
        end: Place of its last item.
        text: As the prompt says it.
        noun: Kind of thing by the vocabulary's nouns; "others" for what was not named, "unknown" for a word that nobody knows.
        role: "key", "fill" or "rim", where it names one.
        named: What it may name in the scene.
        members: Of several nouns, how many.
        spared: The prompt leaves it out: "everything but the floor".
    """

    start: int
    end: int
    text: str
    noun: str = ""
    role: str = ""
    named: tuple[Named, ...] = ()
    members: int = 1
    spared: bool = False

    def covers(self, index: int) -> bool:
        """Whether an item is one of its own."""
        return self.start <= index <= self.end


def fit_rank(named: Named) -> int:
    """How sure what is named is meant, 0 for the surest."""
    return min((FITS.index(way) for way in _ways(named.signs).values()), default=len(FITS))


def fit_signs(named: Named) -> frozenset[str]:
    """The signs that say how well words fit its name: "object exact"."""
    return frozenset(_ways(named.signs))


def _ways(signs: frozenset[str]) -> dict[str, str]:
    return {sign: way for sign in signs for way in FITS if sign.endswith(f" {way}")}


def surest(mention: NounMention, kind: str, first: str) -> Named | None:
    """The surest of what a mention names; None if it names nothing of a kind.

    Args:
        kind: "things" or "lights".
        first: What is preferred: "material" or "object" for a source, "first" or "whole" for a part or all of a thing.
    """

    def rank(named: Named) -> tuple[int, bool]:
        return fit_rank(named), not any(sign.startswith(first) for sign in named.signs)

    return min((n for n in mention.named if n.kind == kind), key=rank, default=None)


def materials_of(region: str, words: SceneDescription) -> frozenset[str]:
    """The materials of a part of the picture.

    Args:
        region: "subject" or "surroundings".
    """
    return frozenset(name for name, its in words.materials.items() if its == region)


def taken(mentions: Iterable[NounMention], words: SceneDescription) -> frozenset[str]:
    """The materials that nouns name in the surest way; what is left out by a word that no name has is the subject."""
    names: set[str] = set()
    for mention in mentions:
        best = surest(mention, "things", "object") if mention.members == 1 else None
        vague = best is None or fit_rank(best) >= _VAGUE
        if mention.spared and vague:
            names |= materials_of(REGIONS.get(mention.noun, ""), words)
        names |= best.names if best else set()
    return frozenset(names)
