# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's side of `python -m lab materials`: a gray studio with a ball, and how the ball looks with measured values.

    python -m lab.blender.materials studio FOLDER
    python -m lab.blender.materials measured SCENE.blend MATERIALS.json FOLDER SIZE SAMPLES

The first writes FOLDER/scene.blend and FOLDER/sight.npz, what its camera sees. MATERIALS.json holds rows of
physically_based.json, each with a "file"; FOLDER gets a PNG of that name for each.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from vibe_render.core import compat
from vibe_render.export.analysis import analyze
from vibe_render.headless.scenes import open_blend, save_blend
from vibe_render.render import final_render
from vibe_render.scene.stage import area_light, cyclorama, framing_camera, plain_material, plain_world
from vibe_render.scene.subject import SubjectChoice

from lab.blender import side
from lab.blender.camera_hits import save_camera_hits
from lab.blender.scenes import making
from lab.blender.sealed import CAMERA_HITS

BALL = "Ball"
"""The object and the material that are measured."""
_GRAY, _SIDE = (0.4, 0.4, 0.4), 256


def build_studio(folder: Path) -> dict[str, Any]:
    """Builds a gray ball before a gray backdrop in white light, and saves it.

    Args:
        folder: Gets scene.blend and sight.npz.
    """
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True, load_ui=False)
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = _SIDE
    ball = making.ball(BALL, 0.9, (0.0, 0.0, 0.9), 48)
    ball.data.materials.append(plain_material(BALL, _GRAY))
    corners = np.array([[x, y, z] for x in (-0.9, 0.9) for y in (-0.9, 0.9) for z in (0.0, 1.8)])
    framing_camera(scene, corners, (0.0, 10.0), 38.0, 0.74)
    cyclorama(scene, 7.0, 6.0, 0.0, plain_material("Backdrop", _GRAY, 0.8))
    area_light(scene, "Key", (-40.0, 42.0), 5.0, 1.4, 0.7, ball.location)
    area_light(scene, "Fill", (60.0, 42.0), 5.0, 2.0, 0.3, ball.location)
    plain_world(scene, (0.5, 0.5, 0.5), 0.3)
    scene.view_layers[0].update()
    save_blend(folder / "scene.blend")
    save_camera_hits(analyze(scene, SubjectChoice((BALL,))), folder / "sight.npz", CAMERA_HITS)
    return {}


def render_measured(scene: Path, rows: Path, folder: Path, size: int, samples: int) -> dict[str, Any]:
    """Renders the studio once for each row, those that are there already left out.

    Args:
        size: Of the pictures, pixels.

    Returns:
        `rendered`, how many.
    """
    open_blend(scene)
    missing = [row for row in json.loads(rows.read_text("utf-8")) if not (folder / row["file"]).is_file()]
    for row in missing:
        give(bpy.data.materials[BALL], row)
        final_render.render_picture(bpy.context.scene, folder / row["file"], size, samples)
    return {"rendered": len(missing)}


def give(stuff: bpy.types.Material, row: Mapping[str, Any]) -> None:
    """Gives a material what was measured: color, metalness, roughness, IOR and transmission.

    Args:
        row: Of physically_based.json; a row without an IOR, a metal's, gets 1.5.
    """
    tree = compat.enable_nodes(stuff)
    shader = next(node for node in tree.nodes if node.bl_idname == "ShaderNodeBsdfPrincipled")
    color = [min(component, 1.0) for component in row["color"]]
    shader.inputs["Base Color"].default_value = (*color, 1.0)
    shader.inputs["Metallic"].default_value = row["metalness"]
    shader.inputs["Roughness"].default_value = row["roughness"]
    shader.inputs["Transmission Weight"].default_value = row["transmission"]
    shader.inputs["IOR"].default_value = row.get("ior", 1.5)


def main(command: str, *rest: str) -> int:
    """Does one of both and tells of it; returns the exit code."""
    if command == "studio":
        return side.once(lambda: build_studio(Path(rest[0])))
    scene, rows, folder, size, samples = rest
    return side.once(lambda: render_measured(Path(scene), Path(rows), Path(folder), int(size), int(samples)))


if __name__ == "__main__":
    side.end(main(*sys.argv[1:]))
