# SPDX-License-Identifier: Apache-2.0
"""The figures of a fidelity run: per scene, per feature, over all; as data and as tables on the terminal."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

from rich.console import Console
from rich.table import Table

_MEASURES = ("delta_e", "p95", "psnr", "ssim", "anchored_delta_e", "anchored_still_delta_e", "eevee_delta_e")
_TITLES = {
    "delta_e": "ΔE",
    "p95": "p95",
    "psnr": "PSNR",
    "ssim": "SSIM",
    "lighter": "L*",
    "anchored_delta_e": "anchored",
    "anchored_still_delta_e": "still",
    "eevee_delta_e": "EEVEE",
    "eevee_psnr": "PSNR",
}
_DIGITS = 3

SceneRow = Mapping[str, Any]


def summary(scenes: Mapping[str, SceneRow], failed: Mapping[str, str]) -> dict[str, Any]:
    """The content of results.json.

    Args:
        failed: Name -> why it could not be measured.

    Returns:
        `mean_delta_e`, `mean_p95` and so on over the scenes; `anchored_mean_delta_e` and others where they were
        measured; `features`: for each the number of its scenes and their means; `scenes`; `failed`.
    """
    rows = list(scenes.values())
    features = dict.fromkeys(feature for row in rows for feature in row["features"])
    means = {_mean_name(name): _mean(rows, name) for name in (*_MEASURES, "eevee_psnr")}
    return {
        **{name: value for name, value in means.items() if value is not None},
        "features": {f: _feature([row for row in rows if f in row["features"]]) for f in sorted(features)},
        "scenes": dict(scenes),
        "failed": dict(failed),
    }


def _mean_name(measure: str) -> str:
    """ "anchored_delta_e" → "anchored_mean_delta_e", "psnr" → "mean_psnr"."""
    for prefix in ("anchored_still_", "anchored_", "eevee_"):
        if measure.startswith(prefix):
            return f"{prefix}mean_{measure.removeprefix(prefix)}"
    return f"mean_{measure}"


def _mean(rows: Iterable[SceneRow], measure: str) -> float | None:
    values = [row[measure] for row in rows if measure in row and math.isfinite(row[measure])]
    return round(sum(values) / len(values), _DIGITS) if values else None


def _feature(rows: list[SceneRow]) -> dict[str, float]:
    means = {name: _mean(rows, name) for name in _MEASURES}
    return {"scenes": len(rows), **{name: value for name, value in means.items() if value is not None}}


def show(results: Mapping[str, Any]) -> None:
    """Prints the tables: scenes and features, the worst first, and the failures."""
    console = Console(width=None if Console().is_terminal else 160)
    scenes, features = results["scenes"], results["features"]
    if scenes:
        console.print(_table("scene", scenes, ("lighter", "eevee_psnr")))
        console.print(_table("feature", features, ("scenes",)))
    for name, message in results["failed"].items():
        console.print(f"FAILED {name}: {message}", style="red", markup=False)
    if scenes:
        console.print(_closing(results), markup=False)


def _table(what: str, rows: Mapping[str, SceneRow], more: tuple[str, ...]) -> Table:
    names = [m for m in (*_MEASURES, *more) if any(m in row for row in rows.values())]
    table = Table(what, *(_TITLES.get(m, m) for m in names), box=None, pad_edge=False)
    for column in table.columns[1:]:
        column.justify = "right"
    for name, row in sorted(rows.items(), key=lambda pair: -pair[1]["delta_e"]):
        table.add_row(name, *(_cell(m, row.get(m)) for m in names))
    return table


def _cell(measure: str, value: float | None) -> str:
    if value is None:
        return ""
    digits = 0 if measure == "scenes" else 3 if measure == "ssim" else 1 if "psnr" in measure else 2
    return f"{value:.{digits}f}"


def _closing(results: Mapping[str, Any]) -> str:
    parts = [f"mean CIEDE2000 {results['mean_delta_e']:.2f}", f"PSNR {results.get('mean_psnr', math.inf):.1f} dB"]
    if "anchored_mean_delta_e" in results:
        parts.append(f"anchored {results['anchored_mean_delta_e']:.2f}")
    if "eevee_mean_delta_e" in results:
        parts.append(f"EEVEE {results['eevee_mean_delta_e']:.2f}")
    return f"{len(results['scenes'])} scenes: {', '.join(parts)}."
