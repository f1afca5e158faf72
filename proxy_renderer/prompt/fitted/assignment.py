# SPDX-License-Identifier: Apache-2.0
"""Gives each look word its target, so that the whole prompt is as likely as can be."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence

import numpy as np
from scipy.optimize import linear_sum_assignment

from .model import scores
from .pairs import Pair
from .targets import LAMPS

_AGAIN = 1.0  # cost of a second color for one thing
_ALONE = ("things", "subject", "surroundings", "sky", "air", "light", *LAMPS)
"""Kinds of targets that have one color."""
_NEVER = 1e6


def assigned(pairs: Sequence[Sequence[Pair]], weights: Mapping[str, float]) -> list[Pair]:
    """The pair of each look word.

    Every word gets one target. A thing that has a color gets a second one only if nothing else is about as likely.

    Args:
        pairs: Of each look word.
        weights: By feature.
    """
    if not pairs:
        return []
    seats: dict[tuple[object, ...], int] = {}
    choices: list[dict[int, tuple[float, Pair]]] = []
    for each in pairs:
        likely = scores(each, weights)
        taken: Counter[object] = Counter()
        choices.append({})
        for pair, score in zip(each, likely, strict=True):
            place = _place(pair)
            taken[place] += 1
            for copy in range(len(pairs)):
                seat = seats.setdefault((place, taken[place], copy), len(seats))
                cost = -score + (_AGAIN if copy and place[-1] else 0.0)
                choices[-1][seat] = (cost, pair)
    costs = np.full((len(pairs), len(seats)), _NEVER)
    for row, seated in enumerate(choices):
        for seat, (cost, _) in seated.items():
            costs[row, seat] = cost
    return [choices[row][seat][1] for row, seat in zip(*linear_sum_assignment(costs), strict=True)]


def anything(pairs: Sequence[Sequence[Pair]], weights: Mapping[str, float]) -> list[Pair]:
    """The pair of each look word where at least one has to describe something.

    Args:
        pairs: Of each look word.
        weights: By feature.
    """
    chosen = assigned(pairs, weights)
    if any(pair.target.kind != "none" for pair in chosen):
        return chosen
    kept = [[p for p in each if p.target.kind != "none"] or list(each) for each in pairs]
    return assigned(kept, weights)


def _place(pair: Pair) -> tuple[object, ...]:
    """What a word takes of its target; the last part tells whether two of them contradict each other."""
    target, word = pair.target, pair.look.word
    contradicts = pair.becoming.slot == "color" and target.kind in _ALONE and not word.negated
    return target.kind, target.names, pair.becoming.slot, contradicts
