# SPDX-License-Identifier: Apache-2.0
"""The fitted weights, and what they say of pairs; `lab/train/binding.py` makes them."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from .pairs import TargetPair

FILE = Path(__file__).parents[1] / "lexicon" / "binding.json"
_LIKELY = 8
_LEAST = 1e-300  # probability of what is next to impossible
_SMALL = 0.02  # weights nearer to 0 are left out
FactWeights = dict[str, float]


def scores(pairs: Sequence[TargetPair], weights: Mapping[str, float]) -> list[float]:
    """Logarithms of the probabilities of a look word's targets."""
    raw = [sum(weights.get(name, 0.0) for name in pair.features) for pair in pairs]
    most = max(raw)
    whole = most + math.log(sum(math.exp(r - most) for r in raw))
    return [r - whole for r in raw]


def likeliest(pairs: Sequence[TargetPair], weights: Mapping[str, float]) -> list[tuple[TargetPair, float]]:
    """The few targets of a look word that its links to others may decide between, with their scores, best first.

    Pairs that come to the same, by one noun or by another, are one: the likeliest of them, as likely as all together.
    """
    same: dict[object, list[tuple[TargetPair, float]]] = {}
    for pair, score in zip(pairs, scores(pairs, weights), strict=True):
        same.setdefault((pair.target.kind, pair.target.names, pair.becoming), []).append((pair, score))
    pooled = []
    for group in same.values():
        together = math.log(sum(math.exp(score) for _, score in group) or _LEAST)
        pooled.append((max(group, key=lambda each: each[1])[0], together))
    return sorted(pooled, key=lambda each: -each[1])[:_LIKELY]


@cache
def shipped_weights() -> FactWeights:
    """The weights that are shipped."""
    weights: FactWeights = json.loads(FILE.read_text("utf-8"))["weights"]
    return weights


def write(path: Path, weights: Mapping[str, float], command: str, figures: Mapping[str, Any]) -> None:
    """Writes a file of weights."""
    kept = {name: round(w, 2) for name, w in weights.items() if abs(w) >= _SMALL}
    content = {"made by": command, "figures": dict(figures), "weights": kept}
    path.write_text(json.dumps(content, indent=0, ensure_ascii=False) + "\n", encoding="utf-8")
