# SPDX-License-Identifier: Apache-2.0
"""The fitted weights, and what they say of pairs; `train/binding.py` makes them."""

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
_SMALL = 0.02  # weights nearer to 0 are left out
FactWeights = dict[str, float]


def scores(pairs: Sequence[TargetPair], weights: Mapping[str, float]) -> list[float]:
    """Logarithms of the probabilities of a look word's targets.

    Args:
        pairs: All of one look word.
        weights: By feature.
    """
    raw = [sum(weights.get(name, 0.0) for name in {*pair.features}) for pair in pairs]
    most = max(raw)
    whole = most + math.log(sum(math.exp(r - most) for r in raw))
    return [r - whole for r in raw]


def likeliest(pairs: Sequence[TargetPair], weights: Mapping[str, float]) -> list[tuple[TargetPair, float]]:
    """The few targets of a look word that its links to others may decide between, with their scores, best first.

    Args:
        pairs: All of one look word.
        weights: By feature.
    """
    both = zip(pairs, scores(pairs, weights), strict=True)
    return sorted(both, key=lambda each: -each[1])[:_LIKELY]


@cache
def shipped_weights() -> FactWeights:
    """The weights that are shipped."""
    weights: FactWeights = json.loads(FILE.read_text("utf-8"))["weights"]
    return weights


def write(path: Path, weights: Mapping[str, float], command: str, figures: Mapping[str, Any]) -> None:
    """Writes a file of weights.

    Args:
        path: The file.
        weights: By feature.
        command: That made them.
        figures: What they reached.
    """
    kept = {name: round(w, 2) for name, w in weights.items() if abs(w) >= _SMALL}
    content = {"made by": command, "figures": dict(figures), "weights": kept}
    path.write_text(json.dumps(content, indent=0, ensure_ascii=False) + "\n", encoding="utf-8")
