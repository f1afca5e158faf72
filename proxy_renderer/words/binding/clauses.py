# SPDX-License-Identifier: Apache-2.0
"""How the clauses of a prompt are built: what they end with, and what leads a word."""

from __future__ import annotations

from collections import defaultdict

from ..lexicon.vocabulary import Vocabulary
from ..mentions.nouns import NounMention
from ..mentions.passage import Passage
from ..tokens import TIES, Token


class ClauseForms:
    """The clauses of one prompt.

    Attributes:
        look_at: Places of look words.
        noun_at: Places of nouns.
        places: Of each clause, those of its items.
        spares: Whether the prompt leaves something out.
    """

    def __init__(self, passage: Passage, mentions: list[NounMention], vocabulary: Vocabulary) -> None:
        self.passage, self.mentions, self.vocabulary = passage, mentions, vocabulary
        self.look_at = {look.index for look in passage.looks}
        self.noun_at = {i for m in mentions for i in range(m.start, m.end + 1) if m.members == 1}
        self.places: dict[int, list[int]] = defaultdict(list)
        for place, item in enumerate(passage.items):
            self.places[item.clause].append(place)
        self.spares = any(mention.spared for mention in mentions)

    def role(self, place: int) -> str:
        """What an item is in its clause: "noun", "look", a tie, or "other"."""
        if place in self.noun_at:
            return "noun"
        if place in self.look_at:
            return "look"
        lists = self.passage.items[place].lists
        return next((tie for tie in TIES if tie in lists), "other")

    def sort_of(self, token: Token) -> str:
        """The slot of what a look word means; "adjective" where that depends on what it describes."""
        if token.entry:
            return self.vocabulary.entries[token.entry].slot
        return "color" if token.color else "adjective"

    def lead(self, index: int) -> str:
        """The word before a look word and its neighbors that are looks too: "on" of "on a glossy black floor"."""
        before = [p for p in self.places[self.passage.items[index].clause] if p < index]
        while before and self._is_led(before[-1]):
            before.pop()
        if not before:
            return "nothing"
        place, item = before[-1], self.passage.items[before[-1]]
        if item.ties:
            return f"'{item.text}' after {'a look' if place - 1 in self.look_at else 'others'}"
        return f"'{item.text}'" if item.filler else "a noun" if place in self.noun_at else "others"

    def _is_led(self, place: int) -> bool:
        passed = place in self.look_at or "article" in self.passage.items[place].lists
        return passed and place not in self.noun_at

    def turn(self, clause: int) -> str:
        """What the clause before another ends with: "after a clause that ends in light"."""
        if clause == 0:
            return "after nothing"
        last = next((p for p in reversed(self.places[clause - 1]) if p in self.noun_at | self.look_at), None)
        if last is None:
            return "after a clause of neither"
        token = self.passage.items[last]
        what = token.noun or ("a name" if last in self.noun_at else self.sort_of(token))
        return f"after a clause that ends in {what}"
