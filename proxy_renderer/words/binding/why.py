# SPDX-License-Identifier: Apache-2.0
"""Why each look word of a prompt is bound as it is: its likeliest targets, and the facts that decided."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from .model import scores
from .pairs import TargetPair
from .reader import PromptReader

_TARGETS, _FACTS = 4, 4  # lines for each look word, and facts in each line


def why(reader: PromptReader) -> str:
    """An account of a prompt, for people."""
    lines = ["Why (each look word with its likeliest targets, and the facts that weigh most)"]
    for pairs, chosen in zip(reader.found.pairs, reader.chosen, strict=True):
        lines.append(f"  {chosen.look.text}")
        lines += _targets(pairs, chosen, reader.weights)
    return "\n".join(lines)


def _targets(pairs: list[TargetPair], chosen: TargetPair, weights: Mapping[str, float]) -> Iterator[str]:
    """The likeliest targets of a look word, what is chosen marked by an arrow."""
    ranked = sorted(zip(scores(pairs, weights), pairs, strict=True), key=lambda both: -both[0])
    shown = ranked[:_TARGETS] + [each for each in ranked[_TARGETS:] if each[1] is chosen]
    for score, pair in shown:
        arrow = "→" if pair is chosen else " "
        facts = sorted(filter(weights.__contains__, pair.features), key=lambda name: -abs(weights[name]))[
            :_FACTS
        ]
        said = ", ".join(f"{name} {weights[name]:+.1f}" for name in facts)
        yield f"   {arrow} {math.exp(score):4.0%}  {pair.target}  ({said})"
