# SPDX-License-Identifier: Apache-2.0
"""One scene of a stranger's: a vibe in a process of its own, its time and memory, and what it left behind."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections import deque
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...blender import launch, process_tree
from ...engine.report import load_picture
from ...schema import atomic
from ...schema.verdicts import missing_by_word

_SHORT = ("--rounds", "1", "--steps", "8", "--samples", "64")
"""A short vibe: what is tried is whether a scene can be read, changed, predicted and given back."""
_LONGEST = 900
"""Seconds after which a vibe counts as hanging."""
_TICK = 0.2


@dataclass(frozen=True)
class Trial:
    """A vibe to be tried.

    Attributes:
        scene: A .blend or a mesh.
        prompt: The words.
        folder: Gets "row.json", "log.txt", and in "out" what `vibe run` writes.
        size: Longer side of the pictures, pixels.
    """

    scene: Path
    prompt: str
    folder: Path
    size: int

    def row(self) -> dict[str, Any]:
        """What was measured, from row.json if the trial has been made already."""
        kept = self.folder / "row.json"
        if not kept.is_file():
            atomic.write_text(kept, json.dumps(self._made(), indent=1))
        row: dict[str, Any] = json.loads(kept.read_text(encoding="utf-8"))
        return row

    def _made(self) -> dict[str, Any]:
        current, temporary = self.folder / "current", self.folder / "temporary"
        for each in (current, temporary):
            each.mkdir(parents=True, exist_ok=True)
        before = _files(self.scene.parent)
        code, seconds, memory = self._vibe(current, temporary)
        left = sorted(_files(self.scene.parent) - before) + sorted(_files(current) | _files(temporary))
        return {
            "prompt": self.prompt,
            "megabytes": round(self.scene.stat().st_size / 1e6, 2),
            "code": code,
            "error": "" if code == 0 else self._last_line(),
            "seconds": round(seconds, 1),
            "memory_gb": round(memory / 1e9, 2),
            "left_behind": left,
            **(self._report() if code == 0 else {}),
            **self._reverted(),
        }

    def _vibe(self, current: Path, temporary: Path) -> tuple[int, float, int]:
        """Exit code, seconds, and the most memory that all its processes held together, bytes."""
        options = [
            "--prompt",
            self.prompt,
            "--out",
            str((self.folder / "out").resolve()),
            *_SHORT,
        ]
        command = [sys.executable, "-m", "proxy_renderer.cli", "run", str(self.scene.resolve()), *options]
        environment = {
            **launch.environment(),
            "TMPDIR": str(temporary.resolve()),
            "TORCHINDUCTOR_CACHE_DIR": str(self.folder / "inductor"),
        }
        start, most = time.monotonic(), 0
        with (self.folder / "log.txt").open("w", encoding="utf-8") as log:
            process = subprocess.Popen(
                [*command, "--size", str(self.size)],
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                cwd=current,
                env=environment,
            )
            while process.poll() is None:
                most = max(most, process_tree.memory(process.pid))
                if time.monotonic() - start > _LONGEST:
                    process_tree.kill(process.pid)
                time.sleep(_TICK)
        return process.returncode, time.monotonic() - start, most

    def _last_line(self) -> str:
        lines = (self.folder / "log.txt").read_text(encoding="utf-8", errors="replace").strip().splitlines()
        return lines[-1].strip() if lines else "nothing was said"

    def _report(self) -> dict[str, Any]:
        """What the vibe said of itself, and how far its prediction was from Cycles."""
        out = self.folder / "out"
        report = json.loads((out / "report.json").read_text(encoding="utf-8"))
        shown = report["prediction"]["shown"]
        foretold = report["prediction"].get("before_last_anchor", {})
        return {
            "delta_e": shown["mean"],
            "p95": shown["p95"],
            "delta_e_subject": shown.get("subject"),
            "delta_e_before_last_anchor": foretold.get("mean"),
            "black": bool(load_picture(out / "after.png").max() < 0.02),
            "subject": report["subject"],
            "read_seconds": report["timings"]["open and export"],
            "words": {word: not missing for word, missing in missing_by_word(report["claims"]).items()},
            "claims": report["claims"],
            "similarity": report["similarity"],
            "ignored": report["understood"]["ignored"],
            "notes": report["understood"]["notes"],
            "warnings": report["warnings"],
        }

    def _reverted(self) -> dict[str, Any]:
        """Whether Revert gives the artist's file back; {} where there is no .blend to compare with."""
        vibed = self.folder / "out" / "vibed.blend"
        if self.scene.suffix.lower() != ".blend" or not vibed.is_file():
            return {}
        places = [str(path.resolve()) for path in (self.scene, vibed, self.folder)]
        tail: deque[str] = deque(maxlen=20)
        process = launch.start(["-m", "vibe_render.bench.wild", *places])
        told = [event for event in launch.events(process, tail) if event["type"] == "scene"]
        process.wait()
        if not told:
            return {"revert": {"differ": None, "examples": [line.strip() for line in tail][-3:]}}
        return {"revert": {key: value for key, value in told[0].items() if key != "type"}}


def _files(folder: Path) -> set[str]:
    """The names of everything in a folder, but not in the folders in it."""
    return set(os.listdir(folder))
