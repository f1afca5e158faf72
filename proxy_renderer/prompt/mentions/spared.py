# SPDX-License-Identifier: Apache-2.0
"""The nouns of a prompt that are left out: "the floor" of "everything but the floor", "the cables" of "not the cables"."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from ..types import SceneWords
from .names import FITS
from .nouns import REGIONS, NounMention, fit_rank, materials_of, surest
from .passage import Item, Passage

_VAGUE = FITS.index("alike")  # from here on a name is only guessed


def with_spared(passage: Passage, single: list[NounMention]) -> list[NounMention]:
    """The mentions of a prompt, those marked that it leaves out.

    Args:
        passage: The prompt.
        single: Its mentions.
    """
    spared = {*_after_exceptions(passage, single), *_before_refusals(passage, single)}
    return [replace(m, spared=True) if m.start in spared else m for m in single]


def taken(mentions: Iterable[NounMention], words: SceneWords) -> frozenset[str]:
    """The materials that nouns name in the surest way; what is left out by a word that no name has is the subject.

    Args:
        mentions: The nouns.
        words: The names in the scene.
    """
    names: set[str] = set()
    for mention in mentions:
        best = surest(mention, "things", "object") if mention.members == 1 else None
        vague = best is None or fit_rank(best) >= _VAGUE
        if mention.spared and vague:
            names |= materials_of(REGIONS.get(mention.noun, ""), words)
        names |= best.names if best else set()
    return frozenset(names)


def _after_exceptions(passage: Passage, single: list[NounMention]) -> Iterator[int]:
    """Places of nouns that an exception stands before, and of those that are listed with them."""
    starts = {mention.start: mention for mention in single}
    leads, clause, until = "", -1, -1
    for place, item in enumerate(passage.items):
        if item.clause != clause:
            leads, clause = "", item.clause
        if found := _leaves_out(passage, place, single):
            leads = found
        elif (mention := starts.get(place)) and leads:
            until = mention.end
            if leads == "exception" or (_is_a_thing(mention) and not item.names_a_look):
                yield place
            leads = leads if _is_listed_on(passage, mention) else ""
        elif place > until and not _goes_on(item, leads):
            leads = ""


def _leaves_out(passage: Passage, place: int, single: list[NounMention]) -> str:
    """Whether what follows an item is left out: by "except", by "but" after "everything", or by "not"."""
    lists = passage.items[place].token.lists
    if "exception" in lists or ("save" in lists and _takes_from_all(passage, place, single)):
        return "exception"
    return "refusal" if "refusal" in lists else ""


def _takes_from_all(passage: Passage, place: int, single: list[NounMention]) -> bool:
    """Whether "but" takes something from all: right after it, or behind its look, before a noun that has no look after it."""
    items, clause = passage.items, passage.items[place].clause
    of_all = ["others" in item.token.lists for item in items[:place] if item.clause == clause]
    noun = next((m for m in single if m.start > place and items[m.start].clause == clause), None)
    if noun is None or not any(of_all):
        return False
    return of_all[-1] or not any(i.names_a_look for i in passage.ahead(noun.end))


def _is_listed_on(passage: Passage, mention: NounMention) -> bool:
    """Whether a list goes on after a noun: "except the umbrella and the shoes"."""
    after = next(iter(passage.content(mention.end + 1, len(passage.items))), None)
    return after is not None and "listing" in after.token.lists


def _is_a_thing(mention: NounMention) -> bool:
    return any(named.kind == "things" for named in mention.named)


def _goes_on(item: Item, leads: str) -> bool:
    """Whether an item may stand between what leaves something out and its noun: "except the red boat and the pier"."""
    return item.filler or "listing" in item.token.lists or (leads == "exception" and item.names_a_look)


def _before_refusals(passage: Passage, single: list[NounMention]) -> Iterator[int]:
    """Places of nouns that are left out by what follows: "the buckle excepted", "the grid not"."""
    for mention in single:
        ahead = [item.token.lists for item in passage.ahead(mention.end)]
        refused = ahead and ("spared" in ahead[0] or (len(ahead) == 1 and "refusal" in ahead[0]))
        if refused and _is_a_thing(mention):
            yield mention.start
