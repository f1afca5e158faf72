# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's side of `python -m lab paper`: vibes one after another, by one Blender and one engine.

    python -m lab.blender.paper --work runs.json [--only GLOB] [--skip A,B]

The file holds a list of runs: `name`, `folder`, `set` (a name in `sets.SETS`) or `mesh` (a file), `arguments` as for
`batch.py`, `environment`, variables of the engine, and `clear`, whether the result is wanted without its fog too.
"""

from __future__ import annotations

import argparse
import json
import os
import time
from pathlib import Path
from typing import Any

import bpy
from vibe_render.engine.process import Engine
from vibe_render.headless import vibe
from vibe_render.headless.arguments import Reporter, parse
from vibe_render.render import final_render
from vibe_render.scene import snapshot

from lab.blender import clear, side
from lab.blender.camera_hits import save_camera_hits
from lab.blender.scenes.build import build
from lab.blender.scenes.sets import SETS

CAMERA_HITS = 192
"""Rays along each side of what is saved of the geometry."""


class _Quiet(Reporter):
    """Prints nothing about single runs."""

    def _print(self, event: dict[str, Any], line: str) -> None:
        pass


class PaperRuns:
    """Runs with one warm engine, which is replaced after a run that failed, and for other variables."""

    def __init__(self) -> None:
        self._reporter = _Quiet(events=False)
        self._engine: Engine | None = None
        self._environment: dict[str, str] = {}

    def vibe(self, run: dict[str, Any]) -> None:
        """Carries out one run: all files of `vibe run`, and the camera hits before and after."""
        folder = Path(run["folder"])
        given = ["run", run.get("mesh", ""), f"--out={folder}", *run["arguments"]]
        if "set" in run:
            given += [f"--subject={name}" for name in build_set(run["set"])]
        if run["environment"] != self._environment:
            self.close()
            for name in self._environment:
                del os.environ[name]
            self._environment = run["environment"]
            os.environ.update(self._environment)
        try:
            analysis = vibe.HeadlessVibe(parse(given), self._reporter, self._warm_engine()).run()
        except BaseException:
            self.close()
            raise
        save_camera_hits(analysis, folder / "after.npz", CAMERA_HITS)
        size, samples = (_number(run, name) for name in ("size", "samples"))
        if run["clear"]:
            clear.render_clear(analysis.scene, folder / "clear.png", size, samples)
        snapshot.revert(analysis.scene)
        save_camera_hits(analysis, folder / "before.npz", CAMERA_HITS)
        final_render.render_mask(analysis.scene, folder / "mask_before.png", size, analysis.objects)

    def close(self) -> None:
        """Ends the engine."""
        if self._engine:
            self._engine.stop(patience=0.5)
        self._engine = None

    def _warm_engine(self) -> Engine:
        self._engine = self._engine or Engine()
        self._engine.start()
        return self._engine


def _number(run: dict[str, Any], option: str) -> int:
    """The number that an option of a run has been given."""
    mark = f"--{option}="
    return next(int(text.removeprefix(mark)) for text in run["arguments"] if text.startswith(mark))


def build_set(name: str) -> list[str]:
    """Builds a set into an empty file; returns the names of the subject's objects."""
    chosen = SETS[name]
    scene, subject = build(chosen.recipe, seed=0)
    for number, title in enumerate(chosen.materials):
        bpy.data.materials[f"Stuff {number}"].name = title
    if "Ground" in bpy.data.materials:
        bpy.data.materials["Ground"].name = chosen.ground
    scene.view_layers[0].update()
    return [thing.name for thing in subject]


def known_runs(a: argparse.Namespace) -> dict[str, dict[str, Any]]:
    """The runs of the file, by name."""
    return {run["name"]: run for run in json.loads(a.work.read_text(encoding="utf-8"))}


if __name__ == "__main__":
    workshop = PaperRuns()

    def make(run: dict[str, Any], _: argparse.Namespace) -> dict[str, Any]:
        """Carries one run out."""
        start = time.monotonic()
        workshop.vibe(run)
        return {"seconds": round(time.monotonic() - start, 1)}

    side.main(known_runs, make)
