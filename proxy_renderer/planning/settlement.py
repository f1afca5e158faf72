# SPDX-License-Identifier: Apache-2.0
"""The ranges that words agree on; where they contradict each other, the one that counts most has its way."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from ..schema import Instance, Values, labels
from .demands import Demand
from .ranges import within


@dataclass(frozen=True)
class Agreement:
    """What is settled for one parameter.

    Attributes:
        lower: Of its range.
        upper: Likewise.
        winners: The demands that it comes from, the one that counts most first.
    """

    lower: Values
    upper: Values
    winners: list[Demand]


class Settlement:
    """The demands of a prompt's words, and what they come to."""

    def __init__(self) -> None:
        self._demands: dict[str, list[Demand]] = {}
        self._settled: dict[str, Agreement] = {}
        self._beaten: dict[tuple[str, str], dict[str, None]] = {}

    def add(self, demands: Iterable[Demand]) -> None:
        """Settles the parameters of more demands anew."""
        keys: dict[str, None] = {}  # a set would be in another order each time
        for demand in demands:
            self._demands.setdefault(demand.key, []).append(demand)
            keys[demand.key] = None
        for key in keys:
            self._settled[key] = self._agreement(sorted(self._demands[key], key=lambda d: d.rank))

    def of(self, key: str) -> Agreement | None:
        """What is settled for a parameter; None where no word is about it."""
        return self._settled.get(key)

    def value(self, instance: Instance) -> Values:
        """The artist's value, projected into what is settled so far."""
        found = self._settled.get(instance.key)
        if found is None:
            return instance.value
        return within(found.winners[0].start or instance.value, found.lower, found.upper)

    def notes(self) -> Iterator[str]:
        """Says which words gave way to which."""
        for (loser, winner), lost in self._beaten.items():
            yield (
                f"'{loser}' gives way to '{winner}' on {labels.titles(list(lost))}: "
                "they contradict each other; what a word is mainly about counts most, then what comes first."
            )

    def _agreement(self, ranked: list[Demand]) -> Agreement:
        """What is left of the first one's range by the others that agree with it."""
        first, *others = _led_by_color(ranked)
        lower, upper, winners = first.lower, first.upper, [first]
        for demand in others:
            if demand.usual and not first.usual:
                continue
            low, high = _shared(lower, upper, demand)
            agrees = _is_range(low, high)
            if agrees and not first.start:  # what is left of a named color's room would be another color
                lower, upper, winners = low, high, [*winners, demand]
            elif (demand.start or not agrees) and _is_beaten(demand, first):
                pair = demand.attribute.word, first.attribute.word
                self._beaten.setdefault(pair, {})[demand.key] = None
        return Agreement(lower, upper, winners)


def _shared(lower: Values, upper: Values, demand: Demand) -> tuple[Values, Values]:
    """What a range has in common with that of a demand."""
    return tuple(map(max, lower, demand.lower)), tuple(map(min, upper, demand.upper))


def _is_range(lower: Values, upper: Values) -> bool:
    return all(a <= b for a, b in zip(lower, upper, strict=True))


def _led_by_color(ranked: list[Demand]) -> list[Demand]:
    """The demands, with a color that is said before that of a material that contradicts it: "burnt red" is red."""
    first = ranked[0]
    alike = [d for d in ranked if d.rank[:3] == first.rank[:3] and d.attribute.color]
    said = next((d for d in alike if not _is_range(*_shared(first.lower, first.upper, d))), None)
    if said is None or first.attribute.color:
        return ranked
    return [said, *(demand for demand in ranked if demand is not said)]


def _is_beaten(demand: Demand, first: Demand) -> bool:
    """Whether artists should hear that a demand gives way: both were said, and mean what they say."""
    return not any(demand.rank[:3] + first.rank[:3]) and demand.reason != first.reason
