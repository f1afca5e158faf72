# SPDX-License-Identifier: Apache-2.0
"""`vibe run`, as an artist starts it: in a process of its own, with its time and the most memory that it held."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lab.methods import OURS, Variation
from proxy_renderer.blender import launch
from proxy_renderer.schema import atomic

_LONGEST = 900
"""Seconds after which a vibe counts as hanging."""
_TICK = 0.2


@dataclass(frozen=True)
class Ended:
    """End of a vibe.

    Attributes:
        code: Of its exit.
        seconds: From start to end.
        memory: The most that all its processes held together, bytes.
        last_line: What it said last, if its code is not 0; "" otherwise.
    """

    code: int
    seconds: float
    memory: int
    last_line: str


def vibe(scene: Path, prompt: str, folder: Path, options: Sequence[str], variation: Variation = OURS) -> Ended:
    """Vibes a scene; its files lie in FOLDER/out then, and what it said in FOLDER/log.txt.

    Args:
        scene: A .blend or a mesh.
        folder: Of the trial; "current" and "temporary" in it are the vibe's own, and both are made.
        options: More options of `vibe run`.
    """
    current, temporary, log = folder / "current", folder / "temporary", folder / "log.txt"
    for each in (current, temporary):
        each.mkdir(parents=True, exist_ok=True)
    command = [sys.executable, "-m", "proxy_renderer.cli", "run", str(scene.resolve())]
    command += ["--prompt", prompt, "--out", str((folder / "out").resolve()), *options, *variation.options]
    environment = {
        **launch.environment(),
        **variation.environment,
        "TMPDIR": str(temporary.resolve()),
        "TORCHINDUCTOR_CACHE_DIR": str(folder / "inductor"),
    }
    start, most = time.monotonic(), 0
    with log.open("w", encoding="utf-8") as file:
        process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=file, stderr=subprocess.STDOUT, cwd=current, env=environment
        )
        while process.poll() is None:
            most = max(most, launch.memory(process.pid))
            if time.monotonic() - start > _LONGEST:
                launch.kill(process.pid)
            time.sleep(_TICK)
    seconds = time.monotonic() - start
    return Ended(process.returncode, seconds, most, _last_line(log) if process.returncode else "")


def vibe_once(
    scene: Path, prompt: str, folder: Path, options: Sequence[str], variation: Variation = OURS
) -> dict[str, Any]:
    """Vibes a scene, unless that has been done: FOLDER/ended.json says so. One that was killed is tried again.

    Args:
        scene: As for `vibe`, like all arguments.
        folder: Of the trial; only the results stay in it.
        options: More options of `vibe run`.

    Returns:
        `code`; `error`, what was said last, "" for code 0; `seconds`.
    """
    kept = folder / "ended.json"
    if kept.is_file():
        content: dict[str, Any] = json.loads(kept.read_text(encoding="utf-8"))
        return content
    ended = vibe(scene, prompt, folder, options, variation)
    for each in ("inductor", "current", "temporary"):
        shutil.rmtree(folder / each, ignore_errors=True)
    row = {"code": ended.code, "error": ended.last_line, "seconds": round(ended.seconds, 1)}
    if ended.code >= 0:
        atomic.write_text(kept, json.dumps(row, indent=1))
    return row


def _last_line(log: Path) -> str:
    lines = log.read_text(encoding="utf-8", errors="replace").strip().splitlines()
    return lines[-1].strip() if lines else "nothing was said"
