# SPDX-License-Identifier: Apache-2.0
"""The figures of measured materials and light sources."""

from __future__ import annotations

import statistics
from collections.abc import Mapping, Sequence
from typing import Any

from rich.console import Console
from rich.table import Table

_OFF = ("delta_e", "roughness", "ior", "transmission", "mireds", "hue")
_TITLES = {
    "delta_e": "ΔE",
    "roughness": "|Δ roughness|",
    "ior": "|Δ IOR|",
    "transmission": "|Δ transmission|",
    "kelvin": "K",
    "mireds": "|Δ mired|",
    "hue": "hue, °",
}


def summary(rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """The content of results.json.

    Args:
        rows: Of all materials and light sources.

    Returns:
        `material` and `light`: each `names`, how many; `known`, those of which no word was ignored; `metal_right`; and the
        medians of what is off, overall and of the known ones; `failed`: prompts without a picture; `rows`.
    """
    groups = {kind: [row for row in rows if row["kind"] == kind] for kind in ("material", "light")}
    return {
        **{kind: _group(group) for kind, group in groups.items() if group},
        "failed": {row["prompt"]: row["error"] for row in rows if row["code"] != 0},
        "rows": list(rows),
    }


def _group(rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    done = [row for row in rows if row["code"] == 0]
    known = [row for row in done if not row["ignored"]]
    right = {"metal_right": sum(row["metal_right"] for row in done)} if rows[0]["kind"] == "material" else {}
    figures = {"names": len(rows), "known": len(known), **right}
    return figures | {"median": _medians(done), "median_known": _medians(known)}


def _medians(rows: Sequence[Mapping[str, Any]]) -> dict[str, float]:
    values = {name: [row[name] for row in rows if row.get(name) is not None] for name in _OFF}
    return {name: round(statistics.median(each), 3) for name, each in values.items() if each}


def line(row: Mapping[str, Any]) -> str:
    """One row in a line."""
    if row["code"] != 0:
        return f"FAILED: {row['error']}"
    parts = [f"ignored: {', '.join(row['ignored'])}"] if row["ignored"] else []
    if "metal_right" in row:
        parts.append("metal or not: right" if row["metal_right"] else "metal or not: WRONG")
    parts += [f"{_TITLES[name]} {row[name]}" for name in ("kelvin", *_OFF) if row.get(name) is not None]
    return ", ".join(parts)


def show(results: Mapping[str, Any]) -> None:
    """Prints a table of each kind, and the medians."""
    console = Console(width=None if Console().is_terminal else 140)
    for kind, first in (("material", "metal"), ("light", "kelvin")):
        rows = [row for row in results["rows"] if row["kind"] == kind and row["code"] == 0]
        if not rows:
            continue
        names = [name for name in _OFF if any(row.get(name) is not None for row in rows)]
        table = Table(kind, "word", first, *(_TITLES[name] for name in names), box=None, pad_edge=False)
        for row in sorted(rows, key=lambda row: -(row.get(names[0]) or 0)):
            word = "ignored" if row["ignored"] else "known"
            verdict = ("right" if row["metal_right"] else "wrong") if kind == "material" else row["kelvin"]
            cells = ("" if row.get(name) is None else f"{row[name]:.2f}" for name in names)
            table.add_row(row["name"], word, "" if verdict is None else str(verdict), *cells)
        console.print(table)
        console.print(_closing(kind, results[kind]), markup=False, highlight=False)


def _closing(kind: str, figures: Mapping[str, Any]) -> str:
    right = f", {figures['metal_right']} right in being a metal or not" if "metal_right" in figures else ""
    medians = ", ".join(f"{_TITLES[name]} {value:g}" for name, value in figures["median"].items())
    return f"Of {figures['names']} names of a {kind} {figures['known']} are known{right}. Medians: {medians}."
