# SPDX-License-Identifier: Apache-2.0
"""The figures of `python -m lab like`: medians with intervals, by part."""

from __future__ import annotations

import random
import statistics
from collections.abc import Mapping, Sequence
from typing import Any

from rich.console import Console
from rich.table import Table

LikeRow = Mapping[str, Any]
_RESAMPLES = 2000


def summary(rows: Sequence[LikeRow]) -> dict[str, Any]:
    """The content of results.json.

    Returns:
        `parts`: by part, the number of `tasks` and of those that are `done`, by entry ("before", "after" and each 2D method) the
        medians `delta_e` and `mse`, each with a 95 % interval, and `errors` of the key light after and before; `failed`; `rows`.
        `extra_seconds`: median of the time from start to end beyond that of a vibe in words of the same scene.
    """
    parts = {
        part: _part([row for row in rows if row["part"] == part]) for part in dict.fromkeys(r["part"] for r in rows)
    }
    extra = [row["seconds"] - row["words_seconds"] for row in rows if "words_seconds" in row]
    return {
        "parts": parts,
        "extra_seconds": median(extra),
        "failed": {row["task"]: row["error"] for row in rows if row["code"] != 0},
        "rows": list(rows),
    }


def median(values: Sequence[float]) -> dict[str, Any]:
    """The median of some values, with the 95 % interval of a bootstrap, and how many they are."""
    if not values:
        return {"median": None, "interval": [None, None], "count": 0}
    luck = random.Random(0)
    drawn = sorted(statistics.median(luck.choices(values, k=len(values))) for _ in range(_RESAMPLES))
    interval = [round(drawn[round(share * (_RESAMPLES - 1))], 3) for share in (0.025, 0.975)]
    return {"median": round(statistics.median(values), 3), "interval": interval, "count": len(values)}


def _part(rows: Sequence[LikeRow]) -> dict[str, Any]:
    done = [row for row in rows if row["code"] == 0]
    entries = dict.fromkeys(name for row in done for name in row["differences"])
    names = dict.fromkeys(name for row in done for name in row["errors"])
    return {
        "tasks": len(rows),
        "done": len(done),
        "entries": {
            entry: {
                figure: median([row["differences"][entry][figure] for row in done if entry in row["differences"]])
                for figure in ("delta_e", "mse")
            }
            for entry in entries
        },
        "errors": {
            name: {
                "after": median([row["errors"][name] for row in done if name in row["errors"]]),
                "before": median([row["errors_before"][name] for row in done if name in row["errors"]]),
            }
            for name in names
        },
    }


def line(row: LikeRow) -> str:
    """One task in a line."""
    if row["code"] != 0:
        return f"FAILED: {row['error']}"
    apart = ", ".join(f"{name} {each['delta_e']:.1f}" for name, each in row["differences"].items())
    facts = [f"{name} {row['errors_before'][name]:.4g} -> {error:.4g}" for name, error in row["errors"].items()]
    facts.append(f"{row['seconds']:.0f} s")
    if "words_seconds" in row:
        facts.append(f"in words {row['words_seconds']:.0f} s")
    return f"{apart} ({', '.join(facts)})"


def show(results: Mapping[str, Any]) -> None:
    """Prints the tables."""
    table = Table("part", "picture", "CIEDE2000", "95 % interval", "MSE x 100", "tasks", box=None, pad_edge=False)
    errors = Table("part", "key light", "before", "after", "95 % interval", "tasks", box=None, pad_edge=False)
    for part, each in results["parts"].items():
        for entry, figures in each["entries"].items():
            apart, mse = figures["delta_e"], figures["mse"]
            table.add_row(part, entry, _text(apart), _between(apart), _text(mse), str(apart["count"]))
        for name, error in each["errors"].items():
            after = error["after"]
            errors.add_row(part, name, _text(error["before"]), _text(after), _between(after), str(after["count"]))
    console = Console(width=None if Console().is_terminal else 120)
    console.print(table)
    console.print(errors)
    extra = results["extra_seconds"]
    console.print(f"A vibe took {_text(extra)} s more than one in words ({_between(extra)}).", highlight=False)


def _text(value: Mapping[str, Any]) -> str:
    return "" if value["median"] is None else f"{value['median']:.4g}"


def _between(value: Mapping[str, Any]) -> str:
    low, high = value["interval"]
    return "" if low is None else f"{low:.4g} to {high:.4g}"
