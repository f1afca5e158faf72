# SPDX-License-Identifier: GPL-3.0-or-later
"""Previews for the Asset Browser, rendered by us: Blender renders its own only while a window is open."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

import bmesh
import bpy
import numpy as np
from bpy.types import ID, Material, Scene

from ..render import final_render
from ..scene.stage import area_light, framing_camera, plain_world
from . import thumbnail

_BALL_SAMPLES = 48


def set_preview(block: ID, pixels: np.ndarray) -> None:
    """Gives a data-block a preview.

    Args:
        pixels: (H, W, 4) as displays show them, 0 to 1, row 0 at the bottom.
    """
    preview = block.preview_ensure()
    preview.image_size = (pixels.shape[1], pixels.shape[0])
    preview.image_pixels_float.foreach_set(np.ascontiguousarray(pixels, np.float32).ravel())


def material_balls(materials: Sequence[Material]) -> list[np.ndarray]:
    """Small Cycles renders of a ball of each material. Nothing of them stays in the file.

    Returns:
        Pictures as for `put`.
    """
    before = {block for kind in _KINDS for block in getattr(bpy.data, kind)}
    try:
        scene, ball = _ball_stage()
        with tempfile.TemporaryDirectory(prefix="vibe-") as folder:
            return [_shoot(scene, ball, material, Path(folder) / "ball.png") for material in materials]
    finally:
        temporary = [(kind, b) for kind in _KINDS for b in list(getattr(bpy.data, kind)) if b not in before]
        for kind, block in temporary:
            getattr(bpy.data, kind).remove(block)


_KINDS = (
    "scenes",
    "objects",
    "meshes",
    "lights",
    "cameras",
    "worlds",
    "materials",
)  # in this order of removal


def _ball_stage() -> tuple[Scene, bpy.types.Object]:
    """A scene of a ball under two area lights and a gray world, on a transparent background."""
    scene = bpy.data.scenes.new("Vibe Preview")
    scene.render.resolution_x = scene.render.resolution_y = thumbnail.SIZE
    scene.render.film_transparent = True
    scene.view_settings.view_transform = "Standard"
    mesh = bpy.data.meshes.new("Vibe Preview")
    shape = bmesh.new()
    shape.loops.layers.uv.new()
    bmesh.ops.create_uvsphere(shape, u_segments=64, v_segments=32, radius=1.0, calc_uvs=True)
    shape.to_mesh(mesh)
    shape.free()
    mesh.shade_smooth()
    mesh.materials.append(None)
    ball = bpy.data.objects.new("Vibe Preview", mesh)
    scene.collection.objects.link(ball)
    middle = np.zeros(3)
    framing_camera(scene, np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * 0.62,
                       (0.0, 12.0), fov=30.0, fill=0.92)  # fmt: skip
    area_light(scene, "Vibe Preview", (-45.0, 40.0), 4.0, 2.0, 0.9, middle)
    area_light(scene, "Vibe Preview", (140.0, 30.0), 4.0, 1.5, 0.8, middle)
    plain_world(scene, (0.5, 0.5, 0.5), strength=0.35)
    return scene, ball


def _shoot(scene: Scene, ball: bpy.types.Object, material: Material, path: Path) -> np.ndarray:
    ball.data.materials[0] = material
    final_render.render_picture(scene, path, thumbnail.SIZE, _BALL_SAMPLES)
    return thumbnail.read_picture(path)
