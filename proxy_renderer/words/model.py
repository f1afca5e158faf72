# SPDX-License-Identifier: Apache-2.0
"""The fitted weights, and the row of targets of a prompt that is likeliest by them: a conditional random field.

`lab/train/binding.py` makes the weights.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

from .passage import Passage
from .targets import NOWHERE, PromptPairs, TargetPair

if TYPE_CHECKING:
    import numpy as np

FILE = Path(__file__).with_name("lexicon") / "binding.json"
APART = ("to the next clause", "to a far clause", "side by side", "over a tie", "over others")
"""Ways in which two look words in a row stand to each other."""
ALIKE = (
    "both nowhere", "one nowhere", "same", "same, named by one", "same noun", "same kind", "others",
    "same, color and color", "same, color and material", "same, material and color", "same, material and material",
)  # fmt: skip
"""Ways in which their targets do; with a word about light also "same, SLOT and SLOT"."""
_LIKELY = 8  # targets of a look word that its links to others may decide between
_LEAST = 1e-300  # probability of what is next to impossible
FactWeights = dict[str, float]


@cache
def shipped_weights() -> FactWeights:
    """The weights that are shipped."""
    weights: FactWeights = json.loads(FILE.read_text("utf-8"))["weights"]
    return weights


def scores(pairs: Sequence[TargetPair], weights: Mapping[str, float]) -> list[float]:
    """Logarithms of the probabilities of a look word's targets."""
    raw = [sum(weights.get(name, 0.0) for name in pair.features) for pair in pairs]
    most = max(raw)
    whole = most + math.log(sum(math.exp(r - most) for r in raw))
    return [r - whole for r in raw]


def likeliest(pairs: Sequence[TargetPair], weights: Mapping[str, float]) -> list[tuple[TargetPair, float]]:
    """The few likeliest targets of a look word with their scores, best first.

    Pairs that come to the same, by one noun or by another, are one: the likeliest of them, as likely as all together.
    """
    same: dict[object, list[tuple[TargetPair, float]]] = {}
    for pair, score in zip(pairs, scores(pairs, weights), strict=True):
        same.setdefault((pair.target.kind, pair.target.names, pair.sense), []).append((pair, score))
    pooled = []
    for group in same.values():
        together = math.log(sum(math.exp(score) for _, score in group) or _LEAST)
        pooled.append((max(group, key=lambda each: each[1])[0], together))
    return sorted(pooled, key=lambda each: -each[1])[:_LIKELY]


def likeliest_row(read: PromptPairs, weights: Mapping[str, float]) -> list[TargetPair]:
    """The pair of each look word: the likeliest of all rows of pairs, each with what links it to the one before.

    Viterbi's algorithm (1967). If every word came to nothing, at least one has to describe something.
    """
    chosen = _viterbi(read.passage, read.pairs, weights)
    if any(pair.target.kind not in NOWHERE for pair in chosen):
        return chosen
    somewhere = [[p for p in each if p.target.kind not in NOWHERE] or each for each in read.pairs]
    return _viterbi(read.passage, somewhere, weights)


def _viterbi(
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


def probabilities(read: PromptPairs, weights: Mapping[str, float]) -> list[list[tuple[TargetPair, float]]]:
    """The likeliest pairs of each look word with marginal probabilities, best first (forward-backward, Rabiner 1989)."""
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
    """The fact about two pairs in a row: how the look words stand to each other, and how their targets do."""
    items, first, second = passage.items, one.look.index, other.look.index
    between = passage.content(first + 1, second)
    clauses = items[second].clause - items[first].clause
    if clauses:
        apart = APART[0] if clauses == 1 else APART[1]
    elif not between:
        apart = APART[2]
    else:
        apart = APART[3] if all(item.ties for item in between) else APART[4]
    return f"link {apart}: {_alike(one, other)}"


def _alike(one: TargetPair, other: TargetPair) -> str:
    a, b = one.target, other.target
    nowhere = (a.kind in NOWHERE) + (b.kind in NOWHERE)
    if nowhere:
        return "both nowhere" if nowhere == 2 else "one nowhere"
    if (a.kind, a.names) == (b.kind, b.names):
        slots = [pair.sense.slot for pair in (one, other) if not pair.look.negated]
        if ({*slots} <= {"color", "material"} and len(slots) == 2) or "lighting" in slots:
            return f"same, {' and '.join(slots)}"
        return "same, named by one" if one.names_itself != other.names_itself else "same"
    if a.mention >= 0 and a.mention == b.mention:
        return "same noun"
    return "same kind" if a.kind == b.kind else "others"
