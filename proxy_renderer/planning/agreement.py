# SPDX-License-Identifier: Apache-2.0
"""Wishes as ranges of parameters: what is left of each parameter's range, by the wishes' rank."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from ..goals.wish import Wish
from ..schema import Instance, Values, labels
from ..words.lexicon.entries import OWNERS
from ..words.types import Attribute
from .ranges import within


@dataclass(frozen=True)
class WishedRange:
    """A wish, projected on one parameter.

    Attributes:
        key: Of the parameter.
        lower: Of its range.
        upper: Likewise.
        wish: What it serves.
        reason: For the artist; quotes the word.
        weak: A default, which gives way silently.
        priority: The smaller the more important.
        usual: It is what a place usually has: it counts only where no other word is about the parameter.
        aside: What the wish is about is said better by other words here.
        start: Where the search begins, as `PlanEntry.start`.
        any_hue: As `PlanEntry.any_hue`.
    """

    key: str
    lower: Values
    upper: Values
    wish: Wish
    reason: str
    weak: bool
    priority: int
    usual: bool = False
    aside: bool = False
    start: Values | None = None
    any_hue: bool = False

    @property
    def rank(self) -> tuple[bool | int, ...]:
        """As `Wish.rank`, with what counts of this parameter alone."""
        _, usual, implied, general, paint, vague, _, _ = self.wish.rank
        return self.weak, usual, implied, paint, self.priority, general, vague or self.aside

    @property
    def is_plain(self) -> bool:
        """Whether it is said, and is no default."""
        return not (self.weak or self.wish.implied or self.wish.usual)


@dataclass(frozen=True)
class Agreement:
    """What is left for one parameter.

    Attributes:
        lower: Of its range.
        upper: Likewise.
        winners: The ranges that it comes from, the one that ranks first first.
    """

    lower: Values
    upper: Values
    winners: list[WishedRange]


class Agreements:
    """The ranges that wishes leave each other."""

    def __init__(self) -> None:
        self._ranges: dict[str, list[WishedRange]] = {}
        self._agreed: dict[str, Agreement] = {}
        self._lost: dict[tuple[str, str], dict[str, None]] = {}

    def add(self, ranges: Iterable[WishedRange]) -> None:
        """Takes more ranges, and finds anew what is left of their parameters."""
        keys: dict[str, None] = {}  # a set would be in another order each time
        for each in ranges:
            self._ranges.setdefault(each.key, []).append(each)
            keys[each.key] = None
        for key in keys:
            self._agreed[key] = self._agreement(sorted(self._ranges[key], key=lambda r: r.rank))

    def of(self, key: str) -> Agreement | None:
        """What is left for a parameter; None where no wish is about it."""
        return self._agreed.get(key)

    def value(self, instance: Instance) -> Values:
        """The artist's value, projected into what is left so far."""
        found = self._agreed.get(instance.key)
        if found is None:
            return instance.value
        return within(found.winners[0].start or instance.value, found.lower, found.upper)

    def notes(self) -> Iterator[str]:
        """Says which words gave way to which on a parameter that both need."""
        for (loser, winner), keys in self._lost.items():
            yield f"'{loser}' gives way to '{winner}' on {labels.titles(list(keys))}: both need it."

    def _agreement(self, ranked: list[WishedRange]) -> Agreement:
        """The first range, narrowed by the others that have something in common with it."""
        first, *others = ranked
        lower, upper, winners = first.lower, first.upper, [first]
        for each in others:
            if each.usual and not first.usual:
                continue
            low, high = tuple(map(max, lower, each.lower)), tuple(map(min, upper, each.upper))
            agrees = all(a <= b for a, b in zip(low, high, strict=True))
            if agrees and not first.start:  # what is left of a named color's room would be another color
                lower, upper, winners = low, high, [*winners, each]
            elif (
                (each.start or not agrees)
                and first.is_plain
                and each.is_plain
                and each.reason != first.reason
            ):
                pair = each.wish.attribute.word, first.wish.attribute.word
                self._lost.setdefault(pair, {})[each.key] = None
        return Agreement(lower, upper, winners)


def lacking(owner: str) -> str:
    """What a scene has not got, for an effect's owner."""
    if owner in ("rim", "fill", "others"):
        return f"the scene has no light that could be the {'second' if owner == 'others' else owner} light; add one"
    return f"the scene has no {OWNERS[owner]} whose values may change so"


def reason_of(attribute: Attribute, phrase: str) -> str:
    """Quotes the word: "'glossy': glossy, with bright reflections", "'warm' in 'cosy'"."""
    if attribute.cause:
        return f"'{attribute.cause}' means '{attribute.word}'"
    what = f" on the {attribute.thing}" if attribute.color and attribute.thing else ""
    return f"'{attribute.word}'{what}" + (
        f" ({phrase})"
        if phrase and not (attribute.negated or attribute.shades) and phrase != attribute.word
        else ""
    )
