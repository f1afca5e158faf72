# SPDX-License-Identifier: Apache-2.0
"""Time of a vibe, phase by phase: with a warm engine as in the panel, and the start of the command."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from lab.bench import blender
from proxy_renderer.schema import atomic

_COMMANDS = {
    "vibe --help": ("--help",),
    "vibe explain": ("explain", "misty tree, glossy red"),
}


def run(out: Path, size: int, samples: int, only: str) -> dict[str, Any]:
    """Times the scenes and writes OUT/results.json. Nothing is asserted: machines differ.

    Returns:
        `cores`; `commands`, seconds to the first line; `scenes`, by name: `phases` (each with its `seconds` and its `share` of
        all cores), `anchors`, `rounds`; `failed`.
    """
    commands = {name: _first_line(arguments) for name, arguments in _COMMANDS.items()}
    scenes: dict[str, Any] = {}
    failed: dict[str, str] = {}
    out.mkdir(parents=True, exist_ok=True)
    options = ["--size", str(size), "--samples", str(samples), "--work", str(out)]
    results = {"cores": os.cpu_count(), "commands": commands, "scenes": scenes, "failed": failed}
    for event in blender.scenes(only, options, "time"):
        if event["type"] == "scene":
            scenes[event["name"]] = {key: event[key] for key in ("phases", "anchors", "rounds")}
        elif event["type"] == "failed":
            failed[event["name"]] = event["message"]
            print(f"{event['name']}: {event['message']}", flush=True)
        atomic.write_text(out / "results.json", json.dumps(results, indent=1))
    _show(commands, scenes)
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
    """A row for each phase, a column for each scene."""
    table = Table("seconds (share of all cores)", *scenes)
    phases = dict.fromkeys(phase for scene in scenes.values() for phase in scene["phases"])
    for phase in phases:
        cells = (scene["phases"].get(phase) for scene in scenes.values())
        table.add_row(phase, *(f"{c['seconds']:.2f} ({c['share']:.0%})" if c else "" for c in cells))
    for count in ("anchors", "rounds"):
        table.add_row(count, *(str(scene[count]) for scene in scenes.values()))
    console = Console()
    console.print(table)
    for name, seconds in commands.items():
        console.print(f"{name}: {seconds} s to the first line")
