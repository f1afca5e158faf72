# SPDX-License-Identifier: Apache-2.0
"""What nouns name together that are listed with nothing said between them: "box and cup", "bezel, strap and dial"."""

from __future__ import annotations

from collections.abc import Iterator

from ..types import SceneDescription
from .nouns import REGIONS, Named, NounMention, fit_rank, fit_signs, materials_of, surest


def joined(run: list[NounMention], words: SceneDescription) -> NounMention | None:
    """One mention of several: what each names in the surest way, once of all sources and once of materials; None if nothing."""
    if not any(mention.named for mention in run):
        return None
    named = {(n.kind, n.names): n for n in reversed([*_unions(run, words)])}
    text = " and ".join(mention.text for mention in run)
    spared = all(mention.spared for mention in run)
    return NounMention(
        run[0].start, run[-1].end, text, named=tuple(named.values()), members=len(run), spared=spared
    )


def _unions(run: list[NounMention], words: SceneDescription) -> Iterator[Named]:
    for kind, first in (
        (k, f) for k in ("things", "lights") for f in ("material", "object", "first", "whole")
    ):
        each = [surest(m, kind, first) or _region(m, kind, words) for m in run]
        every = [named for named in each if named]
        if len(every) == len(run):
            names = frozenset().union(*(n.names for n in every))
            shared = frozenset.intersection(*(n.signs for n in every))
            least_sure = fit_signs(max(every, key=fit_rank))  # a list is no surer
            yield Named(kind, names, shared | least_sure | {"joined", f"joined {first}"})


def _region(mention: NounMention, kind: str, words: SceneDescription) -> Named | None:
    """The part of the picture that a noun without a name means: "ground" all that lies around."""
    region = "" if mention.noun == "unknown" else REGIONS.get(mention.noun, "")
    names = materials_of(region, words) if kind == "things" else frozenset()
    return Named(kind, names, frozenset()) if names else None
