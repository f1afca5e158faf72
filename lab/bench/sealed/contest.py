# SPDX-License-Identifier: Apache-2.0
"""The product against a rival on the same jobs: a baseline with as many seconds in the loop or more, or its own plan alone."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from rich.console import Console

from lab.bench.paper.verdict import tally
from lab.bench.sealed.table import JobResult, claims_of, share
from lab.methods import BASELINES, Variation

_FEWEST = 12
"""A baseline's first steps, in one round; they tell how long a step takes."""

_SPARE = 1.1
"""Factor by which a baseline that had fewer seconds gets more steps than their ratio says, as two runs never take the same time."""


def rival_row(rival: str, rate: int, ours: JobResult, carry_out: Callable[[Variation], JobResult]) -> JobResult:
    """The rival's row of a job; a baseline's is of a run that had at least as many seconds in the loop as the product.

    Args:
        rival: A name of `METHODS`.
        rate: A baseline's greatest step, see `Variation`.
        carry_out: Carries the job out in another way, and returns its row.
    """
    if rival not in BASELINES:
        return carry_out(Variation(rival))
    steps = _FEWEST
    while True:
        row = carry_out(Variation(rival, rate, ("--rounds=1", f"--steps={steps}")))
        if not 0.0 < _seconds(row) < _seconds(ours):
            return row
        steps = math.ceil(_SPARE * steps * _seconds(ours) / _seconds(row))


def summary(ours: Sequence[JobResult], theirs: Sequence[JobResult]) -> dict[str, Any]:
    """Who shows more of what was asked for.

    Args:
        theirs: The rival's rows of the same jobs.

    Returns:
        `wins` by asks that hold, and `wins_seen` where none holds in a picture whose subject cannot be seen: each `win`, `tie`,
        `loss`, `win_rate`, in which a tie is half a win, and its `interval`; `asks`: those that the rival holds, and `claims`, of the
        words' claims; `seconds` and `rival_seconds`, the medians in the loop; `rows`, the rival's.
    """
    pairs = list(zip(ours, theirs, strict=True))
    held = [ask["holds"] for row in theirs for ask in row.get("asks", ()) if ask["holds"] is not None]
    lost = sum(row["asked"] for row in theirs if row["code"] != 0)
    return {
        "wins": tally([_verdict(_held(a), _held(b)) for a, b in pairs], tie=0.5),
        "wins_seen": tally([_verdict(_held_and_seen(a), _held_and_seen(b)) for a, b in pairs], tie=0.5),
        "asks": share([*held, *[False] * lost]),
        "claims": claims_of(theirs),
        "seconds": _median(ours),
        "rival_seconds": _median(theirs),
        "rows": list(theirs),
    }


def _verdict(ours: int, theirs: int) -> str:
    return "tie" if ours == theirs else "win" if ours > theirs else "loss"


def _held(row: JobResult) -> int:
    """Number of its asks that hold; none of a run that failed."""
    return sum(ask["holds"] is True for ask in row.get("asks", ()))


def _held_and_seen(row: JobResult) -> int:
    return _held(row) if row.get("seen") else 0


def _seconds(row: JobResult) -> float:
    return float(row.get("loop_seconds", 0.0))


def _median(rows: Sequence[JobResult]) -> float:
    return round(statistics.median(map(_seconds, rows)), 1)


def show(rival: str, figures: Mapping[str, Any]) -> None:
    """Prints who has won.

    Args:
        figures: `contest` of results.json.
    """
    console = Console(width=None if Console().is_terminal else 120)
    for name, says in (("wins", "asks"), ("wins_seen", "asks, and the subject is seen")):
        each = figures[name]
        low, high = each["interval"]
        line = f"Wins against {rival} by {says}: {each['win_rate']:.0%} ({low:.0%} to {high:.0%}), "
        line += f"{each['win']} won, {each['tie']} tied, {each['loss']} lost."
        console.print(line, markup=False, highlight=False)
    asks, claims = figures["asks"], figures["claims"]
    line = f"{rival} holds {asks['held']} of {asks['asked']} asks"
    line += f", {claims['held']} of {claims['asked']} claims. " if claims["asked"] else ". "
    line += f"In the loop, median: {figures['seconds']} s, {rival} {figures['rival_seconds']} s."
    console.print(line, markup=False, highlight=False)
