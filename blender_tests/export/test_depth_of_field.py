# SPDX-License-Identifier: GPL-3.0-or-later
"""Depth of field in the prediction, against Cycles."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
import small_scenes as scenes
import torch
from bpy.types import Scene
from vibe_render.core import compat
from vibe_render.export import reading
from vibe_render.scene.subject import SubjectChoice

from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import load_scene

SIZE = 64


def _stage(scene: Scene, kind: str) -> None:
    """Three cubes, one behind the other, on a floor; the one in the middle is in focus."""
    for number, (x, y, color) in enumerate(((-0.9, -2.0, 0), (0.0, 0.5, 1), (1.2, 4.0, 2))):
        cube = scenes.cube(scene, f"Cube {number}", (x, y, 0.5))
        shader = scenes.shader(scenes.principled(f"Paint {number}", cube))
        shader.inputs["Base Color"].default_value = [0.8 if i == color else 0.05 for i in range(3)] + [1.0]
        shader.inputs["Roughness"].default_value = 1.0
    floor = scenes.cube(scene, "Floor", (0.0, 4.0, -10.0), 20.0)
    scenes.shader(scenes.principled("Floor", floor)).inputs["Roughness"].default_value = 1.0
    scenes.light(scene, "SUN", (0.0, -3.0, 8.0)).data.energy = 3.0
    camera = scenes.camera(scene, (0.0, -6.0, 1.2))
    camera.data.type, camera.data.ortho_scale = kind, 6.0
    camera.data.dof.use_dof = True
    camera.data.dof.focus_object = bpy.data.objects["Cube 1"]
    camera.data.dof.aperture_fstop = 0.04 if kind == "PERSP" else 1.5
    scene.world = bpy.data.worlds.new("World")
    compat.enable_nodes(scene.world)
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising = 64, False


def _cycles(scene: Scene, path: Path) -> np.ndarray:
    settings = scene.render.image_settings
    settings.file_format, settings.color_depth = "OPEN_EXR", "32"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(str(path))
    pixels = np.array(image.pixels[:], np.float32).reshape(SIZE, SIZE, 4)[::-1, :, :3]
    bpy.data.images.remove(image)
    return pixels


@pytest.mark.parametrize("kind", ["PERSP", "ORTHO"])
def test_what_is_out_of_focus_is_blurred_as_in_cycles(scene: Scene, tmp_path: Path, kind: str) -> None:
    _stage(scene, kind)
    rendered, predicted = [], []
    for used in (True, False):
        scene.camera.data.dof.use_dof = used
        rendered.append(_cycles(scene, tmp_path / f"{used}.exr"))
        job = reading.export_scene(scene, tmp_path / f"job {used}", SubjectChoice())
        assert not job.warnings
        with torch.no_grad():
            predicted.append(Proxy(load_scene(job.folder), (SIZE, SIZE)).render({}).linear.numpy())
    true, found = (blurred - sharp for blurred, sharp in (rendered, predicted))
    # What is left is the noise of two renders; without any blur the two sides are equal.
    assert np.abs(found - true).mean() < 0.75 * np.abs(true).mean()
