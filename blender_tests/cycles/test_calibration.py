# SPDX-License-Identifier: GPL-3.0-or-later
"""The proxy against Cycles: a white diffuse plane under every kind of light agrees within 2 %."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
import torch
from vibe_render.export.analysis import analyze
from vibe_render.export.job_folder import write_job
from vibe_render.scene.subject import SubjectChoice

from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import load_scene

SIZE = 24
HEIGHT = 2.0
LAMPS = {
    "POINT": {"energy": 200.0, "shadow_soft_size": 0.2},
    "SUN": {"energy": 3.0, "angle": 0.1},
    "SPOT": {"energy": 400.0, "shadow_soft_size": 0.1, "spot_size": 1.4, "spot_blend": 0.6},
    "AREA": {"energy": 150.0, "size": 0.8},
    "AREA wide": {"energy": 150.0, "size": 3.0},
    "AREA disk": {"energy": 150.0, "size": 1.0, "shape": "DISK"},
    "AREA flat": {"energy": 150.0, "size": 1.5, "size_y": 0.4, "shape": "RECTANGLE"},
}


@pytest.mark.parametrize("name", [*LAMPS, "WORLD"])
def test_white_plane(scene: bpy.types.Scene, tmp_path: Path, name: str) -> None:
    _fill(scene, name)
    write_job(analyze(scene, SubjectChoice()), tmp_path / "job")
    cycles = _cycles(scene, tmp_path / "cycles.exr")
    proxy = Proxy(load_scene(tmp_path / "job"), (SIZE, SIZE)).render({}).linear.numpy()
    # Patches of 6 x 6 pixels leave less than 1 % of noise; a spot's cone ends within the outermost.
    patches = [p.reshape(4, 6, 4, 6, 3).mean((1, 3, 4)) for p in (cycles, proxy)]
    assert patches[0][1:3, 1:3].min() > 0.05
    np.testing.assert_allclose(patches[1][1:3, 1:3], patches[0][1:3, 1:3], rtol=0.02)
    np.testing.assert_allclose(patches[1], patches[0], rtol=0.05, atol=0.01 * patches[0].max())


@pytest.mark.parametrize("kelvin", [2500.0, 6500.0, 11000.0])
def test_temperature_and_exposure(scene: bpy.types.Scene, tmp_path: Path, kelvin: float) -> None:
    _fill(scene, "AREA")
    lamp = bpy.data.lights["Lamp"]
    if not hasattr(lamp, "temperature"):
        pytest.skip("This Blender's lights have no temperature.")
    lamp.use_temperature, lamp.temperature, lamp.exposure = True, kelvin, 0.7
    write_job(analyze(scene, SubjectChoice()), tmp_path / "job")
    cycles = _cycles(scene, tmp_path / "cycles.exr").mean((0, 1))
    proxy = Proxy(load_scene(tmp_path / "job"), (SIZE, SIZE)).render({}).linear.mean((0, 1)).numpy()
    np.testing.assert_allclose(proxy, cycles, rtol=0.02, atol=0.005 * cycles.max())


def _fill(scene: bpy.types.Scene, name: str) -> None:
    """A white plane seen from above, under one lamp that stands a little aside."""
    bpy.ops.mesh.primitive_plane_add(size=40.0)
    white = bpy.data.materials.new("White")
    white.use_nodes = True
    principled = next(n for n in white.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
    principled.inputs["Base Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    principled.inputs["Specular IOR Level"].default_value = 0.0
    bpy.context.object.data.materials.append(white)
    world = scene.world = bpy.data.worlds.new("World")
    world.use_nodes = True
    background = next(n for n in world.node_tree.nodes if n.type == "BACKGROUND")
    background.inputs["Color"].default_value = (0.2, 0.5, 0.8, 1.0) if name == "WORLD" else (0.0, 0.0, 0.0, 1.0)
    if name != "WORLD":
        _lamp(name)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.data.angle = (0.0, 0.0, 3.0), 0.6
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.resolution_x = scene.render.resolution_y = SIZE


def _lamp(name: str) -> None:
    data = bpy.data.lights.new("Lamp", name.split()[0])
    for key, value in LAMPS[name].items():
        setattr(data, key, value)
    lamp = bpy.data.objects.new("Lamp", data)
    lamp.location, lamp.rotation_euler = (0.4, 0.2, HEIGHT), (0.1, -0.2, 0.3)
    bpy.context.scene.collection.objects.link(lamp)


def _cycles(scene: bpy.types.Scene, path: Path) -> np.ndarray:
    """Linear light (H, W, 3), row 0 on top, of a real render."""
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising = 256, False
    settings = scene.render.image_settings
    settings.file_format, settings.color_depth = "OPEN_EXR", "32"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(str(path))
    pixels = np.array(image.pixels[:], np.float32).reshape(SIZE, SIZE, 4)
    assert torch.isfinite(torch.from_numpy(pixels)).all()
    return pixels[::-1, :, :3]
