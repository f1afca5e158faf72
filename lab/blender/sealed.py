# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's side of `python -m lab sealed`: builds a drawn scene, and renders what came of it without its fog.

    python -m lab.blender.sealed build SCENE.json FOLDER SEED
    python -m lab.blender.sealed clear VIBED.blend PICTURE.png SIZE SAMPLES

SCENE.json is a `DrawnScene` of the other side. FOLDER gets scene.blend and sight.npz, what its camera sees; one event "scene"
tells the `subject`, names of objects.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import bpy
from bpy.types import Object
from vibe_render.export.analysis import analyze
from vibe_render.headless.scenes import open_blend, save_blend
from vibe_render.scene.subject import SubjectChoice

from lab.blender import clear, side
from lab.blender.camera_hits import save_camera_hits
from lab.blender.scenes.build import build
from lab.blender.scenes.recipe import CameraRecipe, FinishRecipe, LightRecipe, SceneRecipe, WorldRecipe, chance
from lab.blender.scenes.surfaces import material

CAMERA_HITS = 192
"""Rays along each side of what is saved of the geometry."""


def build_scene(drawn: Mapping[str, Any], folder: Path, seed: int) -> dict[str, Any]:
    """Builds a drawn scene and saves it.

    Args:
        folder: Gets scene.blend and sight.npz.
        seed: For what the recipe leaves open.

    Returns:
        `subject`, the names of its objects.
    """
    thing, finishes = drawn["thing"], {name: finish(row) for name, row in drawn["finishes"].items()}
    recipe = recipe_of(drawn["recipe"], finishes[thing["material"]])
    scene, parts = build(recipe, seed)
    stuffs = {name: material(name, each, chance(recipe, seed)) for name, each in finishes.items()}
    names = {part: _material_name(part, thing) for part in parts}
    for part, name in names.items():
        part.data.materials[0] = stuffs[name]
    if ground := bpy.data.materials.get("Ground"):
        _name_ground(ground, drawn["ground"].title())
    scene.view_layers[0].update()
    subject = [part.name for part, name in names.items() if name == thing["material"]]
    bpy.data.orphans_purge()
    save_blend(folder / "scene.blend")
    save_camera_hits(analyze(scene, SubjectChoice(tuple(subject))), folder / "sight.npz", CAMERA_HITS)
    return {"subject": subject}


def recipe_of(row: Mapping[str, Any], own: FinishRecipe) -> SceneRecipe:
    """A recipe from plain data.

    Args:
        row: As the other side draws it.
    """
    given = dict(row)
    given["ground"] = finish(row["ground"])
    given["walls"] = tuple(tuple(color) for color in row["walls"])
    given["lamps"] = tuple(LightRecipe(**_with_tuples(lamp)) for lamp in row["lamps"])
    given["world"] = WorldRecipe(**_with_tuples(row["world"]))
    given["view"] = CameraRecipe(**row["view"])
    return SceneRecipe(finishes=(own,), **given)


def finish(row: Mapping[str, Any]) -> FinishRecipe:
    """A finish from plain data."""
    return FinishRecipe(**_with_tuples(row))


def _with_tuples(row: Mapping[str, Any]) -> dict[str, Any]:
    return {key: tuple(value) if isinstance(value, list) else value for key, value in row.items()}


def _material_name(part: Object, thing: Mapping[str, Any]) -> str:
    others = (name for start, name in thing["parts"].items() if part.name.startswith(start))
    return next(others, thing["material"])


def _name_ground(ground: bpy.types.Material, name: str) -> None:
    """Calls the stage's material what prompts call it; a room's back wall and ceiling get one of their own."""
    ground.name = name
    wall = ground.copy()
    wall.name = "Wall"
    for other in ("Back", "Ceiling"):
        if thing := bpy.data.objects.get(other):
            thing.data.materials[0] = wall


def render_clear(path: Path, picture: Path, size: int, samples: int) -> dict[str, Any]:
    """Renders a file's scene without its fog.

    Args:
        size: Its longer side, pixels.
    """
    open_blend(path)
    clear.render_clear(bpy.context.scene, picture, size, samples)
    return {}


def main(command: str, source: Path, target: Path, numbers: list[int]) -> int:
    """Does one of both and tells of it; returns the exit code."""
    if command == "clear":
        return side.once(lambda: render_clear(source, target, *numbers))
    return side.once(lambda: build_scene(json.loads(source.read_text(encoding="utf-8")), target, *numbers))


if __name__ == "__main__":
    side.end(main(sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3]), [int(n) for n in sys.argv[4:]]))
