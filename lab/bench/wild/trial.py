# SPDX-License-Identifier: Apache-2.0
"""One scene of a stranger's: a vibe in a process of its own, its time and memory, and what it left behind."""

from __future__ import annotations

import json
import os
from collections import deque
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lab.bench.wild import product
from proxy_renderer.blender import launch
from proxy_renderer.engine.pictures import load_picture
from proxy_renderer.schema import atomic
from proxy_renderer.schema.messages import word_states

_SHORT = ("--rounds", "1", "--steps", "8", "--samples", "64", "--figures")
"""A short vibe: what is tried is whether a scene can be read, changed, predicted and given back."""


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
        """Measurements, from row.json if the trial has been made already."""
        kept = self.folder / "row.json"
        if not kept.is_file():
            atomic.write_text(kept, json.dumps(self._made(), indent=1))
        row: dict[str, Any] = json.loads(kept.read_text(encoding="utf-8"))
        return row

    def _made(self) -> dict[str, Any]:
        before = _files(self.scene.parent)
        ended = product.vibe(self.scene, self.prompt, self.folder, [*_SHORT, "--size", str(self.size)])
        own = _files(self.folder / "current") | _files(self.folder / "temporary")
        return {
            "prompt": self.prompt,
            "megabytes": round(self.scene.stat().st_size / 1e6, 2),
            "code": ended.code,
            "error": ended.last_line,
            "seconds": round(ended.seconds, 1),
            "memory_gb": round(ended.memory / 1e9, 2),
            "left_behind": sorted(_files(self.scene.parent) - before) + sorted(own),
            **(self._report() if ended.code == 0 else {}),
            **self._reverted(),
        }

    def _report(self) -> dict[str, Any]:
        """The vibe's own report, and the distance of its prediction from Cycles."""
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
            "words": {word: state != "missed" for word, state in word_states(report["claims"]).items()},
            "claims": report["claims"],
            "similarity": report["similarity"],
            "ignored": report["understood"]["ignored"],
            "notes": report["understood"]["notes"],
            "warnings": report["warnings"],
        }

    def _reverted(self) -> dict[str, Any]:
        """True if Revert gives the artist's file back; {} where there is no .blend to compare with."""
        vibed = self.folder / "out" / "vibed.blend"
        if self.scene.suffix.lower() != ".blend" or not vibed.is_file():
            return {}
        places = [str(path.resolve()) for path in (self.scene, vibed, self.folder)]
        tail: deque[str] = deque(maxlen=20)
        process = launch.start(["-m", "lab.blender.wild", *places])
        told = [event for event in launch.events(process, tail) if event["type"] == "scene"]
        process.wait()
        if not told:
            return {"revert": {"differ": None, "examples": [line.strip() for line in tail][-3:]}}
        return {"revert": {key: value for key, value in told[0].items() if key != "type"}}


def _files(folder: Path) -> set[str]:
    """The names of everything in a folder, but not in the folders in it."""
    return set(os.listdir(folder))
