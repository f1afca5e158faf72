# SPDX-License-Identifier: Apache-2.0
"""How a look word and a noun stand to each other: side, distance, clause, what stands between and before."""

from __future__ import annotations

from collections.abc import Iterator

from ..mentions.nouns import NounMention
from ..mentions.passage import TIES
from .clauses import ClauseForms

_FAR = 4  # items from which distance says no more
_NEAR = {0: "same clause", 1: "next clause"}


class NounPlace:
    """A noun as seen from a look word.

    Args:
        forms: The clauses of the prompt.
        look: Place of the look word.
        mention: The noun.

    Attributes:
        side: Whether the noun stands "after" the look word or "before" it.
        where: The side, and how many clauses the nearer ends of the two are apart.
    """

    def __init__(self, forms: ClauseForms, look: int, mention: NounMention) -> None:
        self.passage, self.mentions, self.forms = forms.passage, forms.mentions, forms
        self.look, self.mention = look, mention
        after = mention.start > look
        self.side = "after" if after else "before"
        self._low, self._high = (look, mention.start) if after else (mention.end, look)
        self._between = self.passage.content(self._low + 1, self._high)
        items = self.passage.items
        self._apart = items[self._high].clause - items[self._low].clause
        self.where = f"{self.side}, {_NEAR.get(self._apart, 'far clause')}"

    def facts(self, kind: str, sort: str) -> Iterator[str]:
        """All that their places say.

        Args:
            kind: Of the target, in short.
            sort: Of the look word.
        """
        where, forms, clause = self.where, self.forms, self.passage.items[self.look].clause
        low, high = self._low, self._high
        nouns = sum(1 for m in self.mentions if m.members == 1 and low < m.start and m.end < high)
        looks = sum(1 for i in forms.look_at if low < i < high)
        yield where
        yield f"{where}: {kind}"
        yield f"{where}: {min(len(self._between), _FAR)} between"
        yield f"{where}: {min(nouns, 2)} nouns between"
        yield f"{where}: {min(looks, 2)} looks between"
        yield f"{where}: {forms.order} first"
        yield f"{where}: look led by {forms.lead(self.look)}"
        yield f"{where}: clause {forms.ends[clause]}"
        yield f"{where}: {self._rival()}"
        if not self._between and not self._apart:
            yield f"{self.side}: {kind} adjoins a {sort} word"
        yield from self._ties()
        yield from self._led()
        yield from self._of_noun()

    def _rival(self) -> str:
        """Whether a noun on the other side of the look word is nearer."""
        items, content, look = self.passage.items, self.passage.content, self.look
        near = [m for m in self.mentions if m.members == 1 and items[m.start].clause == items[look].clause]
        if self.side == "after":
            others = [content(m.end + 1, look) for m in near if m.end < look]
        else:
            others = [content(look + 1, m.start) for m in near if m.start > look]
        if not others:
            return "no rival"
        difference = min(map(len, others)) - len(self._between)
        return "rival nearer" if difference < 0 else "rival farther" if difference > 0 else "rival"

    def _ties(self) -> Iterator[str]:
        """What ties stand between the two."""
        for place in range(self._low + 1, self._high):
            if self.passage.items[place].ties:
                over = f"{self.where} over {self.passage.items[place].token.text}"
                looks = range(place, self._high) if self.side == "after" else ()
                own = not self.forms.look_at.isdisjoint(looks)
                yield from (over, f"{over}, {'with' if own else 'without'} a look after it")

    def _led(self) -> Iterator[str]:
        """What ties the noun to what stands before it: "than the leather"."""
        items, start = self.passage.items, self.mention.start
        for item in (items[p] for p in reversed(self.forms.places[items[start].clause]) if p < start):
            if item.ties:
                yield f"{self.where} led by {item.token.text}"
                yield from (f"{self.where} led by a {tie}" for tie in TIES if tie in item.token.lists)
            if not item.filler:
                return
        if not items[start].filler:
            yield f"{self.where}: first of its clause"

    def _of_noun(self) -> Iterator[str]:
        """What the noun is besides: one of a list or all of it, before another noun, a look."""
        mention, items, where = self.mention, self.passage.items, self.where
        if mention.members > 1:
            yield f"{where}: joined"
            yield f"{where}: joined, {self.forms.around(mention)}"
        else:
            yield from (f"{where}: {listed}" for listed in self._listed())
        after = mention.end + 1
        if after in self.forms.noun_at and items[after].clause == items[mention.end].clause:
            yield f"{where}: before a noun"
        if not self.forms.look_at.isdisjoint(range(mention.start, after)):
            yield f"{where}: a look too"

    def _listed(self) -> Iterator[str]:
        """Where the noun stands in a list: "the last of a list, looks after"."""
        one = self.mention
        for whole in self.mentions:
            if whole.members > 1 and whole.start <= one.start and one.end <= whole.end:
                end = "first" if one.start == whole.start else "last" if one.end == whole.end else "inside"
                yield "of a list"
                yield f"{end} of a list, {self.forms.around(whole)}"
