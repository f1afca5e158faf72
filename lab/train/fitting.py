# SPDX-License-Identifier: Apache-2.0
"""Fits the weights of the reader's facts, a log-linear model.

Each look word chooses among its targets with a probability proportional to the exponential of the weights of the pair's
facts. What is maximized is the likelihood of the targets that are right, less an L2 penalty.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize
from scipy.sparse import csr_matrix

from proxy_renderer.words.model import FactWeights
from proxy_renderer.words.targets import PromptPairs, TargetPair

_LEAST = 3  # sentences in which a fact has to be
_UNTIL = {"maxiter": 300, "ftol": 1e-6}  # steps, and the share of the loss that a step has to gain


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
