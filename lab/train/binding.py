# SPDX-License-Identifier: Apache-2.0
"""``python -m lab fit``: fits the weights of the reader to labeled sentences."""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lab.train.fitting import Example, fit_pairs
from lab.train.sentences import read_folder
from lab.train.sentences.glossed import glossed
from lab.train.sentences.labels import LabeledSentence
from lab.train.sentences.right import right_pairs
from lab.train.sentences.stand_in import stand_in
from proxy_renderer.words.lexicon.vocabulary import Vocabulary, shipped_vocabulary
from proxy_renderer.words.model import FILE, FactWeights, likeliest, reading
from proxy_renderer.words.parser import prepared

_SMALL = 0.02  # weights nearer to 0 are left out of the file

L2 = 1.5
"""Of the penalty: half of it times the sum of squares."""
FOLDS = 5
HARD = 0.5
"""Weight of a hard sentence."""


def examples(sentences: Sequence[LabeledSentence], vocabulary: Vocabulary, counts: float = 1.0) -> list[Example]:
    """Sentences as the reader takes them.

    Args:
        counts: How much each counts beside others.
    """
    found = []
    scenes = {s.scene.name: s.scene for s in sentences}
    words_of = {name: stand_in(scene).scene for name, scene in scenes.items()}
    for artists in sentences:
        words = words_of[artists.scene.name]
        sentence = glossed(artists, words, vocabulary)
        read = reading(prepared(sentence.text, words, vocabulary), words, vocabulary)
        right = tuple(tuple(each) for each in right_pairs(sentence, read))
        found.append(Example(sentence.scene.name, read, right, counts))
    return found


@dataclass(frozen=True)
class Fitted:
    """Weights that make what is right likely.

    Attributes:
        weights: Fitted to all sentences.
        without: Scene -> weights that are fitted without its fold.
    """

    weights: FactWeights
    without: dict[str, FactWeights]


def fit(every: Sequence[Example], l2: float = L2, folds: int = FOLDS) -> Fitted:
    """Fits the weights.

    Args:
        folds: Parts into which the scenes are divided.
    """
    fold = {name: i % folds for i, name in enumerate(sorted({e.scene for e in every}))}
    weights = {n: fit_pairs([e for e in every if fold[e.scene] != n], l2) for n in {*fold.values()}}
    return Fitted(fit_pairs(every, l2), {scene: weights[n] for scene, n in fold.items()})


def accuracy(every: Sequence[tuple[Example, FactWeights]]) -> float:
    """The share of look words whose target is right, of those for which something right can be chosen."""
    right = []
    for example, weights in every:
        for pairs, may in example.decided:
            chosen = likeliest(pairs, weights)[0][0]
            right.append(may[next(i for i, p in enumerate(pairs) if p is chosen)])
    return sum(right) / max(len(right), 1)


def main(argv: Sequence[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser(prog="python -m lab fit", description=__doc__)
    parser.add_argument(
        "--sentences",
        type=Path,
        nargs="+",
        required=True,
        metavar="DIR",
        help="folders of sentences_NN.toml, with scenes.toml in them or in development beside them",
    )
    parser.add_argument(
        "--hard", type=Path, metavar="DIR", help="folder of harder ones than prompts are, which count half"
    )
    parser.add_argument("--l2", type=float, default=L2, help="weight of the penalty (default: %(default)s)")
    parser.add_argument("--out", type=Path, default=FILE, help="file of weights (default: the one in use)")
    options = parser.parse_args(argv)
    start = time.perf_counter()
    every = [e for folder in options.sentences for e in examples(read_folder(folder), shipped_vocabulary())]
    if options.hard:
        every += examples(read_folder(options.hard), shipped_vocabulary(), HARD)
    fitted = fit(every, options.l2)
    figures = {
        "look words": sum(len(e.decided) for e in every),
        "right": round(accuracy([(e, fitted.weights) for e in every]), 4),
        "right, of scenes left out": round(accuracy([(e, fitted.without[e.scene]) for e in every]), 4),
    }
    hard = f" --hard {options.hard}" if options.hard else ""
    folders = " ".join(map(str, options.sentences))
    command = f"python -m lab fit --sentences {folders}{hard} --l2 {options.l2:g}"
    write(options.out, fitted.weights, command, figures)
    print(f"{figures}; {len(fitted.weights)} weights in {options.out}; {time.perf_counter() - start:.0f} s")


def write(path: Path, weights: Mapping[str, float], command: str, figures: Mapping[str, Any]) -> None:
    """Writes a file of weights."""
    kept = {name: round(w, 2) for name, w in weights.items() if abs(w) >= _SMALL}
    content = {"made by": command, "figures": dict(figures), "weights": kept}
    path.write_text(json.dumps(content, indent=0, ensure_ascii=False) + "\n", encoding="utf-8")
