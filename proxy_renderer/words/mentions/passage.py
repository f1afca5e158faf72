# SPDX-License-Identifier: Apache-2.0
"""A prompt as a row of tokens, with the look words that are in it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from itertools import groupby, takewhile

from ..lexicon.vocabulary import Vocabulary
from ..tokens import Token
from ..types import STRONGEST, WEAKEST

_WISHES = {"action", "undo"}
_ENDS = {*_WISHES, "again"}
"""Lists of words that end a wish."""
LIGHTS = ("light", "fill", "rim")
"""Kinds of nouns that are lights."""


@dataclass(frozen=True)
class PromptLook:
    """A look word.

    Attributes:
        index: Its place among the items.
        token: The word itself.
        text: As the prompt says it, with its intensity and negation.
        strength: Of the intensities before it.
        negated: "no", "without", "not".
    """

    index: int
    token: Token
    text: str
    strength: float
    negated: bool

    @property
    def less(self) -> bool:
        """Whether it is to be there in a smaller degree than now: a step towards its opposite."""
        word_of_its_own = self.token.text.startswith("less ")  # "less contrast"
        return self.text.startswith("less ") and not word_of_its_own


@dataclass
class Passage:
    """A prompt's tokens and look words.

    Attributes:
        items: All tokens, with the numbers of their clauses.
        looks: The look words, in order.
        starts: Places of the items that begin a clause as it is written, those of a list too.
        wishes: What only a modeler can do, as the prompt says it.
        beyond: Words that no value can give.
    """

    items: list[Token]
    looks: list[PromptLook] = field(default_factory=list)
    starts: set[int] = field(default_factory=set)
    wishes: list[list[str]] = field(default_factory=list)
    beyond: list[str] = field(default_factory=list)

    def tinged(self, look: PromptLook) -> PromptLook | None:
        """The color right after a look word, whose shade the word may say."""
        clause = self.items[look.index].clause
        following = (other for other in self.looks if other.index == look.index + 1 and other.token.color)
        return next((other for other in following if self.items[other.index].clause == clause), None)

    def adjoin(self, one: PromptLook, other: PromptLook) -> bool:
        """Whether nothing but an intensity stands between two look words."""
        between = self.items[one.index + 1 : other.index]
        parted = self.starts.intersection(range(one.index + 1, other.index + 1))
        return not parted and all(item.strength is not None for item in between)

    def content(self, start: int, end: int) -> list[Token]:
        """The items from start to end that say something, without `end`."""
        return [item for item in self.items[max(start, 0) : end] if not item.filler]


def passage(clauses: list[list[Token]], vocabulary: Vocabulary) -> Passage:
    """Finds the look words.

    Args:
        clauses: Tokens of each clause, as the lexer gives them.
    """
    found = Passage([])
    for number, tokens in _listed(clauses):
        found.starts.add(len(found.items))
        found.items += _without_wishes(number, tokens, found)
    for _, clause in groupby(enumerate(found.items), key=lambda each: each[1].clause):
        found.looks += _looks(found, clause, vocabulary)
    found.beyond = [i.text for i in found.items if "beyond" in i.lists]
    return found


def _listed(clauses: list[list[Token]]) -> Iterator[tuple[int, list[Token]]]:
    """The clauses with their numbers; those of "red, green and blue balls" are one."""
    number = 0
    for place, tokens in enumerate(clauses):
        yield number, tokens
        following = clauses[place + 1] if place + 1 < len(clauses) else []
        listed = len(tokens) == 1 and tokens[0].color and len(following) > 2 and following[0].color
        number += not (listed and "listing" in following[1].lists)


def _without_wishes(number: int, tokens: list[Token], found: Passage) -> Iterator[Token]:
    """The tokens of a clause; what asks for things to be added or removed is marked."""
    until = 0
    for index, token in enumerate(tokens):
        if token.lists & _WISHES:
            asked = [*takewhile(lambda t: not t.lists & _ENDS, tokens[index + 1 :])]
            if not _speaks_of_looks(asked):
                until = index + 1 + len(asked)
                said = [t.text for t in tokens[index:until] if not t.lists & {"stop", "joiner"}]
                found.wishes.append(said)
        yield replace(token, clause=number, wished=index < until)


def _looks(
    found: Passage, clause: Iterable[tuple[int, Token]], vocabulary: Vocabulary
) -> Iterator[PromptLook]:
    """The look words of a clause, with the intensities and negations before them."""
    prefix: list[str] = []
    strength, negated = 1.0, False
    for index, token in clause:
        if token.wished or "beyond" in token.lists:
            continue
        following = next(iter(found.content(index + 1, len(found.items))), None)
        look = _look_token(token, negated, vocabulary)
        if token.strength is not None and _is_intensity(token, following, vocabulary):
            strength = min(max(strength * token.strength, WEAKEST), STRONGEST)
            prefix.append(token.text)
        elif token.lists & {"negation", "undo"}:
            negated = True
            prefix.append(token.text)
        elif look is not None:
            absent = look.entry != token.entry
            said = prefix if prefix or not negated else ["no"]
            text = " ".join([*said, token.text])
            yield PromptLook(index, look, text, strength, negated and not absent)
            prefix, strength = [], 1.0
        elif token.ties or token.lists & {"action"}:
            negated = negated and "either" in token.lists
        elif not token.filler:
            prefix, strength = [], 1.0


def _look_token(token: Token, negated: bool, vocabulary: Vocabulary) -> Token | None:
    """The token of a look word; what there is none of is one too: "no shadows". None for other tokens."""
    if negated and token.noun in vocabulary.absent and not token.entry:
        return replace(token, entry=vocabulary.absent[token.noun], noun="")
    return token if token.names_a_look else None


def _is_intensity(token: Token, following: Token | None, vocabulary: Vocabulary) -> bool:
    """Whether "strong" strengthens the next look word ("strong fog"), or is itself one ("strong light")."""
    if not token.names_a_look:
        return True
    if following is None or following.clause != token.clause or not following.names_a_look:
        return False
    nouns = (following.noun, "lamp") if following.noun in LIGHTS else (following.noun,)
    return vocabulary.adjectives.get(token.adjective, {}).keys().isdisjoint(nouns)


def _speaks_of_looks(tokens: list[Token]) -> bool:
    """Whether an action is about light, fog or the like, rather than about things."""
    speaks = any(t.entry or t.noun in (*LIGHTS, "fog") for t in tokens)
    return speaks and all(t.known and "count" not in t.lists for t in tokens)
