# SPDX-License-Identifier: Apache-2.0
"""Time of a vibe, phase by phase: with a warm engine as in the panel, and the start of the command."""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from lab.bench import blender
from proxy_renderer.schema import atomic

_FINAL = "finished picture"
_SEARCH = ("search", "anchors", "to the first values", "to the first picture")  # phases
_COMMANDS = {"vibe --help": ("--help",), "vibe explain": ("explain", "misty tree, glossy red")}


def run(out: Path, size: int, samples: int, only: str, scenes: str) -> dict[str, Any]:
    """Times our scenes, or those in a folder, and writes OUT/results.json. Nothing is asserted: machines differ.

    Returns:
        `cores`; `commands`, seconds to the first line; `scenes`, by name: `phases` (each with its `seconds` and its `share` of
        all cores), `anchors`, `rounds`, `memory`; `failed`.
    """
    commands = {name: _first_line(arguments) for name, arguments in _COMMANDS.items()}
    timed: dict[str, Any] = {}
    failed: dict[str, str] = {}
    out.mkdir(parents=True, exist_ok=True)
    options = ["--size", str(size), "--samples", str(samples), "--work", str(out)]
    if scenes:
        options += ["--scenes", str(Path(scenes).resolve())]
    results = {"cores": os.cpu_count(), "commands": commands, "scenes": timed, "failed": failed}
    for event in blender.scenes(only, options, "time"):
        if event["type"] == "scene":
            timed[event["name"]] = {key: event[key] for key in ("phases", "anchors", "rounds", "memory")}
        elif event["type"] == "failed":
            failed[event["name"]] = event["message"]
            print(f"{event['name']}: {event['message']}", flush=True)
        atomic.write_text(out / "results.json", json.dumps(results, indent=1))
    _show(commands, timed)
    return results


def _first_line(arguments: Sequence[str]) -> float:
    """Seconds until a command prints its first line; the second time, when its files are in memory."""
    for _ in range(2):
        began = time.monotonic()
        command = [sys.executable, "-m", "proxy_renderer.cli", *arguments]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as process:
            assert process.stdout is not None
            process.stdout.readline()
            seconds = time.monotonic() - began
            process.stdout.read()
    return round(seconds, 2)


def _show(commands: Mapping[str, float], scenes: Mapping[str, Mapping[str, Any]]) -> None:
    """A line for each scene: the whole vibe and its search in final renders, and its phases with their share of all cores."""
    costs: list[tuple[float, float]] = []
    for name, scene in scenes.items():
        seconds = {phase: row["seconds"] for phase, row in scene["phases"].items()}
        costs.append(_in_renders(seconds))
        vibe, search = costs[-1]
        rows = scene["phases"].items()
        phases = ", ".join(f"{phase} {row['seconds']:.1f} s ({row['share']:.0%})" for phase, row in rows)
        counts = ", ".join(f"{scene[count]} {count}" for count in ("rounds", "anchors"))
        print(f"{name}: {vibe:.2f} renders, search {search:.2f}; {phases}; {counts}, {scene['memory']} MiB")
    if costs:
        vibes, searches = zip(*costs, strict=True)
        print(f"median: {statistics.median(vibes):.2f} renders, search {statistics.median(searches):.2f}")
        print(f"most: {max(vibes):.2f} renders, search {max(searches):.2f}")
    for name, first in commands.items():
        print(f"{name}: {first} s to the first line")


def _in_renders(seconds: Mapping[str, float]) -> tuple[float, float]:
    """What a vibe costs with its final render, and its search with anchors, in final renders."""
    final = max(seconds[_FINAL], 1e-9)
    vibe = sum(each for phase, each in seconds.items() if not phase.startswith("live"))
    return vibe / final, sum(seconds.get(phase, 0.0) for phase in _SEARCH) / final
