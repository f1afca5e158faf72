# SPDX-License-Identifier: Apache-2.0
"""The measurement: one size grows at a time, the others stay as in the base scene."""

from __future__ import annotations

import fnmatch
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from lab.bench import blender
from lab.bench.scale.fit import exponent
from lab.bench.scale.plot import plot
from proxy_renderer.blender.launch import environment
from proxy_renderer.schema import VibeError, atomic

BASE = {"triangles": 10_000, "lights": 2, "materials": 4, "pixels": 256, "shots": 1}
"""The scene of which one size grows; `pixels` are the side of the picture."""

AXES = {
    "triangles": (1_000, 10_000, 100_000, 1_000_000, 10_000_000),
    "lights": (1, 4, 16, 64),
    "materials": (2, 4, 16, 64, 256),
    "pixels": (256, 512, 1024, 2048),
    "shots": (1, 4, 16),
}
PHASES = ("export", "load", "first draw", "step", "search")


def run(out: Path, only: str, limit: int) -> dict[str, Any]:
    """Measures the points that OUT/results.json lacks, fits exponents, and draws OUT/scale.svg.

    Args:
        only: A pattern of the axes' names.
        limit: Wall seconds: an axis ends after a point that took longer.

    Returns:
        `base`; `points`, axis to size to phase to costs; `exponents`, axis to phase to the `Exponent` of its processor
        time; `stopped`, axis to the sizes that were left out; `failed`.

    Raises:
        VibeError: No axis has such a name.
    """
    axes = {name: sizes for name, sizes in AXES.items() if fnmatch.fnmatch(name, only)}
    if not axes:
        raise VibeError(f"No size has a name like {only!r}.", f"Choose from: {', '.join(AXES)}.")
    path = out / "results.json"
    kept = json.loads(path.read_text("utf-8")) if path.is_file() else {}
    results: dict[str, Any] = {"base": BASE, "cores": os.cpu_count()}
    results |= {key: kept.get(key, {}) for key in ("points", "exponents", "stopped")} | {"failed": {}}
    for axis, sizes in axes.items():
        _grow(axis, sizes, limit, path, results)
    results["exponents"] = {axis: _exponents(axis, rows) for axis, rows in results["points"].items()}
    atomic.write_text(path, json.dumps(results, indent=1))
    atomic.write_text(out / "scale.svg", plot(_curves(results["points"])))
    _show(results)
    return results


def _grow(axis: str, sizes: tuple[int, ...], limit: int, path: Path, results: dict[str, Any]) -> None:
    """Measures an axis from small to large, until a point takes too long."""
    points = results["points"].setdefault(axis, {})
    results["stopped"].pop(axis, None)
    for i, size in enumerate(sizes):
        if str(size) not in points:
            try:
                points[str(size)] = _point({**BASE, axis: size})
            except VibeError as error:
                results["failed"][f"{axis} {size}"] = str(error)
                print(f"{axis} {size}: {error}", flush=True)
                return
        atomic.write_text(path, json.dumps(results, indent=1))
        costs = points[str(size)]
        print(f"{axis} {size}:", *(f"{p} {c['processor']:.2f} s" for p, c in costs.items()), sep="  ", flush=True)
        if sum(phase["wall"] for phase in costs.values()) > limit and sizes[i + 1 :]:
            results["stopped"][axis] = list(sizes[i + 1 :])
            return


def _point(sizes: Mapping[str, int]) -> dict[str, dict[str, float]]:
    """The costs of one scene, by phase."""
    with tempfile.TemporaryDirectory(prefix="vibe-scale-") as folder:
        shape = (sizes[name] for name in ("triangles", "lights", "materials", "shots"))
        told = blender.command("scale", folder, *shape)
        export = {key: told[key] for key in ("processor", "wall", "memory")}
        jobs = [str(Path(folder) / str(number)) for number in range(sizes["shots"])]
        command = [sys.executable, "-m", f"{__package__}.point", str(sizes["pixels"]), *jobs]
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", env=environment())
    if done.returncode:
        last = next((line for line in reversed(done.stderr.splitlines()) if line.strip()), "nothing")
        reason = "memory ran out" if done.returncode == -9 else last.strip()[:160]
        raise VibeError(f"The engine ended with code {done.returncode}: {reason}.", "Measure smaller sizes.")
    return {"export": export, **json.loads(done.stdout.splitlines()[-1])}


def _cost(axis: str, size: str) -> int:
    """The number that costs are held against: of pixels all, not the side."""
    return int(size) ** 2 if axis == "pixels" else int(size)


def _curves(points: Mapping[str, Any]) -> dict[str, dict[str, list[tuple[float, float]]]]:
    """Axis to phase to (size, processor seconds)."""
    return {
        axis: {
            phase: [(_cost(axis, size), costs[phase]["processor"]) for size, costs in rows.items()] for phase in PHASES
        }
        for axis, rows in points.items()
    }


def _exponents(axis: str, rows: Mapping[str, Any]) -> dict[str, Any]:
    """Phase to the exponents of its processor time and of the memory by then."""
    if len(rows) < 2:
        return {}
    sizes = [_cost(axis, size) for size in rows]
    of = {kind: [[max(c[p][kind], 1e-3) for c in rows.values()] for p in PHASES] for kind in ("processor", "memory")}
    return {phase: {kind: asdict(exponent(sizes, of[kind][i])) for kind in of} for i, phase in enumerate(PHASES)}


def _show(results: Mapping[str, Any]) -> None:
    """A row for each size, with the exponents of processor time."""
    table = Table("exponent of time (95 %; last)", *PHASES)
    for axis, phases in results["exponents"].items():
        cells = [phases[p]["processor"] for p in PHASES] if phases else []
        table.add_row(axis, *(f"{c['slope']:.2f} ± {c['margin']:.2f}; {c['last']:.2f}" for c in cells))
    console = Console()
    console.print(table)
    for axis, sizes in results["stopped"].items():
        console.print(f"{axis}: stopped before {sizes[0]}")
