# SPDX-License-Identifier: Apache-2.0
"""``python -m proxy_renderer.train.binding``: fits the weights of the reader to labeled sentences, in a minute on a CPU.

A log-linear model: each look word chooses among its targets with a probability proportional to the exponential of the
weights of the pair's features. What is maximized is the likelihood of the targets that are right, less an L2 penalty.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.optimize import minimize
from scipy.sparse import csr_matrix

from ..prompt.fitted.model import FILE, FactWeights, write
from ..prompt.fitted.pairs import TargetPair, reading
from ..prompt.lexicon.vocabulary import Vocabulary, shipped_vocabulary
from ..prompt.parser import prepared
from .sentences import read_folder
from .sentences.labels import LabeledSentence
from .sentences.right import right_pairs
from .sentences.stand_in import stand_in

L2 = 0.5
"""Of the penalty: half of it times the sum of squares."""
FOLDS = 5
_LEAST = 3  # sentences in which a feature has to be


@dataclass(frozen=True)
class Example:
    """A look word of a labeled sentence.

    Attributes:
        scene: Name of the sentence's scene.
        pairs: All of the word's.
        right: Of each pair, whether it is what the label says.
    """

    scene: str
    pairs: tuple[TargetPair, ...]
    right: tuple[bool, ...]


def examples(sentences: Sequence[LabeledSentence], vocabulary: Vocabulary) -> list[Example]:
    """The look words of sentences for which something right can be chosen.

    Args:
        sentences: With their labels.
        vocabulary: What words mean.
    """
    found = []
    for sentence in sentences:
        words = stand_in(sentence.scene).words
        said = prepared(sentence.text, words, vocabulary)
        read = reading(said, words, vocabulary)
        for pairs, right in zip(read.pairs, right_pairs(sentence, read), strict=True):
            if any(right):
                found.append(Example(sentence.scene.name, tuple(pairs), tuple(right)))
    return found


def fit(every: Sequence[Example], l2: float = L2) -> FactWeights:
    """The weights that make what is right likely.

    Args:
        every: Look words.
        l2: Weight of the penalty.
    """
    if not every:
        return {}
    counts: dict[str, set[int]] = {}
    for number, example in enumerate(every):
        for pair in example.pairs:
            for name in pair.features:
                counts.setdefault(name, set()).add(number)
    names = sorted(name for name, where in counts.items() if len(where) >= _LEAST)
    column = {name: i for i, name in enumerate(names)}
    matrix = _matrix(every, column)
    starts = np.cumsum([0, *(len(e.pairs) for e in every)])[:-1]
    right = np.concatenate([e.right for e in every])

    def loss(weights: np.ndarray) -> tuple[float, np.ndarray]:
        scores = matrix @ weights
        whole, wanted = _share(scores, starts), _share(np.where(right, scores, -np.inf), starts)
        value = float((whole[0] - wanted[0]).sum() + 0.5 * l2 * weights @ weights)
        return value, matrix.T @ (whole[1] - wanted[1]) + l2 * weights

    found = minimize(loss, np.zeros(len(names)), jac=True, method="L-BFGS-B", options={"maxiter": 300})
    return {name: float(w) for name, w in zip(names, found.x, strict=True)}


def _matrix(every: Sequence[Example], column: dict[str, int]) -> csr_matrix:
    """(pairs, features): which pair has which feature."""
    rows = [[column[n] for n in {*pair.features} if n in column] for e in every for pair in e.pairs]
    ends = np.cumsum([0, *map(len, rows)])
    columns = np.array([c for row in rows for c in row])
    return csr_matrix((np.ones(len(columns)), columns, ends), shape=(len(rows), len(column)))


def _share(scores: np.ndarray, starts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of each word the logarithm of the sum of exponentials of its scores, and of each pair its share of that sum."""
    sizes = np.diff([*starts, len(scores)])
    most = np.maximum.reduceat(scores, starts)
    raised = np.exp(scores - np.repeat(most, sizes))
    sums = np.add.reduceat(raised, starts)
    return most + np.log(sums), raised / np.repeat(sums, sizes)


def folds(sentences: Sequence[LabeledSentence], count: int = FOLDS) -> dict[str, int]:
    """The fold of each scene.

    Args:
        sentences: Of all scenes.
        count: How many folds there are.
    """
    names = sorted({s.scene.name for s in sentences})
    return {name: i % count for i, name in enumerate(names)}


def crossed(every: Sequence[Example], fold: dict[str, int], l2: float = L2) -> list[FactWeights]:
    """The weights of each fold, fitted to the scenes of the others.

    Args:
        every: Look words.
        fold: Of each scene.
        l2: Weight of the penalty.
    """
    return [fit([e for e in every if fold[e.scene] != n], l2) for n in range(max(fold.values()) + 1)]


def accuracy(every: Sequence[Example], weights: FactWeights) -> float:
    """The share of words whose likeliest target is right.

    Args:
        every: Look words.
        weights: Of the features.
    """
    hits = 0
    for example in every:
        scores = [sum(weights.get(n, 0.0) for n in pair.features) for pair in example.pairs]
        hits += example.right[int(np.argmax(scores))]
    return hits / max(len(every), 1)


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(prog="python -m proxy_renderer.train.binding", description=__doc__)
    parser.add_argument(
        "--sentences",
        type=Path,
        required=True,
        metavar="DIR",
        help="folder of scenes.toml and sentences_NN.toml",
    )
    parser.add_argument("--l2", type=float, default=L2, help="weight of the penalty (default: %(default)s)")
    parser.add_argument("--out", type=Path, default=FILE, help="file of weights (default: the one in use)")
    options = parser.parse_args()
    start = time.perf_counter()
    sentences = read_folder(options.sentences)
    every = examples(sentences, shipped_vocabulary())
    fold = folds(sentences)
    held = [
        accuracy([e for e in every if fold[e.scene] == n], weights)
        for n, weights in enumerate(crossed(every, fold, options.l2))
    ]
    weights = fit(every, options.l2)
    figures = {
        "look words": len(every),
        "right": round(accuracy(every, weights), 4),
        "right, of scenes left out": round(float(np.mean(held)), 4),
    }
    command = f"python -m proxy_renderer.train.binding --sentences {options.sentences} --l2 {options.l2:g}"
    write(options.out, weights, command, figures)
    print(f"{figures}; {len(weights)} weights in {options.out}; {time.perf_counter() - start:.0f} s")


if __name__ == "__main__":
    main()
