# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials, alpha and the transparent film: the proxy's picture against Cycles'."""

from __future__ import annotations

from pathlib import Path

import bpy
import pytest
import torch
from mathutils import Vector
from vibe_render import compat, rendering, scene_io
from vibe_render.subject import Choice

from proxy_renderer.render import color
from proxy_renderer.render.proxy import Proxy, Render
from proxy_renderer.report import load_picture
from proxy_renderer.scene import load_scene

SIZE, SAMPLES = 96, 64


@pytest.fixture
def stage(scene: bpy.types.Scene) -> bpy.types.Scene:
    """A floor, an area light, a grey world, and a camera that looks at (0, 0, 1)."""
    scene.render.resolution_x, scene.render.resolution_y = 96, 80
    _paint(_add("plane", size=30), "Floor", Base_Color=(0.5, 0.45, 0.4), Roughness=0.7)
    lamp = bpy.data.lights.new("Lamp", "AREA")
    lamp.energy, lamp.size = 400.0, 1.0
    _aim("Lamp", lamp, (3, -3, 4))
    scene.camera = _aim("Camera", bpy.data.cameras.new("Camera"), (0, -6, 2))
    scene.world = bpy.data.worlds.new("World")
    compat.enable_nodes(scene.world)
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.2, 0.22, 0.26, 1)
    return scene


def _add(kind: str, **more) -> bpy.types.Object:
    getattr(bpy.ops.mesh, f"primitive_{kind}_add")(**more)
    return bpy.context.object


def _ball(name: str, **inputs) -> bpy.types.Material:
    thing = _add("uv_sphere", radius=1.0, location=(0, 0, 1), segments=48, ring_count=24)
    bpy.ops.object.shade_smooth()
    return _paint(thing, name, **inputs)


def _paint(thing: bpy.types.Object, name: str, **inputs) -> bpy.types.Material:
    """Names an object and gives it a Principled material; "_" in an input's name stands for a space."""
    thing.name = name
    material = bpy.data.materials.new(name)
    compat.enable_nodes(material)
    sockets = material.node_tree.nodes["Principled BSDF"].inputs
    for key, value in inputs.items():
        sockets[key.replace("_", " ")].default_value = (*value, 1) if isinstance(value, tuple) else value
    thing.data.materials.append(material)
    return material


def _aim(name: str, data: bpy.types.ID, place: tuple[float, float, float]) -> bpy.types.Object:
    thing = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(thing)
    thing.location = place
    thing.rotation_euler = (Vector(place) - Vector((0, 0, 1))).to_track_quat("Z", "Y").to_euler()
    return thing


def _compare(scene: bpy.types.Scene, folder: Path) -> tuple[torch.Tensor, Render, list[str]]:
    """CIEDE2000 (H, W) between proxy and Cycles, the proxy's render, and the export's warnings."""
    job = scene_io.open_job(scene, folder / "job", Choice())
    rendering.render(scene, folder / "cycles.png", SIZE, SAMPLES)
    cycles = torch.from_numpy(load_picture(folder / "cycles.png"))
    with torch.no_grad():
        render = Proxy(load_scene(folder / "job"), (cycles.shape[1], cycles.shape[0])).render({})
    lab = color.srgb_to_lab(cycles), color.srgb_to_lab(render.display)
    return color.ciede2000(*lab), render, job.warnings


def test_transparent_film_shows_black_and_covers_what_is_hit(stage, tmp_path):
    _ball("Ball", Base_Color=(0.6, 0.15, 0.1))
    bpy.data.objects.remove(bpy.data.objects["Floor"])
    stage.render.film_transparent = True
    difference, render, _ = _compare(stage, tmp_path)
    assert render.alpha[0, 0] == 0
    assert render.alpha[40, 48] == 1
    assert 0 < render.alpha.mean() < 0.6
    assert difference.mean() < 1.0
