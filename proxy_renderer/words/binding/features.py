# SPDX-License-Identifier: Apache-2.0
"""What can be said of a pair of look word and target: a small set of named facts."""

from __future__ import annotations

from collections.abc import Iterator

from ..mentions.nouns import Named, NounMention, fit_rank
from ..mentions.passage import PromptLook
from ..tokens import Token
from .becoming import SURFACE, Becoming
from .clauses import ClauseForms
from .placing import NounPlace
from .targets import LAMPS, MATTER, Target


class PairFeatures:
    """The facts about the pairs of one look word."""

    def __init__(self, look: PromptLook, forms: ClauseForms) -> None:
        self.look, self.token, self.forms = look, look.token, forms
        self.passage, self.mentions = forms.passage, forms.mentions
        self._name = self._called()
        self._sort = forms.sort_of(look.token) + self._name
        self._lead = forms.lead(look.index)
        self._turn = forms.turn(forms.passage.items[look.index].clause)
        self._next = [*self._next_nouns()]
        self._unnamed = [*self._named_instead()]  # the same for all that no noun names

    def of(self, target: Target, becoming: Becoming) -> Iterator[str]:
        """The facts about one pair.

        Args:
            target: What the look word may describe.
        """
        kind, token = _group(target.kind), self.token
        said = f"'{token.adjective or token.entry or 'a color'}'{self._name}"  # all colors are one
        yield f"a {self._sort} word of {target.kind}"
        yield f"{said} at {kind}"
        yield f"{said} of {target.kind}"
        yield f"{becoming.way} at {kind}"
        if "thing" in token.lists:
            yield f"a thing too at {kind}: led by {self._lead}"
        if token.color:
            yield from (f"{sign} at {kind}" for sign in _of_color(token))
        if self.look.negated:
            yield f"negated at {kind}"
        if target.mention < 0:
            yield from (f"{target.kind} unnamed: {fact}" for fact in self._unnamed)
            yield f"{self._sort} of {target.kind} unnamed: {self._turn}"
        else:
            yield from self._named(target)

    def _called(self) -> str:
        """That a look word is an object's name besides: a lake in the scene makes "lake" another word; surfaces stay what they are."""
        if not self.token.entry or self.forms.sort_of(self.token) in SURFACE:
            return ""
        named = (n for m in self.mentions if m.covers(self.look.index) for n in m.named)
        return " and name" if any(map(_is_of_object, named)) else ""

    def _named_instead(self) -> Iterator[str]:
        """What the clause and the prompt name instead, and where the look word stands."""
        items, look = self.passage.items, self.look.index
        clause = items[look].clause
        others = [m for m in self.mentions if not m.covers(look)]
        own = [m for m in others if items[m.start].clause == clause]
        rest = _kinds([m for m in others if items[m.start].clause != clause])
        yield f"led by {self._lead}"
        yield f"led by {self._lead}, prompt names {rest}"
        yield self._turn
        yield from self._beside(own)
        if [items[p].filler for p in self.forms.places[clause]].count(False) == 1:
            yield "alone"
        if len(others) < len(self.mentions):
            yield f"noun too{self._name}"
        after = self._after()
        if after is not None:
            yield f"before {self.forms.role(after)}"
            yield f"before '{items[after].text}'"
            if "hour" in items[after].lists:
                yield f"a {self._sort} word before an hour"

    def _after(self) -> int | None:
        """The place of what the clause says next."""
        items, look = self.passage.items, self.look.index
        places = self.forms.places[items[look].clause]
        return next((p for p in places if p > look and not items[p].filler), None)

    def _beside(self, nouns: list[NounMention]) -> Iterator[str]:
        """What the nearest nouns of the clause name, on each side: "white" of "piano in a white room" has the room after it."""
        look = self.look.index
        after = sorted((m for m in nouns if m.start > look), key=lambda m: (m.start, m.end))[:1]
        before = sorted((m for m in nouns if m.end < look), key=lambda m: (m.end, m.start))[-1:]
        sides = [(m, look, m.start, "after") for m in after] + [(m, m.end, look, "before") for m in before]
        for mention, low, high, side in sides:
            adjoins = self.forms.look_at.issuperset(range(low + 1, high))
            yield f"{_kinds([mention])} {'right ' if adjoins else ''}{side}"

    def _named(self, target: Target) -> Iterator[str]:
        """Of what a noun names: how the noun and the look word stand to each other, and how the noun fits."""
        mention, kind = self.mentions[target.mention], _group(target.kind)
        if mention.covers(self.look.index):
            yield f"itself at {kind}{self._name}"
            return
        yield from (f"{kind} by {sign}" for sign in target.signs)
        place = NounPlace(self.forms, self.look.index, mention)
        yield from place.facts(kind, self._sort, self._lead)
        yield from self._spared(target, mention, place.where, kind)
        if self.passage.items[mention.start].clause != self.passage.items[self.look.index].clause:
            yield from (f"{place.where}: {noun}" for noun in self._next)
        yield f"{target.kind} by noun {mention.noun or 'of the scene'}"
        if self.token.adjective and any(mention.covers(place) for place in self.forms.look_at):
            yield f"'{self.token.adjective}' of {target.kind} by a noun that is a look"
        yield f"{kind} {'surest' if _is_surest(mention, target) else 'less sure'}"
        several = len(target.names) > 1 and target.kind != "others"
        if several and mention.text.endswith("s"):
            yield f"plural at {kind}"
        elif several and mention.members == 1:
            yield f"several at {kind} by a singular"
            yield from (f"several at {kind} by a singular, {sign}" for sign in target.signs)

    def _next_nouns(self) -> Iterator[str]:
        """What the clause names right after the look word: "brass" of "a red cup, a brass chandelier" has a noun of its own."""
        items, look = self.passage.items, self.look.index
        own = [m for m in self.mentions if items[m.start].clause == items[look].clause and m.start > look]
        yield from (fact for fact in self._beside(own) if fact.endswith("right after"))

    def _spared(self, target: Target, mention: NounMention, where: str, kind: str) -> Iterator[str]:
        """What it says that the prompt leaves a noun out, or leaves something out at all."""
        if mention.spared:
            yield f"{where}: spared {kind}"
        elif self.forms.spares:
            yield f"{target.kind} where something is spared"


def _is_of_object(named: Named) -> bool:
    signs = (sign for sign in named.signs if not sign.endswith("synonym"))
    return named.kind == "things" and any(sign.startswith("object") for sign in signs)


def _is_surest(mention: NounMention, target: Target) -> bool:
    """Whether nothing fits the noun better than a target."""
    ranks = {n.names: fit_rank(n) for n in mention.named}
    return ranks.get(target.names, 0) <= min(ranks.values(), default=0)


def _of_color(token: Token) -> Iterator[str]:
    """How a color is said: "cold blue", "muted greens", a word that is a material too."""
    if " " in token.text:
        yield f"color that is {token.text.split()[0]}"
    if token.text.endswith("s") and not token.name.endswith("s"):
        yield "plural color"
    if token.entry:
        yield "color and entry"


def _group(kind: str) -> str:
    """Kinds of targets that behave alike."""
    return "matter" if kind in MATTER else "lamp" if kind in LAMPS else kind


def _kinds(mentions: list[NounMention]) -> str:
    """What nouns name, in short."""
    kinds = {n.kind for m in mentions for n in m.named} | {m.noun for m in mentions if m.noun and not m.named}
    return " and ".join(sorted(kinds)) if len(kinds) <= 2 else "many"
