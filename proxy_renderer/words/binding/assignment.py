# SPDX-License-Identifier: Apache-2.0
"""Gives each look word its target, so that the whole prompt is as likely as can be."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

from ..mentions.passage import Passage
from .model import likeliest
from .pairs import PromptPairs, TargetPair
from .targets import NOWHERE

if TYPE_CHECKING:
    import numpy as np


def assigned(read: PromptPairs, weights: Mapping[str, float]) -> list[TargetPair]:
    """The pair of each look word: the likeliest of all rows of pairs, each with what links it to the one before.

    Viterbi's algorithm (1967). If every word came to nothing, at least one has to describe something.

    Args:
        weights: Of the facts about pairs and links.
    """
    chosen = _likeliest(read.passage, read.pairs, weights)
    if any(pair.target.kind not in NOWHERE for pair in chosen):
        return chosen
    somewhere = [[p for p in each if p.target.kind not in NOWHERE] or each for each in read.pairs]
    return _likeliest(read.passage, somewhere, weights)


def probabilities(read: PromptPairs, weights: Mapping[str, float]) -> list[list[tuple[TargetPair, float]]]:
    """The likeliest pairs of each look word with their marginal probabilities, in a prompt as a whole; the likeliest first.

    Forward and backward sums over all rows of pairs (Rabiner, 1989).

    Args:
        weights: Of the facts about pairs and links.
    """
    import numpy as np

    if not read.pairs:
        return []
    rows, scores, links = _chain(read.passage, read.pairs, weights)
    forward, backward = [scores[0]], [np.zeros(len(rows[-1]))]
    for tie, score in zip(links, scores[1:], strict=True):
        forward.append(np.logaddexp.reduce(forward[-1][:, None] + tie, axis=0) + score)
    for tie, score in zip(reversed(links), reversed(scores[1:]), strict=True):
        backward.append(np.logaddexp.reduce(tie + score + backward[-1], axis=1))
    found = []
    for row, before, after in zip(rows, forward, reversed(backward), strict=True):
        both = before + after
        marginal = np.exp(both - np.logaddexp.reduce(both)).tolist()
        found.append(sorted(zip(row, marginal, strict=True), key=lambda each: -each[1]))
    return found


def _likeliest(
    passage: Passage, pairs: Sequence[Sequence[TargetPair]], weights: Mapping[str, float]
) -> list[TargetPair]:
    if not pairs:
        return []
    rows, scores, links = _chain(passage, pairs, weights)
    total = scores[0]
    before: list[np.ndarray] = []
    for tie, score in zip(links, scores[1:], strict=True):
        both = total[:, None] + tie
        before.append(both.argmax(0))
        total = both.max(0) + score
    places = [int(total.argmax())]
    for came in reversed(before):
        places.append(int(came[places[-1]]))
    return [row[place] for row, place in zip(rows, reversed(places), strict=True)]


def _chain(
    passage: Passage, pairs: Sequence[Sequence[TargetPair]], weights: Mapping[str, float]
) -> tuple[list[list[TargetPair]], list[np.ndarray], list[np.ndarray]]:
    """The likeliest pairs of each look word, their scores, and the weights of the links between two words."""
    import numpy as np

    found = [likeliest(each, weights) for each in pairs]
    rows = [[pair for pair, _ in each] for each in found]
    scores = [np.array([score for _, score in each]) for each in found]
    links = [
        np.array([[weights.get(link(passage, a, b), 0.0) for b in other] for a in one])
        for one, other in pairwise(rows)
    ]
    return rows, scores, links


def link(passage: Passage, one: TargetPair, other: TargetPair) -> str:
    """The fact about two pairs in a row."""
    return f"{_apart(passage, one, other)}: {_alike(one, other)}"


def _apart(passage: Passage, one: TargetPair, other: TargetPair) -> str:
    """How two look words stand to each other, whatever they describe."""
    items, first, second = passage.items, one.look.index, other.look.index
    between = passage.content(first + 1, second)
    clauses = items[second].clause - items[first].clause
    if clauses:
        return "link to the next clause" if clauses == 1 else "link to a far clause"
    if not between:
        return "link side by side"
    if all(item.ties for item in between):
        return "link over a tie"
    return "link over others"


def _alike(one: TargetPair, other: TargetPair) -> str:
    """How two targets stand to each other."""
    a, b = one.target, other.target
    nowhere = (a.kind in NOWHERE) + (b.kind in NOWHERE)
    if nowhere:
        return "both nowhere" if nowhere == 2 else "one nowhere"
    if (a.kind, a.names) == (b.kind, b.names):
        slots = [pair.becoming.slot for pair in (one, other) if not pair.look.negated]
        if ({*slots} <= {"color", "material"} and len(slots) == 2) or "lighting" in slots:
            return f"same, {' and '.join(slots)}"
        return "same, named by one" if one.names_itself != other.names_itself else "same"
    if a.mention >= 0 and a.mention == b.mention:
        return "same noun"
    return "same kind" if a.kind == b.kind else "others"
