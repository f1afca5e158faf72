# SPDX-License-Identifier: Apache-2.0
"""Nouns that are listed with nothing said between them: "box and cup", "bezel, strap and dial"."""

from __future__ import annotations

from collections.abc import Iterator

from ..types import SceneWords
from .nouns import REGIONS, Named, NounMention, fit_rank, fit_signs, materials_of, surest
from .passage import Passage


def joined(passage: Passage, single: list[NounMention], words: SceneWords) -> Iterator[NounMention]:
    """One mention of each list of nouns.

    Args:
        passage: The prompt.
        single: Its nouns.
        words: The names in the scene.
    """
    run: list[NounMention] = []
    starts = {m.start for m in single}
    for mention in [m for m in single if m.named or (m.noun in REGIONS and m.end + 1 not in starts)]:
        if run and not _are_joined(passage, run[-1], mention):
            yield from _union(run, words)
            run = []
        run.append(mention)
    yield from _union(run, words)


def _are_joined(passage: Passage, one: NounMention, other: NounMention) -> bool:
    """Whether only "and" or a comma is between two nouns; the other may have a word before it: "mugs and tea tag"."""
    between = passage.content(one.end + 1, other.start)
    apart = passage.items[other.start].clause - passage.items[one.end].clause
    listed = ["listing" in item.token.lists for item in between]
    named = bool(one.named and other.named)  # "that armchair, it stays" lists nothing
    if any("again" in item.token.lists for item in passage.items[one.end + 1 : other.start]):
        return False
    tied = all(listed) or (listed[0] and len(listed) == 2 and not between[1].token.known)
    return tied and (apart == 1 and named if apart else bool(between))


def _union(run: list[NounMention], words: SceneWords) -> Iterator[NounMention]:
    """One mention of several: what each of them names in the surest way, once of all sources and once of materials."""
    if len(run) < 2 or not any(mention.named for mention in run):
        return
    named = []
    for kind in ("things", "lights"):
        for first in ("material", "object", "first", "whole"):
            each = [surest(m, kind, first) or _region(m, kind, words) for m in run]
            every = [n for n in each if n]
            if len(every) == len(run):
                names = frozenset().union(*(n.names for n in every))
                signs = frozenset.intersection(*(n.signs for n in every)) | _least_sure(every)
                named.append(Named(kind, names, signs | {"joined", f"joined {first}"}))
    unique = {(n.kind, n.names): n for n in reversed(named)}
    text = " and ".join(mention.text for mention in run)
    yield NounMention(
        run[0].start,
        run[-1].end,
        text,
        named=tuple(unique.values()),
        members=len(run),
        spared=all(mention.spared for mention in run),
    )


def _least_sure(every: list[Named]) -> frozenset[str]:
    """How the one of several is found that is the least sure: a list is no surer."""
    return fit_signs(max(every, key=fit_rank))


def _region(mention: NounMention, kind: str, words: SceneWords) -> Named | None:
    """The part of the picture that a noun without a name means: "ground" all that lies around."""
    names = materials_of(REGIONS.get(mention.noun, ""), words) if kind == "things" else frozenset()
    return Named(kind, names, frozenset()) if names else None
