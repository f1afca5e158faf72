# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's side of `python -m lab scale`: builds a scene of a given size, and writes its job folders.

    python -m lab.blender.scale FOLDER TRIANGLES LIGHTS MATERIALS SHOTS

Balls stand in a grid on a floor, one for each material; lamps of every type hang in a ring; each shot has a camera of its own.
FOLDER gets a job folder for each shot, 0, 1, …; one event "scene" tells the `processor` seconds, `wall` seconds and `memory`,
MB, of writing them.
"""

from __future__ import annotations

import math
import resource
import sys
import time
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from mathutils import Vector
from vibe_render.export import reading
from vibe_render.scene.stage import plain_material, plain_world
from vibe_render.scene.subject import SubjectChoice

from lab.blender import side

_ROOM = 6.0
"""Meters: side of the square that the balls stand in."""
_KINDS = ("AREA", "POINT", "SPOT")
_POWER = 600.0
"""Watts of all lamps together."""


def build(triangles: int, lights: int, materials: int, shots: int) -> list[bpy.types.Object]:
    """Builds the scene into an empty file.

    Args:
        materials: How many, the floor's among them.

    Returns:
        The cameras.
    """
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True, load_ui=False)
    scene, count = bpy.context.scene, max(1, materials - 1)
    scene.render.resolution_x = scene.render.resolution_y = 1024
    side_count = math.ceil(math.sqrt(count))
    radius = _ROOM / side_count / 2 * 0.9
    mesh = _sphere(max(12, triangles // count), radius)
    for i in range(count):
        red, green, blue = (0.45 + 0.4 * math.sin(1.0 + i + 2.0 * c) for c in range(3))
        stuff = plain_material(f"Stuff {i}", (red, green, blue), roughness=0.25 + 0.5 * (i % 4) / 3)
        row, column = divmod(i, side_count)
        place = ((np.array([column, row]) + 0.5) / side_count - 0.5) * _ROOM
        data = mesh if i == 0 else mesh.copy()
        data.materials.clear()
        data.materials.append(stuff)
        ball = bpy.data.objects.new(f"Ball {i}", data)
        ball.location = (*place, radius)
        scene.collection.objects.link(ball)
    bpy.ops.mesh.primitive_plane_add(size=4 * _ROOM)
    bpy.context.object.data.materials.append(plain_material("Floor", (0.5, 0.5, 0.5), roughness=0.6))
    for i in range(lights):
        _lamp(scene, i, lights)
    plain_world(scene, (0.5, 0.5, 0.5), strength=0.2)
    return [_camera(scene, i, shots) for i in range(shots)]


def _sphere(triangles: int, radius: float) -> bpy.types.Mesh:
    """A ball of rings of quads: about so many triangles when they are cut."""
    rings = max(2, round(math.sqrt(triangles) / 2))
    around, up = np.arange(2 * rings) * (math.pi / rings), np.linspace(0.0, math.pi, rings + 1)
    spread = np.outer(np.sin(up), np.stack((np.cos(around), np.sin(around), np.ones_like(around))).ravel())
    places = spread.reshape(rings + 1, 3, -1).transpose(0, 2, 1)
    places[..., 2] = np.cos(up)[:, None]
    a = np.arange(rings)[:, None] * (2 * rings) + np.arange(2 * rings)
    b = np.arange(rings)[:, None] * (2 * rings) + (np.arange(2 * rings) + 1) % (2 * rings)
    quads = np.stack((a, a + 2 * rings, b + 2 * rings, b), -1).reshape(-1, 4)
    mesh = bpy.data.meshes.new("Ball")
    mesh.vertices.add(places.size // 3)
    mesh.vertices.foreach_set("co", (places * radius).astype(np.float32).ravel())
    mesh.loops.add(quads.size)
    mesh.loops.foreach_set("vertex_index", quads.astype(np.int32).ravel())
    mesh.polygons.add(len(quads))
    mesh.polygons.foreach_set("loop_start", np.arange(0, quads.size, 4, dtype=np.int32))
    mesh.update(calc_edges=True)
    mesh.shade_smooth()
    return mesh


def _lamp(scene: bpy.types.Scene, index: int, count: int) -> None:
    """One of a ring of lamps, in turn of each type, in colors that go around."""
    kind = _KINDS[index % len(_KINDS)]
    data = bpy.data.lights.new(f"Lamp {index}", kind)
    data.energy = _POWER / count
    data.color = [0.7 + 0.3 * math.cos(2 * math.pi * (index / count + c / 3)) for c in range(3)]
    lamp = bpy.data.objects.new(data.name, data)
    angle, height = 2 * math.pi * index / count, 3.0 + 1.5 * (index % 3)
    lamp.location = (5.0 * math.cos(angle), 5.0 * math.sin(angle), height)
    lamp.rotation_euler = (-lamp.location).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(lamp)


def _camera(scene: bpy.types.Scene, index: int, count: int) -> bpy.types.Object:
    data = bpy.data.cameras.new(f"Camera {index}")
    camera = bpy.data.objects.new(data.name, data)
    angle = math.radians(-90 + 60 * index / count)
    camera.location = (11.0 * math.cos(angle), 11.0 * math.sin(angle), 6.0)
    camera.rotation_euler = (Vector((0.0, 0.0, 0.5)) - camera.location).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(camera)
    return camera


def export(folder: Path, *sizes: int) -> dict[str, Any]:
    """Builds the scene and writes a job folder for each camera.

    Args:
        *sizes: As for `build`.
    """
    cameras = build(*sizes)
    scene, choice, first = bpy.context.scene, SubjectChoice(("Ball 0",)), None
    start = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, time.process_time(), time.monotonic()
    for number, camera in enumerate(cameras):
        scene.camera = camera
        job = reading.export_scene(scene, folder / str(number), choice, first)
        first = first or job.analysis
    end = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, time.process_time(), time.monotonic()
    memory, processor, wall = (b - a for a, b in zip(start, end, strict=True))
    return {"processor": round(processor, 3), "wall": round(wall, 3), "memory": round(memory / 1024, 1)}


if __name__ == "__main__":
    side.end(side.once(lambda: export(Path(sys.argv[1]), *map(int, sys.argv[2:]))))
