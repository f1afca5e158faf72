# SPDX-License-Identifier: Apache-2.0
"""All pairs of look words and targets of a prompt, each with the facts that the model weighs."""

from collections import defaultdict
from collections.abc import Collection, Iterator
from enum import StrEnum

from ..color.floats import chroma, lab_from_srgb
from .lexer import TIES, Lexer, Token
from .lexicon.vocabulary import Vocabulary
from .mentions import mentions
from .own_nouns import OwnNouns
from .passage import Passage, PromptLook, passage, with_changes
from .scene import Named, NounMention, SceneIndex, fit_rank
from .targets import LAMPS, MATTER, SURFACE, TINGE, PromptPairs, Sense, Target, TargetPair, sense_at, targets
from .types import SceneDescription

_FAR = 4  # items from which a distance says no more
_OF_LIGHT = ("mood", "lighting", "grade", "atmosphere")
_GRAYISH = 25.0  # C* of colors that a light hardly has


class Fact(StrEnum):
    """Facts about a pair, as `binding.json` names them.

    `sort` is the slot of the look word, `kind` the kind of target, `group` kinds that behave alike, `where` the side and the clause
    of the noun that names the target, `lead` the word before the look word, `sign` how the noun was found.
    """

    SORT_OF_KIND = "a {sort} word of {kind}"
    WORD_AT = "{word} at {group}"
    WORD_OF = "{word} of {kind}"
    WAY_AT = "{way} at {group}"
    THING_TOO = "a thing too at {group}: led by {lead}"
    COLOR_THAT_IS = "color that is {first} at {group}"
    PLURAL_COLOR = "plural color at {group}"
    COLOR_AND_ENTRY = "color and entry at {group}"
    SORT_UNNAMED = "{sort} of {kind} unnamed: {turn}"
    UNNAMED_LED = "{kind} unnamed: led by {lead}"
    UNNAMED_LED_RATHER = "{kind} unnamed: led by {lead}, prompt names {nouns}"
    UNNAMED_TURN = "{kind} unnamed: {turn}"
    UNNAMED_BESIDE = "{kind} unnamed: {beside}"
    UNNAMED_ALONE = "{kind} unnamed: alone"
    UNNAMED_NOUN_TOO = "{kind} unnamed: noun too{name}"
    UNNAMED_BEFORE = "{kind} unnamed: before {next}"
    UNNAMED_HOUR = "{kind} unnamed: a {sort} word before an hour"
    ITSELF = "itself at {group}{name}"
    BY_SIGN = "{group} by {sign}"
    PLACE = "{where}: {group}"
    ADJOINS = "{side}: {group} adjoins a {sort} word"
    BETWEEN = "{where}: {count} between"
    LOOK_LED = "{where}: look led by {lead}"
    OVER = "{where} over {tie}"
    OVER_WITH = "{where} over {tie}, with a look after it"
    OVER_WITHOUT = "{where} over {tie}, without a look after it"
    NOUN_LED = "{where} led by {tie}"
    NOUN_LED_BY = "{where} led by a {tie}"
    FIRST = "{where}: first of its clause"
    JOINED = "{where}: joined"
    SPARED = "{where}: spared {group}"
    SPARES = "{kind} where something is spared"
    BY_NOUN = "{kind} by noun {noun}"
    BY_A_LOOK = "'{adjective}' of {kind} by a noun that is a look"
    SUREST = "{group} surest"
    LESS_SURE = "{group} less sure"
    SEVERAL = "several at {group} by a singular"
    SEVERAL_SIGN = "several at {group} by a singular, {sign}"


class ClauseForms:
    """The clauses of one prompt: which items are looks and nouns, what leads a word, what a clause ends with."""

    def __init__(self, passage: Passage, mentions: list[NounMention], vocabulary: Vocabulary) -> None:
        self.passage, self.mentions, self.vocabulary = passage, mentions, vocabulary
        self.look_at = {look.index for look in passage.looks}
        self.noun_at = {i for m in mentions for i in range(m.start, m.end + 1) if m.members == 1}
        self.places: dict[int, list[int]] = defaultdict(list)  # clause -> places of its items
        for place, item in enumerate(passage.items):
            self.places[item.clause].append(place)
        self.spares = any(mention.excepted for mention in mentions)

    def sort_of(self, token: Token) -> str:
        """The slot of what a look word means; "adjective" where that depends on what it describes."""
        if token.entry:
            return self.vocabulary.entries[token.entry].slot
        return "color" if token.color else "adjective"

    def role(self, place: int) -> str:
        """ "noun", "look", a tie, or "other"."""
        if place in self.noun_at:
            return "noun"
        if place in self.look_at:
            return "look"
        return next((tie for tie in TIES if tie in self.passage.items[place].lists), "other")

    def lead(self, index: int) -> str:
        """The word before a look word and its neighbors that are looks too: "on" of "on a glossy black floor"."""
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
        """The end of the clause before: "after a clause that ends in light"."""
        if clause == 0:
            return "after nothing"
        last = next((p for p in reversed(self.places[clause - 1]) if p in self.noun_at | self.look_at), None)
        if last is None:
            return "after a clause of neither"
        token = self.passage.items[last]
        what = token.noun or ("a name" if last in self.noun_at else self.sort_of(token))
        return f"after a clause that ends in {what}"


class PairFeatures:
    """The facts about the pairs of one look word."""

    def __init__(self, look: PromptLook, forms: ClauseForms) -> None:
        self.look, self.token, self.forms = look, look.token, forms
        self.items, self.mentions = forms.passage.items, forms.mentions
        self._clause = self.items[look.index].clause
        covering = [m for m in self.mentions if m.covers(look.index)]
        # A lake in the scene makes "lake" another word; surfaces stay what they are.
        named = look.token.entry and forms.sort_of(look.token) not in SURFACE
        self._name = " and name" if named and any(_is_of_object(n) for m in covering for n in m.named) else ""
        self._sort = forms.sort_of(look.token) + self._name
        self._lead, self._turn = forms.lead(look.index), forms.turn(self._clause)
        self._unnamed = [*self._unnamed_facts(is_noun=bool(covering))]

    def of(self, target: Target, sense: Sense) -> Iterator[str]:
        """The facts about one pair."""
        kind, token = target.kind, self.token
        group = "matter" if kind in MATTER else "lamp" if kind in LAMPS else kind
        word = f"'{token.adjective or token.entry or 'a color'}'{self._name}"  # all colors are one
        yield Fact.SORT_OF_KIND.format(sort=self._sort, kind=kind)
        yield Fact.WORD_AT.format(word=word, group=group)
        yield Fact.WORD_OF.format(word=word, kind=kind)
        yield Fact.WAY_AT.format(way=sense.way, group=group)
        if "thing" in token.lists:
            yield Fact.THING_TOO.format(group=group, lead=self._lead)
        if token.color and " " in token.text:
            yield Fact.COLOR_THAT_IS.format(first=token.text.split()[0], group=group)
        if token.color and token.text.endswith("s") and not token.name.endswith("s"):
            yield Fact.PLURAL_COLOR.format(group=group)
        if token.color and token.entry:
            yield Fact.COLOR_AND_ENTRY.format(group=group)
        if target.mention >= 0:
            yield from self._named_facts(target, self.mentions[target.mention], group)
        else:
            yield from (fact.replace("{kind}", kind) for fact in self._unnamed)
            yield Fact.SORT_UNNAMED.format(sort=self._sort, kind=kind, turn=self._turn)

    def _unnamed_facts(self, is_noun: bool) -> Iterator[str]:
        """Facts about all targets that no noun names: what is named instead, and where the look word stands; "{kind}" is left open."""
        look, kind, items = self.look.index, "{kind}", self.items
        others = [m for m in self.mentions if not m.covers(look)]
        nouns = _kinds([m for m in others if items[m.start].clause != self._clause])
        yield Fact.UNNAMED_LED.format(kind=kind, lead=self._lead)
        yield Fact.UNNAMED_LED_RATHER.format(kind=kind, lead=self._lead, nouns=nouns)
        yield Fact.UNNAMED_TURN.format(kind=kind, turn=self._turn)
        # The nearest noun on each side: "white" of "piano in a white room" has the room after it
        own = [m for m in others if items[m.start].clause == self._clause]
        after = sorted((m for m in own if m.start > look), key=lambda m: (m.start, m.end))[:1]
        before = sorted((m for m in own if m.end < look), key=lambda m: (m.end, m.start))[-1:]
        sides = [(m, look, m.start, "after") for m in after] + [(m, m.end, look, "before") for m in before]
        for mention, low, high, side in sides:
            right = "right " if self.forms.look_at.issuperset(range(low + 1, high)) else ""
            yield Fact.UNNAMED_BESIDE.format(kind=kind, beside=f"{_kinds([mention])} {right}{side}")
        places = [p for p in self.forms.places[self._clause] if not items[p].filler]
        if len(places) == 1:
            yield Fact.UNNAMED_ALONE.format(kind=kind)
        if is_noun:
            yield Fact.UNNAMED_NOUN_TOO.format(kind=kind, name=self._name)
        for place in [p for p in places if p > look][:1]:
            yield Fact.UNNAMED_BEFORE.format(kind=kind, next=self.forms.role(place))
            yield Fact.UNNAMED_BEFORE.format(kind=kind, next=f"'{items[place].text}'")
            if "hour" in items[place].lists:
                yield Fact.UNNAMED_HOUR.format(kind=kind, sort=self._sort)

    def _named_facts(self, target: Target, mention: NounMention, group: str) -> Iterator[str]:
        """Facts about what a noun names: how the noun and the look word stand to each other, and how the noun fits."""
        if mention.covers(self.look.index):
            yield Fact.ITSELF.format(group=group, name=self._name)
            return
        yield from (Fact.BY_SIGN.format(group=group, sign=sign) for sign in target.signs)
        side = "after" if mention.start > self.look.index else "before"
        low, high = (self.look.index, mention.start) if side == "after" else (mention.end, self.look.index)
        apart = self.items[high].clause - self.items[low].clause
        where = f"{side}, {('same clause', 'next clause')[apart] if apart in (0, 1) else 'far clause'}"
        yield from self._place_facts(mention, group, where, low, high)
        # What the prompt leaves out
        if mention.excepted:
            yield Fact.SPARED.format(where=where, group=group)
        elif self.forms.spares:
            yield Fact.SPARES.format(kind=target.kind)
        # How sure it is that the noun names this
        yield Fact.BY_NOUN.format(kind=target.kind, noun=mention.noun or "of the scene")
        if self.token.adjective and any(mention.covers(place) for place in self.forms.look_at):
            yield Fact.BY_A_LOOK.format(adjective=self.token.adjective, kind=target.kind)
        ranks = {n.names: fit_rank(n) for n in mention.named}
        surest = ranks.get(target.names, 0) <= min(ranks.values(), default=0)
        yield (Fact.SUREST if surest else Fact.LESS_SURE).format(group=group)
        singular = mention.members == 1 and not mention.text.endswith("s")
        if len(target.names) > 1 and target.kind != "others" and singular:
            yield Fact.SEVERAL.format(group=group)
            yield from (Fact.SEVERAL_SIGN.format(group=group, sign=sign) for sign in target.signs)

    def _place_facts(
        self, mention: NounMention, group: str, where: str, low: int, high: int
    ) -> Iterator[str]:
        """Side, distance and clause of a noun, the ties between it and the look word, and the tie before it."""
        items, side = self.items, where.partition(",")[0]
        between = self.forms.passage.content(low + 1, high)
        yield Fact.PLACE.format(where=where, group=group)
        if not between and items[high].clause == items[low].clause:
            yield Fact.ADJOINS.format(side=side, group=group, sort=self._sort)
        yield Fact.BETWEEN.format(where=where, count=min(len(between), _FAR))
        yield Fact.LOOK_LED.format(where=where, lead=self._lead)
        for place in (place for place in range(low + 1, high) if items[place].ties):
            yield Fact.OVER.format(where=where, tie=items[place].text)
            own = side == "after" and not self.forms.look_at.isdisjoint(range(place, high))
            yield (Fact.OVER_WITH if own else Fact.OVER_WITHOUT).format(where=where, tie=items[place].text)
        if mention.members > 1:
            yield Fact.JOINED.format(where=where)
        before = [items[p] for p in self.forms.places[items[mention.start].clause] if p < mention.start]
        for item in reversed(before):
            if item.ties:
                yield Fact.NOUN_LED.format(where=where, tie=item.text)
                ties = (tie for tie in TIES if tie in item.lists)
                yield from (Fact.NOUN_LED_BY.format(where=where, tie=tie) for tie in ties)
            if not item.filler:
                return
        if not items[mention.start].filler:
            yield Fact.FIRST.format(where=where)


def _is_of_object(named: Named) -> bool:
    signs = (sign for sign in named.signs if not sign.endswith("synonym"))
    return named.kind == "things" and any(sign.startswith("object") for sign in signs)


def _kinds(mentions: list[NounMention]) -> str:
    """Kinds of what nouns name, in short."""
    kinds = {n.kind for m in mentions for n in m.named} | {m.noun for m in mentions if m.noun and not m.named}
    return " and ".join(sorted(kinds)) if len(kinds) <= 2 else "many"


def looks(
    text: str, words: SceneDescription, vocabulary: Vocabulary, foreign: Collection[str] = ()
) -> Passage:
    """A prompt with its look words, of which nothing is bound; `foreign` are words of another language that are left in it."""
    clauses = with_changes(Lexer(vocabulary, words, foreign).clauses(text), vocabulary)
    return passage(clauses, vocabulary)


def reading(
    text: str, words: SceneDescription, vocabulary: Vocabulary, foreign: Collection[str] = ()
) -> PromptPairs:
    """The pairs of a prompt, see `looks`."""
    found = looks(text, words, vocabulary, foreign)
    nouns = mentions(found, words.made(SceneIndex, vocabulary), vocabulary)
    every, own = targets(nouns, words), OwnNouns(found, nouns, vocabulary)
    forms, pairs = ClauseForms(found, nouns, vocabulary), []
    for look in found.looks:
        may_describe = [*every, Target(TINGE)] if found.tinged(look) else every
        chosen, changed = may_describe, own.changed(look.index)
        if changed and changed.named:  # in a change phrase only what its object names
            theirs = {number for number, noun in enumerate(nouns) if noun.covers(changed.start)}
            chosen = [t for t in may_describe if t.mention in theirs or t.kind == TINGE]
        if ground := own.ground(look.index):
            chosen = [target for target in every if target.kind == ground]
        if _is_a_tone(look, own.of(look.index), found, vocabulary):
            chosen = [target for target in every if target.kind == "picture"]
        may_be = _becomings(look, chosen, vocabulary) or _becomings(look, may_describe, vocabulary)
        facts = PairFeatures(look, forms)
        itself = {number for number, noun in enumerate(nouns) if noun.covers(look.index)}
        pairs.append(
            [
                TargetPair(look, t, b, tuple(sorted({*facts.of(t, b)})), t.mention in itself)
                for t, b in may_be.items()
            ]
        )
    return PromptPairs(found, nouns, pairs)


def _becomings(look: PromptLook, every: list[Target], vocabulary: Vocabulary) -> dict[Target, Sense]:
    """Targets that a look word can describe, with what it is there."""
    return {target: b for target in every if (b := sense_at(look.token, target.kind, vocabulary))}


def _is_a_tone(look: PromptLook, noun: NounMention | None, found: Passage, vocabulary: Vocabulary) -> bool:
    """Whether a color is the tone of the image: "everything is pink", "all gold and lazy", and nobody paints it so."""
    words, lists, color = vocabulary.words, vocabulary.lists, look.token.color
    if not color or noun is None or noun.text not in words["everything"] or noun.excepted:
        return False
    acts = words["paints"] | words["changes"] | lists["save"] | lists["exception"] | lists["refusal"]
    clause = [item for item in found.items if item.clause == found.items[look.index].clause]
    is_said = any(i.text in words["copulas"] or vocabulary.slot(i.entry) in _OF_LIGHT for i in clause)
    return (
        is_said and not any(i.text in acts for i in found.items) and chroma(lab_from_srgb(color)) > _GRAYISH
    )
