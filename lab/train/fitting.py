# SPDX-License-Identifier: Apache-2.0
"""Fits the weights of the reader's facts: first those about pairs alone, then those about what links look words in a row.

The first are a log-linear model: each look word chooses among its targets with a probability proportional to the
exponential of the weights of the pair's facts. The second make a conditional random field of the row of look words
(Lafferty, McCallum, Pereira 2001). What is maximized is the likelihood of the targets that are right, less an L2 penalty.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise, zip_longest
from typing import TypeVar

import numpy as np
from scipy.optimize import minimize
from scipy.sparse import csr_matrix
from scipy.special import logsumexp

from proxy_renderer.words.model import FactWeights, likeliest, link
from proxy_renderer.words.targets import PromptPairs, TargetPair

_LEAST = 3  # sentences in which a fact has to be
_WRONG = -1e9  # logarithm of a probability of nothing
_UNTIL = {"maxiter": 300, "ftol": 1e-6}  # steps, and the share of the loss that a step has to gain
T = TypeVar("T")


@dataclass(frozen=True)
class Example:
    """A labeled sentence as the reader takes it.

    Attributes:
        scene: Name of the sentence's scene.
        read: Its look words with all their pairs.
        right: Of each look word's pairs, whether they are what the label says; nowhere, where none can be.
        counts: How much the sentence counts beside others of its length.
    """

    scene: str
    read: PromptPairs
    right: tuple[tuple[bool, ...], ...]
    counts: float = 1.0

    @property
    def decided(self) -> list[tuple[list[TargetPair], tuple[bool, ...]]]:
        """The pairs of each look word for which something right can be chosen."""
        return [(p, r) for p, r in zip(self.read.pairs, self.right, strict=True) if any(r)]


def fit_pairs(every: Sequence[Example], l2: float) -> FactWeights:
    """The weights of facts about pairs.

    A sentence of n look words counts as much as the root of n of one: prompts are short, and most labeled words stand in long ones.

    Args:
        l2: Weight of the penalty: half of it times the sum of squares.
    """
    words = [word for example in every for word in example.decided]
    if not words:
        return {}
    counts: dict[str, set[int]] = {}
    for number, (pairs, _) in enumerate(words):
        for pair in pairs:
            for name in pair.features:
                counts.setdefault(name, set()).add(number)
    names = sorted(name for name, where in counts.items() if len(where) >= _LEAST)
    column = {name: i for i, name in enumerate(names)}
    matrix = _matrix([pairs for pairs, _ in words], column)
    sizes = [len(pairs) for pairs, _ in words]
    starts = np.cumsum([0, *sizes])[:-1]
    right = np.concatenate([right for _, right in words])
    each = np.concatenate([np.full(n := len(e.decided), e.counts / max(n, 1) ** 0.5) for e in every])
    each *= len(each) / each.sum()
    of_pairs = np.repeat(each, sizes)

    def loss(weights: np.ndarray) -> tuple[float, np.ndarray]:
        found = matrix @ weights
        whole, wanted = _share(found, starts), _share(np.where(right, found, -np.inf), starts)
        value = float(each @ (whole[0] - wanted[0]))
        return value, matrix.T @ (of_pairs * (whole[1] - wanted[1]))

    return _least(loss, names, l2)


def fit_links(every: Sequence[tuple[Example, Mapping[str, float]]], l2: float) -> FactWeights:
    """The weights of facts about links.

    Args:
        every: Sentences, each with the weights of facts about pairs that were fitted without its scene.
    """
    rows = [_row(example, weights) for example, weights in every if len(example.read.pairs) > 1]
    if not rows:
        return {}
    rows.sort(key=lambda row: -len(row.likely))
    names = sorted({name for row in rows for step in row.links for line in step for name in line})
    column = {name: i for i, name in enumerate(names)}
    likely = [_padded(scores) for scores in _by_place(row.likely for row in rows)]
    widths = pairwise(scores.shape[1] for scores in likely)
    by_place = zip(_by_place(row.links for row in rows), widths, strict=True)
    steps = [_padded_links(links, column, both) for links, both in by_place]
    every_place = np.concatenate([step.ravel() for step in steps])
    wanted = [_padded(scores) for scores in _by_place(row.wanted for row in rows)]

    def loss(weights: np.ndarray) -> tuple[float, np.ndarray]:
        links = [weights[step] for step in steps]
        whole, shares = _chains(likely, links)
        rightly, right_shares = _chains(wanted, links)
        return whole - rightly, np.bincount(every_place, shares - right_shares, len(names))

    return _least(loss, names, l2)


@dataclass(frozen=True)
class _Row:
    """A sentence's likeliest pairs: logarithms of their probabilities, the same of those that are right, and their links."""

    likely: list[np.ndarray]
    wanted: list[np.ndarray]
    links: list[list[list[str]]]


def _row(example: Example, weights: Mapping[str, float]) -> _Row:
    kept, likely, wanted = [], [], []
    for pairs, right in zip(example.read.pairs, example.right, strict=True):
        rights = {id(pair) for pair, is_right in zip(pairs, right, strict=True) if is_right}
        best = likeliest(pairs, weights)
        found = np.array([score for _, score in best])
        may = np.array([id(pair) in rights for pair, _ in best])
        kept.append([pair for pair, _ in best])
        likely.append(found)
        wanted.append(np.where(may, found, _WRONG) if may.any() else found)
    passage = example.read.passage
    links = [[[link(passage, a, b) for b in other] for a in one] for one, other in pairwise(kept)]
    return _Row(likely, wanted, links)


def _by_place(rows: Iterable[Sequence[T]]) -> list[list[T]]:
    """Entries of the rows, longest first, at the first place, at the second, and so on."""
    return [[one for one in place if one is not None] for place in zip_longest(*rows)]


def _padded(scores: list[np.ndarray]) -> np.ndarray:
    """(sentences, pairs): the scores of one place; what is no pair is never chosen."""
    padded = np.full((len(scores), max(map(len, scores))), _WRONG)
    for row, found in zip(padded, scores, strict=True):
        row[: len(found)] = found
    return padded


def _padded_links(links: list[list[list[str]]], column: Mapping[str, int], widths: tuple[int, int]) -> np.ndarray:
    """(sentences, pairs, pairs of the next place): which fact links them; any, where there is no pair."""
    padded = np.zeros((len(links), *widths), dtype=int)
    for number, lines in enumerate(links):
        for place, line in enumerate(lines):
            padded[number, place, : len(line)] = [column[name] for name in line]
    return padded


def _chains(scores: list[np.ndarray], links: list[np.ndarray]) -> tuple[float, np.ndarray]:
    """Logarithm of the sum over all rows of choices, and the share of each two choices in a row: forward and backward.

    Args:
        scores: Of each place, (sentences that are as long, pairs); the longest sentence is the first.
        links: Between each two places, (sentences, pairs, pairs).
    """
    ahead = [scores[0]]
    for step, here in zip(links, scores[1:], strict=True):
        ahead.append(logsumexp(ahead[-1][: len(here), :, None] + step, axis=1) + here)
    longer = [*map(len, scores[1:]), 0]
    ends = [logsumexp(all_[n:], axis=1) for all_, n in zip(ahead, longer, strict=True)]
    whole = np.concatenate(ends[::-1])
    behind = np.zeros_like(scores[-1])
    shares = []
    for step, here, before in zip(links[::-1], scores[:0:-1], ahead[-2::-1], strict=True):
        after = step + (behind + here)[:, None, :]
        both = before[: len(here), :, None] + after - whole[: len(here), None, None]
        shares.append(np.exp(both).ravel())
        behind = np.zeros_like(before)
        behind[: len(here)] = logsumexp(after, axis=2)
    return float(whole.sum()), np.concatenate(shares[::-1])


def _least(loss: Callable[[np.ndarray], tuple[float, np.ndarray]], names: list[str], l2: float) -> FactWeights:
    """The weights at which loss and penalty are least."""

    def penalized(weights: np.ndarray) -> tuple[float, np.ndarray]:
        value, slope = loss(weights)
        return value + 0.5 * l2 * float(np.square(weights).sum()), slope + l2 * weights

    found = minimize(penalized, np.zeros(len(names)), jac=True, method="L-BFGS-B", options=_UNTIL)
    return {name: float(w) for name, w in zip(names, found.x, strict=True)}


def _matrix(words: list[list[TargetPair]], column: dict[str, int]) -> csr_matrix:
    """(pairs, facts): which pair has which fact."""
    rows = [[column[n] for n in pair.features if n in column] for pairs in words for pair in pairs]
    ends = np.cumsum([0, *map(len, rows)])
    columns = np.array([c for row in rows for c in row])
    return csr_matrix((np.ones(len(columns)), columns, ends), shape=(len(rows), len(column)))


def _share(found: np.ndarray, starts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of each word the logarithm of the sum of exponentials of its scores, and of each pair its share of that sum."""
    sizes = np.diff([*starts, len(found)])
    most = np.maximum.reduceat(found, starts)
    raised = np.exp(found - np.repeat(most, sizes))
    sums = np.add.reduceat(raised, starts)
    return most + np.log(sums), raised / np.repeat(sums, sizes)
