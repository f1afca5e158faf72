# SPDX-License-Identifier: Apache-2.0
"""The figures of a run over wild scenes: each scene's line, and what holds over all."""

from __future__ import annotations

import statistics
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from rich.console import Console
from rich.table import Table

Row = Mapping[str, Any]
_DISTANCES = ("delta_e", "p95", "delta_e_subject", "delta_e_before_last_anchor")


def summary(rows: Mapping[str, Row]) -> dict[str, Any]:
    """The content of results.json.

    Returns:
        `scenes`: how many; `pictures`: of those, with a picture that is not black; `refused`: with one clear line;
        `failed`: the names of those with neither; `exact_reverts` of `compared_reverts`; `words_shown` of
        `words` that claim something that can be measured; `clean`: nothing left behind; `delta_e`, `p95`,
        `delta_e_subject` and `delta_e_before_last_anchor`: median and 90th percentile; `seconds`: likewise; `rows`.
    """
    every = list(rows.values())
    compared = [row["revert"] for row in every if "revert" in row]
    return {
        "scenes": len(every),
        "pictures": sum(outcome(row) == "picture" for row in every),
        "refused": sum(outcome(row) == "refused" for row in every),
        "failed": [name for name, row in rows.items() if outcome(row) == "broken"],
        "exact_reverts": sum(each["differ"] == 0 for each in compared),
        "compared_reverts": len(compared),
        "words_shown": sum(sum(row.get("words", {}).values()) for row in every),
        "words": sum(len(row.get("words", {})) for row in every),
        "clean": sum(not row["left_behind"] for row in every),
        **{name: _spread(row.get(name) for row in every) for name in _DISTANCES},
        "seconds": _spread(row["seconds"] for row in every),
        "rows": dict(rows),
    }


def outcome(row: Row) -> str:
    """ "picture", "refused" with one line that says what to do, or "broken"."""
    if row["code"] == 0:
        return "broken" if row["black"] else "picture"
    return "refused" if row["code"] == 2 else "broken"


def line(row: Row) -> str:
    """One scene in a line."""
    if row["code"] != 0:
        return f"{outcome(row)}: {row['error']}"
    reverted = row.get("revert", {}).get("differ", "no .blend")
    parts = [
        f"CIEDE2000 {row['delta_e']:.1f}",
        f"p95 {row['p95']:.1f}",
        f"{row['seconds']:.0f} s",
        f"{row['memory_gb']} GB",
    ]
    missing = [word for word, shows in row.get("words", {}).items() if not shows]
    parts += [f"not shown: {', '.join(missing)}"] if missing else []
    extra = ["BLACK"] if row["black"] else []
    extra += [f"revert {reverted}"] if reverted != 0 else []
    extra += [f"left behind {len(row['left_behind'])}"] if row["left_behind"] else []
    return ", ".join([*parts, *extra])


def show(results: Mapping[str, Any]) -> None:
    """Prints every scene, the worst first, and what holds over all."""
    console = Console(width=None if Console().is_terminal else 180)
    table = Table(
        "scene", "outcome", "ΔE", "p95", "subject", "s", "read", "GB", "revert", "words", box=None, pad_edge=False
    )
    for name, row in sorted(results["rows"].items(), key=lambda pair: -(pair[1].get("delta_e") or 99)):
        figures = [
            row.get(key) for key in ("delta_e", "p95", "delta_e_subject", "seconds", "read_seconds", "memory_gb")
        ]
        reverted = row.get("revert", {}).get("differ", "")
        words = row.get("words", {})
        shown = f"{sum(words.values())} of {len(words)}" if words else ""
        table.add_row(name[-60:], outcome(row), *map(_cell, figures), str(reverted), shown)
    console.print(table)
    for name, row in results["rows"].items():
        if row["code"] != 0:
            console.print(f"{name}: {row['error']}", markup=False, highlight=False)
    console.print(_closing(results), markup=False, highlight=False)


def _closing(results: Mapping[str, Any]) -> str:
    apart = results["delta_e"]
    far = f"CIEDE2000 {apart['median']} / {apart['p90']}" if apart else "no prediction"
    return (
        f"{results['scenes']} scenes: {results['pictures']} pictures, {results['refused']} refused with a remedy, "
        f"{len(results['failed'])} broken; {results['exact_reverts']} of {results['compared_reverts']} reverts exact; "
        f"{results['clean']} left nothing behind; {results['words_shown']} of {results['words']} words show; {far} (median / 90th percentile)."
    )


def _spread(values: Iterable[float | None]) -> dict[str, float]:
    """Median and 90th percentile of what there is."""
    known: Sequence[float] = sorted(v for v in values if v is not None)
    if not known:
        return {}
    ninetieth = known[min(int(0.9 * len(known)), len(known) - 1)]
    return {"median": round(statistics.median(known), 2), "p90": round(ninetieth, 2)}


def _cell(value: float | None) -> str:
    return "" if value is None else f"{value:.1f}"
