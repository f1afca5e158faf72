# SPDX-License-Identifier: Apache-2.0
"""How the clauses of a prompt are built: what they begin and end with, and what leads a word."""

from __future__ import annotations

from collections.abc import Iterable

from ..lexicon.vocabulary import Vocabulary
from ..mentions.nouns import NounMention
from ..mentions.passage import TIES, Passage


class ClauseForms:
    """The clauses of one prompt.

    Args:
        passage: Its tokens and look words.
        mentions: Its nouns.
        vocabulary: What words mean.

    Attributes:
        look_at: Places of look words.
        noun_at: Places of nouns.
        order: Whether clauses begin with a noun or with a look, or some so and some so.
        ends: Of each clause, what it begins and ends with.
        spares_from: Whether a look stands before what the prompt leaves out; "" if it leaves nothing out.
    """

    def __init__(self, passage: Passage, mentions: list[NounMention], vocabulary: Vocabulary) -> None:
        self.passage, self.mentions, self.vocabulary = passage, mentions, vocabulary
        self.look_at = {look.index for look in passage.looks}
        self.noun_at = {i for m in mentions for i in range(m.start, m.end + 1) if m.members == 1}
        self.order = self._order()
        self.ends = [self._ends_of(number) for number in range(self._clauses())]
        self.spares_from = self._spares_from()

    def lead(self, index: int) -> str:
        """The word before a look word and its neighbors that are looks too: "on" of "on a glossy black floor".

        Args:
            index: Place of the look word.
        """
        clause = self.passage.items[index].clause
        for place in range(index - 1, -1, -1):
            item = self.passage.items[place]
            if item.clause != clause:
                break
            if (
                item.ties
                or place in self.noun_at
                or not (place in self.look_at or "article" in item.token.lists)
            ):
                return self._lead_word(place)
        return "nothing"

    def turn(self, clause: int) -> str:
        """What the clause before another ends with: "after a clause that ends in light".

        Args:
            clause: Number of the other.
        """
        before = [i for i, item in enumerate(self.passage.items) if item.clause == clause - 1]
        for place in reversed(before):
            token = self.passage.items[place].token
            if place in self.noun_at or place in self.look_at:
                slot = (
                    self.vocabulary.entries[token.entry].slot
                    if token.entry
                    else "color"
                    if token.color
                    else "adjective"
                )
                return f"after a clause that ends in {token.noun or ('a name' if place in self.noun_at else slot)}"
        return "after nothing" if clause == 0 else "after a clause of neither"

    def around(self, mention: NounMention) -> str:
        """Where looks adjoin a list of nouns, and whether it goes over commas: "looks after, over commas".

        Args:
            mention: Of all the nouns.
        """
        items = self.passage.items
        last = items[mention.end].clause
        before = self._adjoins(range(mention.start - 1, -1, -1), items[mention.start].clause)
        after = self._adjoins(range(mention.end + 1, len(items)), last)
        if not after and "look to look" in self.ends[last + 1 : last + 2]:  # "hat, boots: black"
            after = all(item.clause > last for item in self.passage.content(mention.end + 1, len(items)))
        sides = " and ".join(side for side, is_so in (("before", before), ("after", after)) if is_so)
        commas = items[mention.start].clause != last
        return f"looks {sides or 'nowhere'}{', over commas' if commas else ''}"

    def _adjoins(self, places: Iterable[int], clause: int) -> bool:
        """Whether a look is the first of some items that is neither filler nor a tie."""
        for place in places:
            item = self.passage.items[place]
            if item.clause != clause or place in self.look_at or place in self.noun_at:
                return item.clause == clause and place in self.look_at
            if not (item.filler or item.ties):
                return False
        return False

    def _spares_from(self) -> str:
        """Whether "everything" of "everything grey but the floor" is described before the floor is left out."""
        spared = next((m for m in self.mentions if m.spared), None)
        if spared is None:
            return ""
        clause = self.passage.items[spared.start].clause
        tied = next((p for p in range(spared.start - 1, -1, -1) if self._spares(p)), spared.start)
        looks = [
            place
            for place in self.look_at
            if place < tied and self.passage.items[place].clause in (clause, clause - 1)
        ]
        return "after a look" if looks else "before any look"

    def _spares(self, place: int) -> bool:
        return not self.passage.items[place].token.lists.isdisjoint(("exception", "save", "refusal"))

    def role_of(self, token: object) -> str:
        """What a token is in its clause: "noun", "look", a tie, or "other".

        Args:
            token: Of the passage.
        """
        place = next(i for i, item in enumerate(self.passage.items) if item.token is token)
        if place in self.noun_at:
            return "noun"
        if place in self.look_at:
            return "look"
        lists = self.passage.items[place].token.lists
        return next((tie for tie in TIES if tie in lists), "other")

    def _order(self) -> str:
        """Whether clauses begin with what they are about ("hull red, wall white") or with how it looks ("red hull")."""
        firsts = []
        for number in range(self._clauses()):
            places = [i for i, item in enumerate(self.passage.items) if item.clause == number]
            both = [i for i in places if (i in self.look_at) != (i in self.noun_at)]
            if both and both[-1] > both[0]:
                firsts.append("noun" if both[0] in self.noun_at else "look")
        if not firsts or len({*firsts}) > 1:
            return "mixed"
        return firsts[0]

    def _clauses(self) -> int:
        return self.passage.items[-1].clause + 1 if self.passage.items else 0

    def _ends_of(self, clause: int) -> str:
        """What a clause begins and ends with: "noun to look" in "hull red"."""
        places = [i for i, item in enumerate(self.passage.items) if item.clause == clause]
        roles = ["noun" if i in self.noun_at else "look" for i in places if i in self.noun_at | self.look_at]
        return f"{roles[0]} to {roles[-1]}" if roles else "of neither"

    def _lead_word(self, place: int) -> str:
        item = self.passage.items[place]
        if item.ties:
            after = "a look" if place - 1 in self.look_at else "others"
            return f"'{item.token.text}' after {after}"
        return f"'{item.token.text}'" if item.filler else "a noun" if place in self.noun_at else "others"
