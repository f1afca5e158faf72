# SPDX-License-Identifier: Apache-2.0
"""What can be said of a pair of look word and target: a small set of named facts."""

from __future__ import annotations

from collections.abc import Iterator

from ..lexicon.vocabulary import Vocabulary
from ..mentions.nouns import Named, NounMention, fit_rank
from ..mentions.passage import Passage, PromptLook
from ..types import GLOW
from .becoming import SURFACE, Becoming
from .clauses import ClauseForms
from .placing import NounPlace
from .targets import LAMPS, MATTER, Target


class PairFeatures:
    """The facts about the pairs of one prompt.

    Args:
        passage: Its tokens and look words.
        mentions: Its nouns.
        vocabulary: What words mean.
    """

    def __init__(self, passage: Passage, mentions: list[NounMention], vocabulary: Vocabulary) -> None:
        self.passage, self.mentions, self.vocabulary = passage, mentions, vocabulary
        self.forms = ClauseForms(passage, mentions, vocabulary)

    def of(self, look: PromptLook, target: Target, becoming: Becoming) -> Iterator[str]:
        """The facts about one pair.

        Args:
            look: The look word.
            target: What it may describe.
            becoming: What it would be there.
        """
        kind, sort = _group(target.kind), self._sort(look)
        yield f"a {sort} word of {target.kind}"
        called = self._called(look)
        yield f"'{_said(look)}'{called} at {kind}"
        yield f"'{_said(look)}'{called} of {target.kind}"
        yield f"{sort} said {_how(look)} of {target.kind}"
        yield f"{becoming.way} at {kind}"
        if "thing" in look.token.lists:
            yield f"a thing too at {kind}: led by {self.forms.lead(look.index)}"
        if becoming.slot:
            yield f"{becoming.slot}{called} at {kind}"
        if look.token.color:
            yield from (f"{sign} at {kind}" for sign in _of_color(look))
        if look.negated:
            yield f"negated at {kind}"
        if look.guess:
            yield f"guessed at {kind}"
            yield f"guessed at {kind} by {look.guess.confidence:.1f}"
        if target.mention < 0:
            yield from self._unnamed(look, target)
        else:
            yield from self._named(look, target, becoming)

    def _sort(self, look: PromptLook) -> str:
        token = look.token
        if look.guess:
            return "guessed"
        if token.entry:
            return self.vocabulary.entries[token.entry].slot + self._called(look)
        return "color" if token.color else "adjective"

    def _called(self, look: PromptLook) -> str:
        """That a look word is an object's name besides: a lake in the scene makes "lake" another word; surfaces stay what they are."""
        entry = self.vocabulary.entries.get(look.token.entry)
        if entry is None or entry.slot in SURFACE:
            return ""
        named = (n for m in self.mentions if m.covers(look.index) for n in m.named)
        return " and name" if any(map(_is_of_object, named)) else ""

    def _unnamed(self, look: PromptLook, target: Target) -> Iterator[str]:
        """Of what no noun names: what the clause and the prompt name instead."""
        clause = self.passage.items[look.index].clause
        own = [
            m
            for m in self.mentions
            if self.passage.items[m.start].clause == clause and not m.covers(look.index)
        ]
        rest = [m for m in self.mentions if m not in own and not m.covers(look.index)]
        yield f"{target.kind} unnamed: clause names {_kinds(own)}"
        yield f"{target.kind} unnamed: prompt names {_kinds(rest)}"
        alone = len([i for i in self.passage.items if i.clause == clause and not i.filler]) == 1
        if alone:
            yield f"{target.kind} unnamed: alone"
        if any(m.covers(look.index) for m in self.mentions):
            yield f"{target.kind} unnamed: noun too{self._called(look)}"
        after = next(iter(self.passage.content(look.index + 1, len(self.passage.items))), None)
        if after and after.clause == clause:
            yield f"{target.kind} unnamed: before {self.forms.role_of(after.token)}"
            yield f"{target.kind} unnamed: before '{after.token.text}'"
            if "hour" in after.token.lists:
                yield f"{target.kind} unnamed: a {self._sort(look)} word before an hour"
        yield from (f"{target.kind} unnamed: {beside}" for beside in self._beside(look, own))
        lead = self.forms.lead(look.index)
        yield f"{target.kind} unnamed: led by {lead}"
        yield f"{target.kind} unnamed: led by {lead}, prompt names {_kinds(rest)}"
        if look.token.adjective and after and after.clause == clause and after.names_a_look:
            yield f"'{look.token.adjective}' of {target.kind} unnamed: before a look"
        yield f"{target.kind} unnamed: {self.forms.turn(clause)}"
        yield f"{self._sort(look)} of {target.kind} unnamed: {self.forms.turn(clause)}"

    def _beside(self, look: PromptLook, nouns: list[NounMention]) -> Iterator[str]:
        """What the nearest nouns of the clause name, on each side: "white" of "piano in a white room" has the room after it."""
        after = min((m for m in nouns if m.start > look.index), key=lambda m: (m.start, m.end), default=None)
        before = max((m for m in nouns if m.end < look.index), key=lambda m: (m.end, m.start), default=None)
        for mention, side in ((after, "after"), (before, "before")):
            if mention:
                low, high = sorted((look.index, mention.start if side == "after" else mention.end))
                adjoins = all(place in self.forms.look_at for place in range(low + 1, high))
                yield f"{_kinds([mention])} {'right ' if adjoins else ''}{side}"

    def _named(self, look: PromptLook, target: Target, becoming: Becoming) -> Iterator[str]:
        """Of what a noun names: how the noun and the look word stand to each other, and how the noun fits."""
        mention = self.mentions[target.mention]
        kind = _group(target.kind)
        if mention.covers(look.index):
            yield f"itself at {kind}{self._called(look)}"
            return
        yield from (f"{kind} by {sign}" for sign in target.signs)
        sort = self._sort(look)
        place = NounPlace(self.passage, self.mentions, self.forms, look.index, mention)
        yield from place.facts(kind, sort)
        yield from self._spared(target, mention, place.where, kind)
        yield f"{becoming.way} at {kind}, {place.side}: led by {self.forms.lead(look.index)}"
        yield f"{target.kind} by noun {mention.noun or 'of the scene'}"
        if look.token.adjective and not self.forms.look_at.isdisjoint(range(mention.start, mention.end + 1)):
            yield f"'{look.token.adjective}' of {target.kind} by a noun that is a look"
        yield f"{kind} {'surest' if self._is_surest(mention, target) else 'less sure'}"
        if (
            len(target.names) > 1
            and target.kind != "others"
            and not mention.text.endswith("s")
            and mention.members == 1
        ):
            yield f"several at {kind} by a singular"
            yield from (f"several at {kind} by a singular, {sign}" for sign in target.signs)
        if mention.text.endswith("s") and target.kind != "others" and len(target.names) > 1:
            yield f"plural at {kind}"
        if target.kind == "things" and target.names <= self._glows():
            yield f"{sort} of a glow"

    def _spared(self, target: Target, mention: NounMention, where: str, kind: str) -> Iterator[str]:
        """What it says that the prompt leaves a noun out, or leaves something out at all."""
        if mention.spared:
            yield f"{where}: spared {kind}, {self.forms.spares_from}"
        elif self.forms.spares_from:
            yield f"{target.kind} where something is spared {self.forms.spares_from}"

    def _is_surest(self, mention: NounMention, target: Target) -> bool:
        """Whether nothing fits the noun better than a target."""
        ranks = {n.names: fit_rank(n) for n in mention.named}
        return ranks.get(target.names, 0) <= min(ranks.values(), default=0)

    def _glows(self) -> frozenset[str]:
        named = (n for m in self.mentions for n in m.named if n.kind == "lights")
        return frozenset(name.removeprefix(GLOW) for n in named for name in n.names if name.startswith(GLOW))


def _is_of_object(named: Named) -> bool:
    return named.kind == "things" and any(sign.startswith("object") for sign in named.signs)


def _of_color(look: PromptLook) -> Iterator[str]:
    """How a color is said: "cold blue", "muted greens", a word that is a material too."""
    token = look.token
    first, *more = token.text.split()
    if more:
        yield f"color that is {first}"
    if token.text.endswith("s") and not token.name.endswith("s"):
        yield "plural color"
    if token.entry:
        yield "color and entry"


def _said(look: PromptLook) -> str:
    """A look word by itself; all colors are one."""
    return look.token.adjective or look.token.entry or "a color"


def _how(look: PromptLook) -> str:
    """Whether an entry is said by its name, or by another word of its: "candle" for candlelight."""
    token = look.token
    if not token.entry:
        return "otherwise"
    return "by name" if token.name == token.entry else "by another word"


def _group(kind: str) -> str:
    """Kinds of targets that behave alike."""
    return "matter" if kind in MATTER else "lamp" if kind in LAMPS else kind


def _kinds(mentions: list[NounMention]) -> str:
    """What nouns name, in short."""
    kinds = {n.kind for m in mentions for n in m.named} | {m.noun for m in mentions if m.noun and not m.named}
    return " and ".join(sorted(kinds)) if len(kinds) <= 2 else "many"
