# SPDX-License-Identifier: Apache-2.0
"""Gives each look word its target, so that the whole prompt is as likely as can be."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from .model import scores
from .pairs import TargetPair
from .targets import LAMPS

_AGAIN = 1.0  # cost of a second color for one thing
_ALONE = ("things", "subject", "surroundings", "sky", "air", "light", *LAMPS)
"""Kinds of targets that have one color."""
_NEVER = 1e6


def assigned(pairs: Sequence[Sequence[TargetPair]], weights: Mapping[str, float]) -> list[TargetPair]:
    """The pair of each look word.

    Every word gets one target. A thing that has a color gets a second one only if nothing else is about as likely.

    Args:
        pairs: Of each look word.
        weights: By feature.
    """
    import numpy as np
    from scipy.optimize import linear_sum_assignment

    if not pairs:
        return []
    seats: dict[tuple[object, ...], int] = {}
    choices: list[dict[int, tuple[float, TargetPair]]] = []
    for row, each in enumerate(pairs):
        choices.append({})
        for number, (pair, score) in enumerate(zip(each, scores(each, weights), strict=True)):
            alone = (
                pair.becoming.slot == "color" and pair.target.kind in _ALONE and not pair.look.word.negated
            )
            own = seats.setdefault((row, number), len(seats))
            choices[row][own] = (-score + (_AGAIN if alone else 0.0), pair)
            if alone:
                place = seats.setdefault((pair.target.kind, pair.target.names), len(seats))
                known = choices[row].get(place)
                if known is None or -score < known[0]:
                    choices[row][place] = (-score, pair)
    costs = np.full((len(pairs), len(seats)), _NEVER)
    for row, seated in enumerate(choices):
        for seat, (cost, _) in seated.items():
            costs[row, seat] = cost
    return [choices[row][seat][1] for row, seat in zip(*linear_sum_assignment(costs), strict=True)]


def anything(pairs: Sequence[Sequence[TargetPair]], weights: Mapping[str, float]) -> list[TargetPair]:
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
