# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's side of training pictures: small Cycles renders of given meshes under given looks.

    python -m lab.blender.pictures FOLDER

FOLDER/looks.json holds rows with a "name", a "mesh" (a .npz of triangles (F, 3, 3) and corner normals) and the numbers
of `_build`; FOLDER/NAME.png and FOLDER/NAME.mask.png come out. It prints lines `VIBE {json}`: "scene" or "failed".
"""

from __future__ import annotations

import json
import sys
import traceback
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from vibe_render.render import final_render
from vibe_render.scene import bindings
from vibe_render.scene.stage import (
    area_light,
    cyclorama,
    floor,
    framing_camera,
    mesh_object,
    plain_material,
    plain_world,
)

from lab.blender.side import say


def main(folder: Path) -> None:
    """Renders every row; a failure of one is reported and the next one follows."""
    for row in json.loads((folder / "looks.json").read_text(encoding="utf-8")):
        try:
            scene, subject = _build(row, folder)
            final_render.render_picture(scene, folder / f"{row['name']}.png", row["size"], row["samples"])
            final_render.render_mask(scene, folder / f"{row['name']}.mask.png", row["size"], [subject])
            say("scene", name=row["name"])
        except Exception as error:
            traceback.print_exc()
            say("failed", name=row["name"], message=f"{type(error).__name__}: {error}")


def _build(row: dict[str, Any], folder: Path) -> tuple[bpy.types.Scene, bpy.types.Object]:
    """A subject on a stage before a camera at azimuth 0, under one softbox and the world."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True, load_ui=False)
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = row["size"]
    stuff = plain_material("Subject", row["color"], row["roughness"], row["metallic"])
    shader = next(n for n in stuff.node_tree.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled")
    shader.inputs["Specular IOR Level"].default_value = row["specular"]
    with np.load(folder / row["mesh"]) as mesh:
        points = mesh["triangles"].reshape(-1, 3)
        normals = mesh["normals"].reshape(-1, 3)
    faces = np.arange(len(points)).reshape(-1, 3)
    subject = mesh_object(scene, "Subject", points, faces.tolist(), stuff)
    subject.data.normals_split_custom_set(normals.tolist())
    middle = (points.min(0) + points.max(0)) / 2
    camera = framing_camera(scene, points, (0.0, row["elevation"]), row["fov"], row["fill"])
    ground = plain_material("Ground", row["ground"], 0.75)
    if row["stage"] == "floor":
        floor(scene, 60.0, ground)
    elif row["stage"] == "cove":
        cyclorama(scene, row["radius"], 12.0, 0.0, ground)
    angles = (row["light_azimuth"], row["light_elevation"])
    area_light(scene, "Key", angles, 5.0, row["light_size"], row["light"], middle, row["light_color"])
    plain_world(scene, row["world"])
    scene.view_settings.view_transform = row["transform"]
    view = (camera.location - camera.location.__class__(middle)).length
    values: dict[str, tuple[float, ...]] = {f"film/{name}": (float(value),) for name, value in row["film"].items()}
    if row["fog"] > 0.0:
        color = tuple(float(c) for c in row["fog_color"])
        values |= {"volume/density": (row["fog"] / view,), "volume/color": color}
    left = bindings.write(scene, values, [subject], tuple(map(float, middle)))
    assert not left, left
    return scene, subject


if __name__ == "__main__":
    main(Path(sys.argv[1]))
    sys.stdout.flush()
