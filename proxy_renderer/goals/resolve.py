# SPDX-License-Identifier: Apache-2.0
"""The one place where it is decided which word wins."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

from ..schema import VibeError
from ..schema.parameters import SURFACES
from ..words.lexicon.user_words import default_vocabulary
from ..words.lexicon.vocabulary import Vocabulary
from ..words.parser import Understood
from ..words.types import Attribute, Parsed
from .contradictions import contradicts
from .wish import Wish, wishes_of


@dataclass(frozen=True)
class Lost:
    """A wish that is not sought, and the winner: one that it contradicts and that ranks before it."""

    wish: Wish
    winner: Wish

    @property
    def is_news(self) -> bool:
        """True if artists should hear of it: both were said, and mean what they say. Words come before a picture, as expected."""
        unsaid = (w.implied or w.usual or w.of_picture for w in (self.wish, self.winner))
        return not any(unsaid)

    def __str__(self) -> str:
        return f"'{self.wish.word}' gives way to '{self.winner.word}': they contradict each other on {self.wish.about.says}."


@dataclass(frozen=True)
class Goals:
    """Goals for the image: the bound prompt, the wishes that are sought, in its order, and those that gave way."""

    parsed: Parsed
    wishes: tuple[Wish, ...] = ()
    lost: tuple[Lost, ...] = ()
    shown: tuple[Wish, ...] = ()  # what an image has to show of a rig that its words stand for
    holds: bool = False  # whether they go on from an image of which the rest stays, see `further`

    @cached_property
    def pictured(self) -> tuple[Wish, ...]:
        """The wishes of a reference image that are sought."""
        return tuple(wish for wish in self.wishes if wish.of_picture)

    def with_picture(self, pictured: Iterable[Wish]) -> Goals:
        """The same goals with the wishes of a reference image, in the place of those of an earlier one."""
        every = (*self.wishes, *(each.wish for each in self.lost))
        return resolved(self.parsed, [*(wish for wish in every if not wish.of_picture), *pictured])

    @cached_property
    def classes(self) -> dict[str, str]:
        """Quantity -> the class that the image or its subject is to be of, by the wish that ranks first."""
        ranked = sorted(self.wishes, key=lambda wish: wish.rank)
        return {wish.quantity: wish.named for wish in reversed(ranked) if wish.named}

    @cached_property
    def overruled(self) -> tuple[Attribute, ...]:
        """The words of which nothing is sought, or none of the classes that they name."""
        named = [wish.attribute for wish in self.wishes if wish.named]
        sought = [wish.attribute for wish in self.wishes]
        lost = (each.wish for each in self.lost)
        out = (w.attribute for w in lost if w.attribute not in (named if w.named else sought))
        return tuple(dict.fromkeys(out))

    def notes(self) -> Iterator[str]:
        """Sentences on the words that gave way to others."""
        return (str(each) for each in self.lost if each.is_news)


def goals_or_why(understood: Understood) -> Goals | VibeError:
    """The goals of a prompt, or why nothing in it is understood."""
    return understood.unknown or goals_of(understood.parsed)


def goals_of(parsed: Parsed, vocabulary: Vocabulary | None = None) -> Goals:
    """The goals of a prompt, its contradictions resolved."""
    wishes = wishes_of(parsed.attributes, vocabulary or default_vocabulary())
    return resolved(parsed, wishes)


def resolved(parsed: Parsed, wishes: Sequence[Wish]) -> Goals:
    """Goals of wishes: by rank, each is kept unless it contradicts one that is kept already."""
    idle: set[int] = set()  # words whose supporting wishes are out; what they had won goes back to others
    while True:
        kept, lost = _by_rank([wish for wish in wishes if wish.is_seen or id(wish.attribute) not in idle])
        unseen = _unseen(kept, lost)
        if unseen.keys() <= idle:
            break
        idle |= unseen.keys()
    for wish in sorted(wishes, key=lambda each: each.rank):
        if wish.is_seen or id(wish.attribute) not in idle:
            continue
        pairs = ((each, sorted((each, wish), key=lambda w: w.rank)) for each in kept)
        opponent = next((each for each, pair in pairs if contradicts(*pair)), None)
        winner = unseen.get(id(wish.attribute)) or opponent
        if winner is None:
            kept.append(wish)
        else:
            lost.append(Lost(wish, winner))
    sought = {id(wish) for wish in kept}
    return Goals(parsed, tuple(wish for wish in wishes if id(wish) in sought), tuple(lost))


def _by_rank(wishes: Sequence[Wish]) -> tuple[list[Wish], list[Lost]]:
    """The wishes that are kept, and those that contradict one that ranks before them."""
    kept: list[Wish] = []
    lost: list[Lost] = []
    for wish in sorted(wishes, key=lambda each: each.rank):  # words of one rank in the order of the prompt
        winner = next((first for first in kept if contradicts(first, wish)), None)
        if winner is None:
            kept.append(wish)
        else:
            lost.append(Lost(wish, winner))
    return kept, lost


def _unseen(kept: Sequence[Wish], lost: Sequence[Lost]) -> dict[int, Wish]:
    """Words whose visible wishes all gave way -> the first winner. Of a material each quantity counts by itself."""
    main = (each for each in reversed(lost) if each.wish.is_seen and each.wish.attribute.slot not in SURFACES)
    winners = {id(each.wish.attribute): each.winner for each in main}
    sought = {id(wish.attribute) for wish in kept if wish.is_seen}
    return {word: winner for word, winner in winners.items() if word not in sought}
