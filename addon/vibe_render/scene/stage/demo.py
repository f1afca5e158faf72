# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene of `vibe demo`: Suzanne on a plinth among polished solids, from Blender's own primitives."""

from __future__ import annotations

import math

import bpy
import numpy as np

from .parts import area_light, cyclorama, framing_camera, plain_material, plain_world

DEMO_SUBJECT = "Suzanne"
"""The object that the demo's prompts are about."""

_DEMO_VIEW = (24.0, 9.0)


def build_demo() -> bpy.types.Scene:
    """Starts an empty file and builds the demo scene in it."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True, load_ui=False)
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = 1024
    clay = plain_material("Clay", (0.46, 0.40, 0.34), roughness=0.45)
    stone = plain_material("Stone", (0.55, 0.53, 0.50), roughness=0.6)
    brass = plain_material("Brass", (0.72, 0.48, 0.19), roughness=0.22, metallic=1.0)
    enamel = plain_material("Enamel", (0.09, 0.16, 0.22), roughness=0.18)
    wall = plain_material("Wall", (0.36, 0.35, 0.34), roughness=0.8)
    suzanne = _suzanne(clay)
    _plinth(stone)
    _ring(brass)
    _ball("Large Ball", (-1.05, 0.15, 0.36), 0.36, enamel)
    _ball("Small Ball", (-0.62, -0.72, 0.17), 0.17, brass)
    _blocks(stone)
    cyclorama(scene, 8.0, 7.0, _DEMO_VIEW[0], wall).name = "Backdrop"
    pivot = np.array([0.0, 0.0, 0.86])
    framed = pivot + np.array([(-1.3, 0, 0), (1.3, 0, 0), (0, 0, 0.95)])
    framing_camera(scene, framed, _DEMO_VIEW, fov=28.0, fill=0.9, pivot=pivot)
    area_light(scene, "Key", (-35.0, 38.0), 4.5, 1.4, 1.45, pivot, (1.0, 0.95, 0.88))
    area_light(scene, "Rim", (150.0, 32.0), 4.5, 1.2, 1.0, pivot, (0.86, 0.93, 1.0))
    plain_world(scene, (0.5, 0.53, 0.57), strength=0.22)
    suzanne.select_set(True)
    return scene


def _suzanne(stuff: bpy.types.Material) -> bpy.types.Object:
    bpy.ops.mesh.primitive_monkey_add(size=1.15, location=(0.0, 0.0, 1.19))
    thing = bpy.context.object
    thing.name = DEMO_SUBJECT
    # she looks to the front; turned a little, she meets the key light
    thing.rotation_euler = (math.radians(-14), 0.0, math.radians(4))
    smooth = thing.modifiers.new("Smooth", "SUBSURF")
    smooth.levels = smooth.render_levels = 3
    return _finish_solid(thing, stuff)


def _plinth(stuff: bpy.types.Material) -> None:
    bpy.ops.mesh.primitive_cylinder_add(vertices=96, radius=0.5, depth=0.72, location=(0.0, 0.0, 0.36))
    _round(bpy.context.object, 0.03)
    _finish_solid(bpy.context.object, stuff).name = "Plinth"


def _ring(stuff: bpy.types.Material) -> None:
    bpy.ops.mesh.primitive_torus_add(
        major_radius=0.32,
        minor_radius=0.075,
        major_segments=96,
        minor_segments=32,
        location=(0.78, -0.5, 0.385),
        rotation=(math.radians(82), 0.0, math.radians(-28)),
    )
    _finish_solid(bpy.context.object, stuff).name = "Ring"


def _ball(name: str, place: tuple[float, float, float], radius: float, stuff: bpy.types.Material) -> None:
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=radius, location=place)
    _finish_solid(bpy.context.object, stuff).name = name


def _blocks(stuff: bpy.types.Material) -> None:
    """Blocks in a row: an array of one beveled block."""
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0.72, 0.75, 0.3))
    thing = bpy.context.object
    thing.scale = (0.24, 0.24, 0.6)
    row = thing.modifiers.new("Row", "ARRAY")
    row.count = 3
    row.relative_offset_displace = (1.25, 0.0, 0.0)
    _round(thing, 0.02)
    _finish_solid(thing, stuff).name = "Blocks"


def _round(thing: bpy.types.Object, width: float) -> None:
    bevel = thing.modifiers.new("Bevel", "BEVEL")
    bevel.width, bevel.segments, bevel.limit_method = width, 4, "ANGLE"


def _finish_solid(thing: bpy.types.Object, stuff: bpy.types.Material) -> bpy.types.Object:
    thing.data.shade_smooth()
    thing.data.set_sharp_from_angle(angle=math.radians(40))
    thing.data.materials.append(stuff)
    thing.select_set(False)
    return thing
