# SPDX-License-Identifier: Apache-2.0
"""Outcomes of prompts without labels: understood at least in part, refused with a remedy, or a fault."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from lab.bench.binding import table
from lab.bench.binding.explaining import explained
from lab.bench.sealed.table import share
from lab.train.sentences.labels import LabeledLight, LabeledScene
from lab.train.sentences.stand_in import SceneStandIn, stand_in
from proxy_renderer.schema import VibeError

BACKDROP, LAMP = "Cyclorama", LabeledLight("Area", "AREA", "key", turn=-40.0)
"""Parts of a scene other than its things, with names that captions do not use."""
_PLAIN = LabeledScene("plain", "product", ("Cube",), {n: (n,) for n in ("Cube", BACKDROP)}, lights=(LAMP,))
_SLOW = 1.0  # seconds of the processor that no prompt may take
_LISTED = 40  # words


@dataclass(frozen=True)
class _Outcome:
    kind: str  # "understood", "refused" or "fault"
    seconds: float  # of the processor
    unused: tuple[str, ...] = ()
    says: str = ""


def measured(texts: Iterable[str], misses: bool) -> dict[str, Any]:
    """Explains prompts in a scene of a cube, a backdrop and a lamp.

    Args:
        misses: List the words that most prompts are said to leave unused.

    Returns:
        `understood`: prompts that ask for at least one look, see `sealed.table.share`; `entire`: how many of them leave
        no word unused; `refused`: in one line with a remedy; `faults`: what else went wrong; `slow`: prompts that took
        more than a second of the processor; `milliseconds`: of the processor for a prompt; `unused`: word -> how many prompts.
    """
    whole = stand_in(_PLAIN)
    explained("red", whole)  # word vectors are loaded once
    outcomes = [_outcome(text, whole) for text in texts]
    results = {
        "understood": share(o.kind == "understood" for o in outcomes),
        "entire": sum(o.kind == "understood" and not o.unused for o in outcomes),
        "refused": sum(o.kind == "refused" for o in outcomes),
        "faults": [o.says for o in outcomes if o.kind == "fault"],
        "slow": sum(o.seconds > _SLOW for o in outcomes),
        "milliseconds": table.milliseconds([o.seconds for o in outcomes]),
    }
    unused = Counter(word for o in outcomes for word in o.unused)
    return results | ({"unused": dict(unused.most_common(_LISTED))} if misses else {})


def lines(results: Mapping[str, Any]) -> list[str]:
    """The figures in words, and what is unused where that is asked for.

    Args:
        results: Of `measured`.
    """
    unused = [f"{word}: unused in {count}" for word, count in results.get("unused", {}).items()]
    return [
        *unused,
        *results["faults"],
        f"Prompts understood at least in part: {table.told(results['understood'])}, {results['entire']} of them with no "
        f"word unused. Refused with a remedy: {results['refused']}. Faults: {len(results['faults'])}. "
        f"Longer than a second: {results['slow']}. A prompt took {table.taken(results['milliseconds'])} of the processor.",
    ]


def _outcome(text: str, whole: SceneStandIn) -> _Outcome:
    """Of one prompt; a refusal that has no remedy or several lines is a fault as much as any other error."""
    start = time.process_time()
    kind, says = "understood", ""
    unused: tuple[str, ...] = ()
    try:
        unused = tuple(dict.fromkeys(explained(text, whole).ignored))
    except VibeError as error:
        kind = "refused" if error.remedy and "\n" not in str(error) else "fault"
        says = f"{text}: {error}"
    except Exception as error:  # there should be none, which is what is measured
        kind, says = "fault", f"{text}: {error!r}"
    return _Outcome(kind, time.process_time() - start, unused, says)
