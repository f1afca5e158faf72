# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's side of `vibe bench fidelity`: builds scenes, exports them as a vibe does, renders references.

    python -m vibe_render.bench.fidelity --work DIR --cache DIR --size 256 --samples 512 [--only GLOB] ...

It prints lines `VIBE {json}`: "names", then "begin" before each scene, and "scene" or "failed" after it.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import random
import sys
import time
import traceback
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import bpy

from .. import anchoring, rendering, scene_io
from ..contract import schema
from ..export import Job
from ..subject import Choice
from .build import build
from .catalog import CATALOG
from .fingerprint import fingerprint
from .move import move
from .recipe import Recipe, features
from .shapes import SHAPES

VERSION = ANCHOR_VERSION = 1
"""Raised when the way references, or anchors, are rendered changes."""
ANCHOR_SIZE, ANCHOR_SAMPLES = 192, 32


def main() -> int:
    """Makes the scenes one after another; what goes wrong with one is told and the next one comes."""
    a = arguments()
    chosen = {recipe.name: recipe for recipe in CATALOG if fnmatchcase(recipe.name, a.only)}
    if not chosen:
        names = ", ".join(recipe.name for recipe in CATALOG)
        say("error", message=f"No scene has a name like {a.only!r}.", remedy=f"There are: {names}.")
        return 2
    say("names", names=list(chosen))
    for name in (n for n in chosen if n not in a.skip.split(",")):
        say("begin", name=name)
        try:
            say("scene", name=name, **make(chosen[name], a))
        except Exception as error:
            traceback.print_exc()
            say("failed", name=name, message=f"{type(error).__name__}: {error}")
    return 0


def make(recipe: Recipe, a: argparse.Namespace) -> dict[str, Any]:
    """One scene: its job folder, its reference, and what is known about it."""
    scene, subject = build(recipe, a.seed)
    folder = a.work / recipe.name
    job = scene_io.open_job(scene, folder / "job", Choice(tuple(o.name for o in subject)))
    start = time.monotonic()
    mark = fingerprint(scene)
    reference, cached = _reference(scene, mark, a)
    found: dict[str, Any] = {
        "features": features(recipe, SHAPES[recipe.shape][1]),
        "job": str(folder / "job"),
        "reference": str(reference),
        "cached": cached,
        "reference_seconds": round(time.monotonic() - start, 2),
        "warnings": job.warnings,
        "anchors": _anchors(job, mark, recipe, a),
    }
    if a.blend:
        found["blend"] = str(_save(folder / "scene.blend"))
    return found


def _reference(scene: bpy.types.Scene, mark: str, a: argparse.Namespace) -> tuple[Path, bool]:
    """Cycles' picture of the scene, from the cache if it is there."""
    path = _cached(a, ".png", mark, a.size, a.samples, bpy.app.version_string, VERSION)
    if path.is_file():
        return path, True
    rendering.render(scene, path, a.size, a.samples, exact=True)
    return path, False


def _anchors(job: Job, mark: str, recipe: Recipe, a: argparse.Namespace) -> dict[str, dict[str, Any]]:
    """What a round of a vibe would give the engine: small pictures of the scene's own values, and of a step away."""
    moved = move(job.instances, random.Random(f"{a.seed}/{recipe.name}/move"))
    return {name: _anchor(job, mark, values, a) for name, values in (("still", {}), ("moved", moved))}


def _anchor(job: Job, mark: str, values: dict[str, schema.Values], a: argparse.Namespace) -> dict[str, Any]:
    """One small picture and what it was rendered at, from the cache if it is there."""
    settings = ANCHOR_SIZE, ANCHOR_SAMPLES, bpy.app.version_string, ANCHOR_VERSION
    path = _cached(a, ".exr", mark, values, *settings)
    notes = path.with_suffix(".json")
    if path.is_file() and notes.is_file():
        groups = json.loads(notes.read_text(encoding="utf-8"))
    else:
        found = job.survey
        groups = anchoring.render_anchor(
            found.scene, path, values, found.objects, found.pivot, ANCHOR_SIZE, ANCHOR_SAMPLES
        )
        part = path.with_suffix(".json.part")
        part.write_text(json.dumps(groups), encoding="utf-8")
        os.replace(part, notes)
    return {"values": values, "picture": str(path), "groups": groups}


def _cached(a: argparse.Namespace, suffix: str, *settings: Any) -> Path:
    """Where a picture that depends on these settings is kept."""
    a.cache.mkdir(parents=True, exist_ok=True)
    text = " ".join(map(str, settings))
    return a.cache / f"{hashlib.sha256(text.encode()).hexdigest()[:32]}{suffix}"


def _save(path: Path) -> Path:
    """The open file as a .blend that needs no other file."""
    bpy.ops.file.pack_all()
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True, check_existing=False)
    return path


def say(kind: str, **content: Any) -> None:
    """Tells the engine's side of something."""
    print(f"VIBE {json.dumps({'type': kind, **content})}", flush=True)


def arguments() -> argparse.Namespace:
    """The options that all measurements share."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--only", default="*", help="pattern of names")
    parser.add_argument("--skip", default="", help="names that have been made already")
    parser.add_argument("--work", type=Path, default=Path())
    parser.add_argument("--cache", type=Path, default=Path())
    parser.add_argument("--blend", action="store_true")
    for name in ("size", "samples", "seed"):
        parser.add_argument(f"--{name}", type=int, default=0)
    return parser.parse_args()


if __name__ == "__main__":
    status = main()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)  # Blender 4.5's own exit handlers may wait for ever
