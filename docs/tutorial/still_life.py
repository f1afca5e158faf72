# SPDX-License-Identifier: GPL-3.0-or-later
"""The tutorial's scene: a vase, a bowl and lemons on a table, gray and flatly lit, from Blender's own primitives.

python docs/tutorial/still_life.py FILE.blend
"""

import math
import sys
from pathlib import Path

import bpy
from mathutils import Vector

VASE = [(0.0, 0.0), (0.16, 0.0), (0.19, 0.04), (0.27, 0.24), (0.25, 0.42), (0.11, 0.62), (0.10, 0.74)]
VASE += [(0.15, 0.82), (0.13, 0.82), (0.08, 0.72)]
LEMON = [(0.0, -0.115), (0.012, -0.11), (0.018, -0.10), (0.050, -0.07), (0.070, -0.02), (0.070, 0.02)]
LEMON += [(0.050, 0.07), (0.020, 0.098), (0.016, 0.112), (0.0, 0.118)]
BOWL = [(0.0, 0.0), (0.14, 0.0), (0.15, 0.03), (0.30, 0.16), (0.28, 0.16), (0.13, 0.05), (0.0, 0.04)]
"""Profiles to turn around the vertical axis: (radius, height), meters."""


def main(path: Path) -> None:
    """Builds the scene and saves it."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True, load_ui=False)
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.samples = "CYCLES", 128
    scene.render.resolution_x, scene.render.resolution_y = 960, 720
    turned("Vase", VASE, (0.0, 0.0, 0.0), material("Glaze", 0.5, 0.5))
    turned("Bowl", BOWL, (0.52, -0.16, 0.0), material("Stoneware", 0.45, 0.6))
    peel = material("Peel", 0.55, 0.5)
    for number, place in enumerate([(0.44, -0.10, 0.13), (0.60, -0.24, 0.13), (-0.36, -0.34, 0.07)], 1):
        lemon(f"Lemon {number}", place, 75.0 * number, peel)
    table(material("Table", 0.3, 0.55))
    wall(material("Wall", 0.4, 0.9))
    lamp(scene, "Window", (-2.2, -1.6, 2.0), 1.2, 70.0)
    lamp(scene, "Fill", (2.0, -2.4, 1.4), 1.5, 25.0)
    sky(scene)
    camera(scene, "Wide", (0.5, -3.0, 0.95), 45.0)
    scene.camera = camera(scene, "Close", (0.35, -2.3, 0.85), 45.0)
    path.parent.mkdir(parents=True, exist_ok=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(path.absolute()))


def material(name: str, gray: float, roughness: float) -> bpy.types.Material:
    """A gray Principled material."""
    new = bpy.data.materials.new(name)
    if not new.node_tree:
        new.use_nodes = True  # Blender 4.5
    shader = next(n for n in new.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
    shader.inputs["Base Color"].default_value = (gray, gray, gray, 1.0)
    shader.inputs["Roughness"].default_value = roughness
    return new


def turned(name: str, profile: list, place: tuple, stuff: bpy.types.Material) -> bpy.types.Object:
    """A profile turned around the vertical axis, smooth."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(r, 0.0, z) for r, z in profile], [(i, i + 1) for i in range(len(profile) - 1)], [])
    thing = link(bpy.data.objects.new(name, mesh), place, stuff)
    turn = thing.modifiers.new("Turn", "SCREW")
    turn.steps = turn.render_steps = 48
    turn.use_merge_vertices = turn.use_normal_calculate = True
    smooth = thing.modifiers.new("Smooth", "SUBSURF")
    smooth.levels = smooth.render_levels = 2
    return thing


def lemon(name: str, place: tuple, turn: float, stuff: bpy.types.Material) -> None:
    """A lemon that lies on its side, turned around the vertical axis by degrees."""
    thing = turned(name, LEMON, place, stuff)
    thing.rotation_euler = (math.radians(84), 0.0, math.radians(turn))


def table(stuff: bpy.types.Material) -> None:
    """A round table top."""
    bpy.ops.mesh.primitive_cylinder_add(vertices=128, radius=1.5, depth=0.06, location=(0.0, 0.0, -0.03))
    thing = bpy.context.object
    thing.name = "Table"
    thing.data.materials.append(stuff)
    thing.select_set(False)


def wall(stuff: bpy.types.Material) -> None:
    """A wall behind the table."""
    bpy.ops.mesh.primitive_plane_add(size=14.0, location=(0.0, 2.2, 0.0), rotation=(math.pi / 2, 0.0, 0.0))
    thing = bpy.context.object
    thing.name = "Wall"
    thing.data.materials.append(stuff)
    thing.select_set(False)


def lamp(scene: bpy.types.Scene, name: str, place: tuple, size: float, watts: float) -> None:
    """A square area light that looks at the vase."""
    light = bpy.data.lights.new(name, "AREA")
    light.size, light.energy = size, watts
    look_at(link(bpy.data.objects.new(name, light), place))


def sky(scene: bpy.types.Scene) -> None:
    """A dim gray world."""
    scene.world = bpy.data.worlds.new("World")
    if not scene.world.node_tree:
        scene.world.use_nodes = True  # Blender 4.5
    background = next(n for n in scene.world.node_tree.nodes if n.type == "BACKGROUND")
    background.inputs["Color"].default_value = (0.3, 0.3, 0.3, 1.0)
    background.inputs["Strength"].default_value = 0.5


def camera(scene: bpy.types.Scene, name: str, place: tuple, lens: float) -> bpy.types.Object:
    """A camera that looks at the vase."""
    data = bpy.data.cameras.new(name)
    data.lens = lens
    return look_at(link(bpy.data.objects.new(name, data), place))


def look_at(thing: bpy.types.Object, point: tuple = (0.12, 0.0, 0.33)) -> bpy.types.Object:
    """Turns a camera or a lamp to a point."""
    thing.rotation_euler = (Vector(point) - thing.location).to_track_quat("-Z", "Y").to_euler()
    return thing


def link(thing: bpy.types.Object, place: tuple, stuff: bpy.types.Material | None = None) -> bpy.types.Object:
    """Puts a new object into the scene."""
    thing.location = place
    if stuff:
        thing.data.materials.append(stuff)
    bpy.context.scene.collection.objects.link(thing)
    return thing


if __name__ == "__main__":
    main(Path(sys.argv[-1]))
