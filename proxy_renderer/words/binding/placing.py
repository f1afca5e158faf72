# SPDX-License-Identifier: Apache-2.0
"""How a look word and a noun stand to each other: side, distance, clause, what stands between and before."""

from __future__ import annotations

from collections.abc import Iterator

from ..mentions.nouns import NounMention
from ..tokens import TIES
from .clauses import ClauseForms

_FAR = 4  # items from which distance says no more
_NEAR = {0: "same clause", 1: "next clause"}


class NounPlace:
    """A noun as seen from a look word.

    Attributes:
        side: Whether the noun stands "after" the look word or "before" it.
        where: The side, and how many clauses the nearer ends of the two are apart.
    """

    def __init__(self, forms: ClauseForms, look: int, mention: NounMention) -> None:
        self.passage, self.forms = forms.passage, forms
        self.mention = mention
        after = mention.start > look
        self.side = "after" if after else "before"
        self._low, self._high = (look, mention.start) if after else (mention.end, look)
        self._between = self.passage.content(self._low + 1, self._high)
        items = self.passage.items
        self._apart = items[self._high].clause - items[self._low].clause
        self.where = f"{self.side}, {_NEAR.get(self._apart, 'far clause')}"

    def facts(self, kind: str, sort: str, lead: str) -> Iterator[str]:
        """All that their places say."""
        where = self.where
        yield f"{where}: {kind}"
        if not self._between and not self._apart:
            yield f"{self.side}: {kind} adjoins a {sort} word"
        yield f"{where}: {min(len(self._between), _FAR)} between"
        yield f"{where}: look led by {lead}"
        yield from self._ties()
        yield from self._led()
        if self.mention.members > 1:
            yield f"{where}: joined"

    def _ties(self) -> Iterator[str]:
        """What ties stand between the two."""
        for place in range(self._low + 1, self._high):
            if self.passage.items[place].ties:
                over = f"{self.where} over {self.passage.items[place].text}"
                looks = range(place, self._high) if self.side == "after" else ()
                own = not self.forms.look_at.isdisjoint(looks)
                yield from (over, f"{over}, {'with' if own else 'without'} a look after it")

    def _led(self) -> Iterator[str]:
        """What ties the noun to what stands before it: "than the leather"."""
        items, start = self.passage.items, self.mention.start
        for item in (items[p] for p in reversed(self.forms.places[items[start].clause]) if p < start):
            if item.ties:
                yield f"{self.where} led by {item.text}"
                yield from (f"{self.where} led by a {tie}" for tie in TIES if tie in item.lists)
            if not item.filler:
                return
        if not items[start].filler:
            yield f"{self.where}: first of its clause"
