# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's side of `python -m lab time`: a vibe as the panel does it, phase by phase, with a warm engine."""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

import bpy
from vibe_render.core import ADDON
from vibe_render.headless.scenes import open_blend
from vibe_render.render import final_render
from vibe_render.run import result, session
from vibe_render.run.live import Live
from vibe_render.run.session import Session
from vibe_render.run.state import addon_state
from vibe_render.scene.stage import build_demo

from lab.blender import side
from lab.blender.scenes import build
from lab.blender.scenes.catalog import CATALOG
from lab.blender.scenes.recipe import LightRecipe
from lab.blender.scenes.set_catalog import SET_CATALOG

_PREDICTION = "Drawing the prediction"
_PROMPTS = (
    "golden hour, low warm sun from the left, long shadows",
    "moonlit night, cool key from behind, a small warm lamp",
    "overcast, soft light, muted colors",
    "film noir, hard light from the right, deep shadows",
    "bright airy morning, low contrast",
    "teal and orange, thin haze, slight vignette",
    "studio product shot, large softbox, white background",
)
"""For scenes in a folder, in turn."""


@dataclass(frozen=True)
class _Timed:
    """A scene to be timed.

    Attributes:
        make: Builds it into an empty file.
        prompt: What is asked of it.
    """

    make: Callable[[], Any]
    prompt: str


def _recipe(name: str, lamps: int = 0) -> Callable[[], Any]:
    """Builds a scene of the fidelity set, perhaps with other lamps in a ring."""
    recipe = next(r for r in (*CATALOG, *SET_CATALOG) if r.name == name)
    if lamps:
        ring = tuple(LightRecipe("AREA", 360.0 / lamps * i, 60.0, 1.0 / lamps, distance=2.0) for i in range(lamps))
        recipe = replace(recipe, lamps=ring)
    return lambda: build.build(recipe, 0)


SCENES = {
    "demo": _Timed(build_demo, "Glossy teal on a pale sand background, warm soft light, slight vignette"),
    "tree in fog": _Timed(_recipe("misty_tree"), "misty tree silhouette, cool blue fog, vignette"),
    "room with eight lights": _Timed(_recipe("set_lounge", 8), "cosy evening, warm dim light, dark green walls"),
    "car": _Timed(_recipe("lacquer_car"), "glossy deep blue car at golden hour, high contrast"),
}


def scenes(options: argparse.Namespace) -> dict[str, _Timed]:
    """Our scenes; with a folder of others, the .blend files in it."""
    if options.scenes == Path():
        return SCENES
    files = sorted(options.scenes.glob("*.blend"))
    return {
        file.stem: _Timed(partial(_opened, file), _PROMPTS[number % len(_PROMPTS)]) for number, file in enumerate(files)
    }


def _opened(path: Path) -> None:
    """Opens a file, in Object Mode, as an artist has it who asks for a look."""
    open_blend(path)
    if bpy.context.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")


class _Phases:
    """Wall seconds and processor seconds by phase, of this process and the engine."""

    def __init__(self) -> None:
        self.wall: dict[str, float] = {}
        self.processor: dict[str, float] = {}
        self._last = time.monotonic(), _processor_seconds()

    def lap(self, phase: str) -> None:
        """Counts the time since the last lap to a phase."""
        now = time.monotonic(), _processor_seconds()
        for book, new, old in zip((self.wall, self.processor), now, self._last, strict=True):
            book[phase] = book.get(phase, 0.0) + new - old
        self._last = now

    def rows(self) -> dict[str, dict[str, float]]:
        """Phase to its `seconds` and its `share` of all cores."""
        cores = os.cpu_count() or 1
        return {
            phase: {"seconds": round(wall, 2), "share": round(self.processor[phase] / max(wall * cores, 1e-9), 2)}
            for phase, wall in self.wall.items()
        }


def _processor_seconds() -> float:
    """Resources that this process and the engine have used; the engine's only on Linux."""
    own = os.times()
    process = addon_state.engine(bpy.context)._process
    try:
        fields = Path(f"/proc/{process.pid if process else 0}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return own.user + own.system
    return own.user + own.system + (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def _peak_memory(forget: bool = False) -> int:
    """The engine's peak memory in MiB since it was forgotten; 0 where the system does not tell."""
    process = addon_state.engine(bpy.context)._process
    folder = Path(f"/proc/{process.pid if process else 0}")
    try:
        if forget:
            (folder / "clear_refs").write_text("5")
        lines = (folder / "status").read_text().splitlines()
    except OSError:
        return 0
    return next((int(line.split()[1]) // 1024 for line in lines if line.startswith("VmHWM")), 0)


def measure(timed: _Timed, options: argparse.Namespace) -> dict[str, Any]:
    """Builds a scene, and times a vibe and looks of what is typed.

    Args:
        options: `size` and `samples` of the finished picture.

    Returns:
        `phases`, `anchors`, `rounds`, and `memory`, the most that the engine has used, MiB.
    """
    timed.make()
    scene = bpy.context.scene
    scene.vibe.prompt = timed.prompt
    _warm_up()
    _peak_memory(forget=True)
    phases = _Phases()
    _live(phases, timed.prompt)
    vibe = addon_state.begin(bpy.context)
    phase = "read the scene"
    while vibe.advance():
        phases.lap(phase)
        phase = _phase(vibe)
        time.sleep(0.005)
    addon_state.end()
    phases.lap("write the values")
    final_render.render_picture(scene, options.work / "final.png", options.size, options.samples, 0)
    phases.lap("finished picture")
    report = vibe.report
    result.revert(scene)
    return {
        "phases": phases.rows(),
        "anchors": len(report.get("anchored", {}).get("pictures", [])),
        "rounds": len(report["rounds"]),
        "memory": _peak_memory(),
    }


def _warm_up() -> None:
    """The first look of an engine loads what later ones find: it is not counted."""
    addon_state.warm_up(bpy.context)
    engine = addon_state.engine(bpy.context)
    while not engine.alive:
        time.sleep(0.01)
    live = Live(bpy.context, engine)
    _typed(live, "red")
    live.close()


def _typed(live: Live, words: str) -> None:
    live.typed(words)
    while live.busy:
        live.advance()
        time.sleep(0.005)


def _live(phases: _Phases, prompt: str) -> None:
    """The first words and the next ones, as Live shows them."""
    live = Live(bpy.context, addon_state.engine(bpy.context))
    for phase, words in (("live: first words", prompt.split(",")[0]), ("live: next words", prompt)):
        _typed(live, words)
        phases.lap(phase)
    live.close()


def _phase(vibe: Session) -> str:
    """The phase of a vibe."""
    if vibe.stage == session.ANCHORING:
        return "anchors"
    if vibe.stage == _PREDICTION:
        return "prediction"
    if vibe.look is None:
        return "read the scene" if vibe.stage == session.READING else "to the first values"
    return "search" if vibe.words else "to the first picture"


if __name__ == "__main__":
    import_module(ADDON).register()
    side.main(scenes, measure)
