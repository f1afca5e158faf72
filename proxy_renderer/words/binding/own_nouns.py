# SPDX-License-Identifier: Apache-2.0
"""The noun that a look word is said of, where the grammar of its clause leaves no doubt."""

from __future__ import annotations

from ..lexicon.spelling import singular
from ..lexicon.things import thing_words
from ..lexicon.vocabulary import Vocabulary
from ..mentions.changes import is_object
from ..mentions.nouns import NounMention
from ..mentions.passage import Passage

NO_MATTER = ("light", "fill", "rim", "sky", "fog", "shadow")
"""Kinds of nouns without a surface."""
_STOPS = ("around", "comparison", "exception")
"""Lists of words over which a look is not said of the noun before them: "a cup on red"."""


class OwnNouns:
    """Finds the nouns of look words."""

    def __init__(self, passage: Passage, mentions: list[NounMention], vocabulary: Vocabulary) -> None:
        self._items, self._vocabulary = passage.items, vocabulary
        self._looks = {look.index for look in passage.looks}
        single = [mention for mention in mentions if mention.members == 1]
        self._at = {place: m for m in single for place in range(m.start, m.end + 1)}

    def of(self, look: int) -> NounMention | None:
        """The noun that a look word is said of; None where that is not certain."""
        if change := self._change(look):
            changed = (p for p, item in enumerate(self._items) if item.presents and item.change == change)
            return next((self._at[place] for place in changed if place in self._at), None)
        return self._purpose(look) or self._after(look) or self._before(look) or self._ahead(look)

    def changed(self, look: int) -> NounMention | None:
        """The object of the change phrase that a look word is in, or that it goes on with: "from red to grey, still glossy"."""
        return self.of(look) if self._change(look) else None

    def is_noun(self, look: int) -> bool:
        """Whether a color stands as a noun itself, and speaks of what is there: "out of the black"."""
        definite = look > 0 and self._items[look - 1].text == "the"
        return definite and not (self._items[look].change or self._after(look))

    def _change(self, look: int) -> int:
        """The number of the change phrase that a word is in, or that ends right before its clause, which has no noun."""
        items, clause = self._items, self._items[look].clause
        token = items[look]
        if token.change or not (token.color or self._vocabulary.slot(token.entry) in ("finish", "material")):
            return token.change
        mine = [place for place, item in enumerate(items) if item.clause == clause]
        before = [place for place, item in enumerate(items) if item.clause == clause - 1]
        alone = before and not any(self._noun(place) for place in mine)
        return items[before[-1]].change if alone else 0

    def _after(self, look: int) -> NounMention | None:
        """The noun of "a red roof", the last one of "a red roof tile" unless the scene has only the other."""
        found = None
        for place in range(look + 1, len(self._items)):
            item = self._items[place]
            if item.clause != self._items[look].clause and (found or not self._led(look)):
                break  # "a crisp, pale beam" goes on
            noun = self._noun(place)
            if noun and self._is_led(look, noun):
                found = noun if not found or noun.named or not found.named else found
            elif found or not (item.names_a_look or item.strength is not None):
                break
        return found

    def _purpose(self, look: int) -> NounMention | None:
        """The noun of "oak for the table"."""
        after = range(look + 1, len(self._items))
        place = next((p for p in after if not self._items[p].names_a_look), len(self._items))
        said, led = self._items[place : place + 1], self._items[place + 1 : place + 2]
        is_for = any(item.text == "for" for item in said) and any("article" in item.lists for item in led)
        return self._noun(place + 2) if is_for and place + 2 < len(self._items) else None

    def _before(self, look: int) -> NounMention | None:
        """The noun of "the roof is red" and "the roof in dark red"; one that the scene has before one without an article."""
        found = None
        for place in range(look - 1, -1, -1):
            item = self._items[place]
            apart = item.clause != self._items[look].clause
            if apart or not item.lists.isdisjoint(_STOPS) or (item.ties and item.text == "with"):
                break
            noun = self._noun(place)
            if noun and (noun.named or (not found and self._is_a_noun(noun))):
                found = noun
            if noun and (place in self._looks or noun.named or self._has_article(noun)):
                break
        return found

    def _ahead(self, look: int) -> NounMention | None:
        """The noun of "roof: red", which is all that the clause before says."""
        clause = self._items[look].clause
        mine = [p for p, item in enumerate(self._items) if item.clause == clause]
        before = [p for p, item in enumerate(self._items) if item.clause == clause - 1]
        if any(self._noun(p) for p in mine) or not self._looks.isdisjoint(before):
            return None
        nouns = [noun for p in before if (noun := self._noun(p))]
        said = [p for p in before if not self._items[p].filler]
        return nouns[-1] if nouns and len({n.start for n in nouns}) == len(said) <= 2 else None

    def _noun(self, place: int) -> NounMention | None:
        """The noun at a place, also one that is a filler elsewhere: "the frame"."""
        item, known = self._items[place], self._at.get(place)
        if known:
            return known
        if item.entry and item.text.endswith(("light", "lights")):  # "moonlight"
            return NounMention(place, place, item.text, "light")
        definite = place > 0 and "definite" in self._items[place - 1].lists
        described = place - 1 in self._looks
        if item.filler:
            is_noun = definite and item.text in thing_words().rows
        else:
            scenery = described and item.text in self._vocabulary.words["scenery"]
            is_noun = scenery or is_object(item, self._vocabulary)
        return NounMention(place, place, item.text, item.noun or "unknown") if is_noun else None

    def _is_led(self, look: int, noun: NounMention) -> bool:
        """Whether a word after a look is a noun: one that is known, or any word after an article."""
        return self._led(look) or self._is_a_noun(noun)

    def _led(self, look: int) -> bool:
        """Whether an article stands before a look and the looks before it."""
        first = look
        while first > 0 and (self._items[first - 1].names_a_look or self._items[first - 1].strength):
            first -= 1
        return first > 0 and not self._items[first - 1].lists.isdisjoint(("article", "definite"))

    def _is_a_noun(self, noun: NounMention) -> bool:
        """Whether a word is a noun by itself, or by the article before it."""
        listed = singular(noun.text) in thing_words().rows
        return bool(noun.named) or noun.noun != "unknown" or listed or self._has_article(noun)

    def _has_article(self, noun: NounMention) -> bool:
        return self._led(noun.start)
