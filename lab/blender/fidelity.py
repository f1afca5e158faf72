# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's side of `python -m lab fidelity`: builds scenes, exports them as a vibe does, renders references.

python -m lab.blender.fidelity --work DIR --cache DIR --size 256 --samples 512 [--only GLOB] ...
"""

from __future__ import annotations

import argparse
import json
import random
import time
from pathlib import Path
from typing import Any

import bpy
from vibe_render.core.schema_import import atomic, schema
from vibe_render.export import reading
from vibe_render.export.job_folder import SceneJob
from vibe_render.render import anchors, final_render
from vibe_render.scene.subject import SubjectChoice

from lab.blender import side
from lab.blender.move import move
from lab.blender.scenes.build import build
from lab.blender.scenes.catalog import CATALOG
from lab.blender.scenes.fingerprint import fingerprint
from lab.blender.scenes.places import PLACES
from lab.blender.scenes.recipe import SceneRecipe, features
from lab.blender.scenes.set_catalog import SET_CATALOG
from lab.blender.scenes.shapes import SHAPES

VERSION = ANCHOR_VERSION = 1
"""Raised when the way references, or anchors, are rendered changes."""
SUBJECTS = {name: (make, (*mesh, "single subject")) for name, (make, mesh) in SHAPES.items()}
"""Subjects of the older scenes: their means are told apart from those of sets."""
ANCHOR_SIZE, ANCHOR_SAMPLES = 192, 16


def make(recipe: SceneRecipe, a: argparse.Namespace) -> dict[str, Any]:
    """Makes one scene: its job folder, its reference and its anchors.

    Args:
        a: The options of `side.main`.

    Returns:
        A row of the measurement: features, paths, warnings, and whether the reference came from the cache.
    """
    scene, subject = build(recipe, a.seed)
    folder = a.work / recipe.name
    job = reading.export_scene(scene, folder / "job", SubjectChoice(tuple(o.name for o in subject)))
    start = time.monotonic()
    mark = fingerprint(scene)
    reference, cached = _reference(scene, mark, a)
    measurement: dict[str, Any] = {
        "features": features(recipe, (SUBJECTS | PLACES)[recipe.shape][1]),
        "job": str(folder / "job"),
        "reference": str(reference),
        "cached": cached,
        "reference_seconds": round(time.monotonic() - start, 2),
        "warnings": job.warnings,
        "anchors": _anchors(job, mark, recipe, a),
    }
    if a.blend:
        measurement["blend"] = str(_save(folder / "scene.blend"))
    return measurement


def _reference(scene: bpy.types.Scene, mark: str, a: argparse.Namespace) -> tuple[Path, bool]:
    """Cycles' picture of the scene, from the cache if it is there."""
    path = side.cached(a, ".png", mark, a.size, a.samples, bpy.app.version_string, VERSION)
    if path.is_file():
        return path, True
    final_render.render_picture(scene, path, a.size, a.samples, exact=True)
    return path, False


def _anchors(job: SceneJob, mark: str, recipe: SceneRecipe, a: argparse.Namespace) -> dict[str, dict[str, Any]]:
    """The anchors of a round: of the scene's own values, and of values a small step away."""
    moved = move(job.instances, random.Random(f"{a.seed}/{recipe.name}/move"))
    return {name: _anchor(job, mark, values, a) for name, values in (("still", {}), ("moved", moved))}


def _anchor(job: SceneJob, mark: str, values: dict[str, schema.Values], a: argparse.Namespace) -> dict[str, Any]:
    """One anchor with its values, from the cache if it is there."""
    settings = ANCHOR_SIZE, ANCHOR_SAMPLES, bpy.app.version_string, ANCHOR_VERSION
    path = side.cached(a, ".exr", mark, values, *settings)
    notes = path.with_suffix(".json")
    if path.is_file() and notes.is_file():
        groups = json.loads(notes.read_text(encoding="utf-8"))
    else:
        analysis = job.analysis
        groups = anchors.render_anchor(
            analysis.scene, path, values, analysis.objects, analysis.pivot, ANCHOR_SIZE, ANCHOR_SAMPLES
        )
        atomic.write_text(notes, json.dumps(groups))
    return {"values": values, "picture": str(path), "groups": groups}


def _save(path: Path) -> Path:
    """The open file as a .blend that needs no other file."""
    bpy.ops.file.pack_all()
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True, check_existing=False)
    return path


if __name__ == "__main__":
    side.main({recipe.name: recipe for recipe in (*CATALOG, *SET_CATALOG)}, make)
