# SPDX-License-Identifier: Apache-2.0
"""The log-linear model that binds look words: it sums the weights of facts about each pair of a word and a target.

`lab/train/binding.py` fits the weights.
"""

from __future__ import annotations

import json
import math
from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from functools import cache
from operator import itemgetter
from pathlib import Path
from typing import TYPE_CHECKING

from .lexer import TIES, Token
from .lexicon.vocabulary import Vocabulary
from .mentions import OwnNouns, mentions
from .passage import Passage, PromptLook, passage
from .scene import NounMention, SceneIndex, fit_rank
from .targets import LAMPS, MATTER, PromptPairs, Sense, Target, TargetPair, sense_at, targets
from .types import SceneDescription

if TYPE_CHECKING:
    pass

FILE = Path(__file__).with_name("lexicon") / "binding.json"
_FAR = 4  # tokens; a greater distance counts as this
FactWeights = dict[str, float]  # fact -> its weight


@cache
def shipped_weights() -> FactWeights:
    """Fact -> its weight, from the shipped `binding.json`."""
    weights: FactWeights = json.loads(FILE.read_text("utf-8"))["weights"]
    return weights


def scores(pairs: Sequence[TargetPair], weights: Mapping[str, float]) -> list[float]:
    """Natural logarithms of the probabilities of `pairs`, in their order; `pairs` are all targets of one look word."""
    raw = [sum(weights.get(name, 0.0) for name in pair.features) for pair in pairs]
    most = max(raw)
    whole = most + math.log(sum(math.exp(r - most) for r in raw))
    return [r - whole for r in raw]


def likeliest(pairs: Sequence[TargetPair], weights: Mapping[str, float]) -> list[tuple[TargetPair, float]]:
    """The pairs of one look word with their probabilities, the likeliest first.

    Pairs that differ only in the noun that names the target count as one: the likeliest, with the sum of probabilities.
    """
    same = defaultdict(list)
    for pair, score in zip(pairs, scores(pairs, weights), strict=True):
        same[pair.target.kind, pair.target.names, pair.sense].append((math.exp(score), pair))
    pooled = [(max(group, key=itemgetter(0))[1], sum(share for share, _ in group)) for group in same.values()]
    return sorted(pooled, key=itemgetter(1), reverse=True)


# Facts


class ClauseForms:
    """Facts about the clauses of a prompt: places of looks and nouns, the word before a look, the end of a clause."""

    def __init__(self, passage: Passage, mentions: list[NounMention], vocabulary: Vocabulary) -> None:
        self.passage, self.mentions, self.vocabulary = passage, mentions, vocabulary
        self.look_at = {look.index for look in passage.looks}
        self.noun_at = {i for m in mentions for i in range(m.start, m.end + 1) if m.members == 1}
        self.places: dict[int, list[int]] = defaultdict(list)  # clause -> places of its items
        for place, item in enumerate(passage.items):
            self.places[item.clause].append(place)
        self.spares = any(mention.excepted for mention in mentions)

    def sort_of(self, token: Token) -> str:
        """The slot of a look word's entry; "color" for a color, "adjective" if the entry depends on the target."""
        if token.entry:
            return self.vocabulary.entries[token.entry].slot
        return "color" if token.color else "adjective"

    def lead(self, index: int) -> str:
        """The word before token `index`, past looks and articles: "'on' after others" for "on a glossy black floor"."""
        items = self.passage.items
        for place in reversed([p for p in self.places[items[index].clause] if p < index]):
            item = items[place]
            passed = place in self.look_at or "article" in item.lists
            if passed and place not in self.noun_at:
                continue
            if item.ties:
                return f"'{item.text}' after {'a look' if place - 1 in self.look_at else 'others'}"
            return f"'{item.text}'" if item.filler else "a noun" if place in self.noun_at else "others"
        return "nothing"

    def turn(self, clause: int) -> str:
        """The kind of the last noun or look in the clause before `clause`: "after a clause that ends in light"."""
        if clause == 0:
            return "after nothing"
        last = next((p for p in reversed(self.places[clause - 1]) if p in self.noun_at | self.look_at), None)
        if last is None:
            return "after a clause of neither"
        token = self.passage.items[last]
        what = token.noun or ("a name" if last in self.noun_at else self.sort_of(token))
        return f"after a clause that ends in {what}"


class PairFeatures:
    """The facts about one look word and each of its possible targets, as `binding.json` names them."""

    def __init__(self, look: PromptLook, forms: ClauseForms) -> None:
        self.look, self.token, self.forms = look, look.token, forms
        self.items, self.mentions = forms.passage.items, forms.mentions
        covering = [m for m in self.mentions if m.covers(look.index)]
        self._sort, self._lead = forms.sort_of(look.token), forms.lead(look.index)
        self._turn = forms.turn(self.items[look.index].clause)
        self._unnamed = [*self._unnamed_facts(is_noun=bool(covering))]

    def of(self, target: Target, sense: Sense) -> Iterator[str]:
        """Yields the facts about the look word and `target`, which it describes in the sense `sense`."""
        kind, token = target.kind, self.token
        group = "matter" if kind in MATTER else "lamp" if kind in LAMPS else kind
        word = f"'{token.adjective or token.entry or 'a color'}'"  # colors are not told apart
        yield f"a {self._sort} word of {kind}"
        yield from (f"{word} at {group}", f"{word} of {kind}", f"{sense.way} at {group}")
        if token.color and " " in token.text:
            yield f"color that is {token.text.split()[0]} at {group}"
        if token.color and token.text.endswith("s") and not token.name.endswith("s"):
            yield f"plural color at {group}"
        if token.color and token.entry:
            yield f"color and entry at {group}"
        if target.mention >= 0:
            yield from self._named_facts(target, self.mentions[target.mention], group)
        else:
            yield from (f"{kind} unnamed: {fact}" for fact in self._unnamed)
            yield f"{self._sort} of {kind} unnamed: {self._turn}"

    def _unnamed_facts(self, is_noun: bool) -> Iterator[str]:
        """Yields facts that all targets without a noun share: what nouns name instead, and the look word's place."""
        look, items = self.look.index, self.items
        clause = items[look].clause
        others = [m for m in self.mentions if not m.covers(look)]
        nouns = _kinds([m for m in others if items[m.start].clause != clause])
        yield from (f"led by {self._lead}", f"led by {self._lead}, prompt names {nouns}", self._turn)
        # The nearest noun on each side: "white" of "piano in a white room" has the room after it
        own = [m for m in others if items[m.start].clause == clause]
        after = sorted((m for m in own if m.start > look), key=lambda m: (m.start, m.end))[:1]
        before = sorted((m for m in own if m.end < look), key=lambda m: (m.end, m.start))[-1:]
        sides = [(m, look, m.start, "after") for m in after] + [(m, m.end, look, "before") for m in before]
        for mention, low, high, side in sides:
            right = "right " if self.forms.look_at.issuperset(range(low + 1, high)) else ""
            yield f"{_kinds([mention])} {right}{side}"
        places = [p for p in self.forms.places[clause] if not items[p].filler]
        if len(places) == 1:
            yield "alone"
        if is_noun:
            yield "noun too"
        for place in [p for p in places if p > look][:1]:
            tie = next((tie for tie in TIES if tie in items[place].lists), "other")
            role = "noun" if place in self.forms.noun_at else "look" if place in self.forms.look_at else tie
            yield from (f"before {role}", f"before '{items[place].text}'")
            if "hour" in items[place].lists:
                yield f"a {self._sort} word before an hour"

    def _named_facts(self, target: Target, mention: NounMention, group: str) -> Iterator[str]:
        """Yields facts about a target that `mention` names: where that noun stands, and how well it fits the target."""
        if mention.covers(self.look.index):
            yield f"itself at {group}"
            return
        yield from (f"{group} by {sign}" for sign in target.signs)
        side = "after" if mention.start > self.look.index else "before"
        low, high = (self.look.index, mention.start) if side == "after" else (mention.end, self.look.index)
        apart = self.items[high].clause - self.items[low].clause
        where = f"{side}, {('same clause', 'next clause')[apart] if apart in (0, 1) else 'far clause'}"
        yield from self._place_facts(mention, group, where, low, high)
        if mention.excepted:
            yield f"{where}: spared {group}"
        elif self.forms.spares:
            yield f"{target.kind} where something is spared"
        yield f"{target.kind} by noun {mention.noun or 'of the scene'}"
        if self.token.adjective and any(mention.covers(place) for place in self.forms.look_at):
            yield f"'{self.token.adjective}' of {target.kind} by a noun that is a look"
        # How surely the noun names this target
        ranks = {n.names: fit_rank(n) for n in mention.named}
        surest = ranks.get(target.names, 0) <= min(ranks.values(), default=0)
        yield f"{group} {'surest' if surest else 'less sure'}"
        singular = mention.members == 1 and not mention.text.endswith("s")
        if len(target.names) > 1 and target.kind != "others" and singular:
            yield f"several at {group} by a singular"
            yield from (f"several at {group} by a singular, {sign}" for sign in target.signs)

    def _place_facts(self, mention: NounMention, group: str, where: str, low: int, high: int) -> Iterator[str]:
        """Yields side, clause and distance of a noun, the ties between it and the look word, and the tie before it."""
        items, side = self.items, where.partition(",")[0]
        between = self.forms.passage.content(low + 1, high)
        yield f"{where}: {group}"
        if not between and items[high].clause == items[low].clause:
            yield f"{side}: {group} adjoins a {self._sort} word"
        yield f"{where}: {min(len(between), _FAR)} between"
        yield f"{where}: look led by {self._lead}"
        for place in (place for place in range(low + 1, high) if items[place].ties):
            over = f"{where} over {items[place].text}"
            own = side == "after" and not self.forms.look_at.isdisjoint(range(place, high))
            yield from (over, f"{over}, {'with' if own else 'without'} a look after it")
        if mention.members > 1:
            yield f"{where}: joined"
        before = [items[p] for p in self.forms.places[items[mention.start].clause] if p < mention.start]
        for item in reversed(before):
            if item.ties:
                yield f"{where} led by {item.text}"
                yield from (f"{where} led by a {tie}" for tie in TIES if tie in item.lists)
            if not item.filler:
                return
        if not items[mention.start].filler:
            yield f"{where}: first of its clause"


def _kinds(mentions: list[NounMention]) -> str:
    kinds = {n.kind for m in mentions for n in m.named} | {m.noun for m in mentions if m.noun and not m.named}
    return " and ".join(sorted(kinds)) if len(kinds) <= 2 else "many"


def reading(text: str, words: SceneDescription, vocabulary: Vocabulary, foreign: Collection[str] = ()) -> PromptPairs:
    """A prompt in which each look word is paired with everything that it may describe. Arguments as for `passage`."""
    found = passage(text, words, vocabulary, foreign)
    nouns = mentions(found, words.made(SceneIndex, vocabulary), vocabulary)
    every, own = targets(nouns, words), OwnNouns(found, nouns, vocabulary)
    forms, pairs = ClauseForms(found, nouns, vocabulary), []
    for look in found.looks:
        may_be = every
        if changed := own.changed(look.index):  # in a change phrase, only targets of its object
            theirs = {number for number, noun in enumerate(nouns) if noun.covers(changed.start)}
            may_be = [target for target in every if target.mention in theirs] or every
        facts = PairFeatures(look, forms)
        senses = ((target, sense_at(look.token, target.kind, vocabulary)) for target in may_be)
        each = ((target, sense, {*facts.of(target, sense)}) for target, sense in senses if sense)
        pairs.append([TargetPair(look, target, sense, tuple(sorted(names))) for target, sense, names in each])
    return PromptPairs(found, nouns, pairs)
