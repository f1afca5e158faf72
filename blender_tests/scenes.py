# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes such as artists make, built by script: for tests and for the end-to-end check.

python blender_tests/scenes.py still_life still_life.blend
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector


def still_life() -> bpy.types.Scene:
    """A bottle, fruit and a book on a table by a wall: six materials, three kinds of light."""
    scene = _empty(1200, 900)
    glaze = _material("Bottle Glaze", (0.08, 0.22, 0.16), 0.15, coat=0.6)
    apple, lemon = _material("Apple", (0.45, 0.05, 0.04), 0.35), _material("Lemon", (0.75, 0.55, 0.06), 0.5)
    table, wall = _material("Table", (0.20, 0.11, 0.06), 0.4), _material("Wall", (0.42, 0.40, 0.36), 0.9)
    gilt = _glossy("Gilt", (0.9, 0.6, 0.25), 0.2)
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0, 0.1, -0.05))
    bpy.context.object.scale = (3.2, 1.8, 0.1)
    _finish("Table", table, smooth=False)
    bpy.ops.mesh.primitive_plane_add(size=12.0, location=(0, 1.6, 2.0), rotation=(math.pi / 2, 0, 0))
    _finish("Wall", wall)
    _bottle(glaze)
    _fruit(apple, lemon)
    _book(_material("Book", (0.10, 0.13, 0.25), 0.6), gilt)
    _light("Window", "AREA", (-2.6, -1.6, 2.4), (0, 0, 0.4), 140.0, (0.92, 0.96, 1.0), size=1.6)
    _light("Lamp", "POINT", (1.7, 0.6, 1.5), (0, 0, 0), 28.0, (1.0, 0.72, 0.42), shadow_soft_size=0.12)
    _light("Spot", "SPOT", (0.5, -2.4, 2.6), (0.1, 0, 0.3), 60.0, (1.0, 0.95, 0.9), spot_size=0.6)
    _world(scene, (0.05, 0.055, 0.065), 1.0)
    _camera(scene, (0.75, -3.4, 1.15), (0.05, 0.0, 0.42), 45.0)
    return scene


def columns_in_fog() -> bpy.types.Scene:
    """A head between columns, light from behind, fog in the world's own volume."""
    scene = _empty(1200, 800)
    stone, bronze = (
        _material("Stone", (0.40, 0.37, 0.33), 0.8),
        _material("Bronze", (0.42, 0.27, 0.14), 0.35, metallic=1.0),
    )
    ground = _material("Ground", (0.22, 0.20, 0.18), 0.9)
    bpy.ops.mesh.primitive_plane_add(size=60.0)
    _finish("Ground", ground)
    for side, name in ((-1.9, "Columns Left"), (1.9, "Columns Right")):
        bpy.ops.mesh.primitive_cylinder_add(vertices=48, radius=0.35, depth=4.2, location=(side, -1.0, 2.1))
        row = bpy.context.object.modifiers.new("Row", "ARRAY")
        row.count, row.use_relative_offset, row.use_constant_offset = 4, False, True
        row.constant_offset_displace = (0.0, 2.6, 0.0)
        _finish(name, stone)
    bpy.ops.mesh.primitive_cube_add(size=0.9, location=(0, 0.6, 0.45))
    _finish("Pedestal", stone, smooth=False)
    bpy.ops.mesh.primitive_monkey_add(size=1.3, location=(0, 0.6, 1.45), rotation=(-0.2, 0, 0.25))
    bpy.context.object.modifiers.new("Smooth", "SUBSURF").render_levels = 2
    _finish("Head", bronze)
    # inside the fog, which is infinite and swallows suns
    _light("Back", "AREA", (0.8, 8.0, 3.6), (0, 0.6, 1.4), 1500.0, (1.0, 0.86, 0.66), size=2.5)
    _light("Front", "AREA", (-2.2, -3.2, 3.0), (0, 0.6, 1.3), 260.0, (0.85, 0.92, 1.0), size=1.5)
    _world(scene, (0.16, 0.20, 0.26), 1.0)
    tree = scene.world.node_tree
    fog = tree.nodes.new("ShaderNodeVolumePrincipled")
    fog.inputs["Density"].default_value, fog.inputs["Anisotropy"].default_value = 0.03, 0.3
    tree.links.new(fog.outputs["Volume"], tree.nodes["World Output"].inputs["Volume"])
    _camera(scene, (0.3, -6.2, 1.7), (0.0, 0.6, 1.5), 48.0)
    return scene


def textured() -> bpy.types.Scene:
    """A globe with a packed image texture on a stand, lit by a packed environment picture that is turned."""
    scene = _empty(900, 900)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.8, location=(0, 0, 1.25))
    _finish("Globe", _image_material("Globe Map", _map()))
    wood = _material("Stand", (0.16, 0.07, 0.03), 0.3)
    bpy.ops.mesh.primitive_torus_add(
        major_radius=0.98, minor_radius=0.045, location=(0, 0, 1.25), rotation=(0.35, 0.4, 0)
    )
    _finish("Ring", _material("Brass", (0.7, 0.5, 0.2), 0.25, metallic=1.0))
    bpy.ops.mesh.primitive_cylinder_add(vertices=64, radius=0.42, depth=0.35, location=(0, 0, 0.175))
    _finish("Foot", wood)
    bpy.ops.mesh.primitive_plane_add(size=14.0)
    _finish("Floor", _material("Floor", (0.45, 0.43, 0.40), 0.5))
    _light("Key", "AREA", (-2.2, -2.2, 3.2), (0, 0, 1.0), 120.0, (1, 1, 1), size=1.2)
    _environment(scene, _sky(), 0.6)
    _camera(scene, (1.3, -4.4, 1.9), (0, 0, 1.0), 40.0)
    return scene


SCENES = {"still_life": still_life, "columns_in_fog": columns_in_fog, "textured": textured}


def _empty(width: int, height: int) -> bpy.types.Scene:
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True, load_ui=False)
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = width, height
    return scene


def _material(
    name: str, color: tuple[float, ...], roughness: float, metallic: float = 0.0, coat: float = 0.0
) -> bpy.types.Material:
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    inputs = material.node_tree.nodes["Principled BSDF"].inputs
    inputs["Base Color"].default_value = (*color, 1.0)
    inputs["Roughness"].default_value, inputs["Metallic"].default_value = roughness, metallic
    inputs["Coat Weight"].default_value = coat
    return material


def _glossy(name: str, color: tuple[float, ...], roughness: float) -> bpy.types.Material:
    """A material without a Principled BSDF."""
    material = _material(name, color, roughness)
    tree = material.node_tree
    tree.nodes.remove(tree.nodes["Principled BSDF"])
    shader = tree.nodes.new("ShaderNodeBsdfAnisotropic")
    shader.inputs["Color"].default_value, shader.inputs["Roughness"].default_value = (*color, 1.0), roughness
    tree.links.new(shader.outputs["BSDF"], tree.nodes["Material Output"].inputs["Surface"])
    return material


def _image_material(name: str, image: bpy.types.Image) -> bpy.types.Material:
    material = _material(name, (0.8, 0.8, 0.8), 0.35)
    tree = material.node_tree
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    tree.links.new(texture.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    return material


def _image(name: str, pixels: np.ndarray, is_float: bool = False) -> bpy.types.Image:
    """A packed image from (H, W, 3), row 0 at the bottom."""
    height, width, _ = pixels.shape
    image = bpy.data.images.new(name, width, height, float_buffer=is_float)
    rgba = np.concatenate([pixels, np.ones((height, width, 1))], axis=-1)
    image.pixels.foreach_set(rgba.astype(np.float32).ravel())
    image.pack()
    return image


def _map() -> bpy.types.Image:
    """Land and sea from a few waves."""
    v, u = np.meshgrid(np.linspace(-1, 1, 256), np.linspace(0, 2 * np.pi, 512, endpoint=False), indexing="ij")
    waves = (
        np.sin(2 * u + 3 * v) + np.sin(3 * u - 4 * v + 1) + 0.6 * np.sin(5 * u + 7 * v) + 0.4 * np.sin(9 * u - 8 * v)
    )
    land = 1 / (1 + np.exp(-12 * (waves - 0.4)))[..., None]
    ice = np.clip((np.abs(v) - 0.8) * 12, 0, 1)[..., None]
    ground = land * np.array([0.62, 0.55, 0.30]) + (1 - land) * np.array([0.12, 0.30, 0.48])
    return _image("Globe Map", (1 - ice) * ground + ice * np.array([0.92, 0.93, 0.95]))


def _sky() -> bpy.types.Image:
    """Blue above, brown below, a warm glow to one side."""
    height, width = 64, 128
    v, u = np.meshgrid((np.arange(height) + 0.5) / height, (np.arange(width) + 0.5) / width, indexing="ij")
    up = np.clip((v - 0.5) * 6 + 0.5, 0, 1)[..., None]
    sky = np.array([0.35, 0.50, 0.75]) * (1.3 - v[..., None])
    glow = np.exp(-(((u - 0.3) / 0.08) ** 2 + ((v - 0.58) / 0.08) ** 2))[..., None] * np.array([9.0, 6.0, 3.0])
    return _image("Sky", up * sky + (1 - up) * np.array([0.10, 0.08, 0.06]) + glow, is_float=True)


def _bottle(stuff: bpy.types.Material) -> None:
    """A profile that a Screw modifier turns."""
    profile = [
        (0, 0),
        (0.17, 0),
        (0.19, 0.03),
        (0.19, 0.5),
        (0.15, 0.62),
        (0.06, 0.72),
        (0.055, 0.92),
        (0.075, 0.95),
        (0.05, 0.96),
    ]
    mesh = bpy.data.meshes.new("Bottle")
    mesh.from_pydata([(r, 0, z) for r, z in profile], [(i, i + 1) for i in range(len(profile) - 1)], [])
    bottle = bpy.data.objects.new("Bottle", mesh)
    bpy.context.collection.objects.link(bottle)
    bpy.context.view_layer.objects.active = bottle
    turn = bottle.modifiers.new("Turn", "SCREW")
    turn.steps = turn.render_steps = 64
    turn.use_normal_calculate = True
    bottle.modifiers.new("Smooth", "SUBSURF").render_levels = 1
    bottle.location = (-0.28, 0.1, 0)
    _finish("Bottle", stuff, smooth=False)


def _fruit(apple: bpy.types.Material, lemon: bpy.types.Material) -> None:
    """A collection of an apple and a lemon, shown once itself and once as an instance."""
    fruit = bpy.data.collections.new("Fruit")
    bpy.context.scene.collection.children.link(fruit)
    for name, place, scale, stuff in (
        ("Apple", (0.16, -0.22, 0.125), (1, 1, 0.92), apple),
        ("Lemon", (-0.02, -0.42, 0.09), (1.25, 0.85, 0.85), lemon),
    ):
        bpy.ops.mesh.primitive_uv_sphere_add(
            segments=48, ring_count=24, radius=0.125 if name == "Apple" else 0.1, location=place
        )
        thing = bpy.context.object
        thing.scale = scale
        _finish(name, stuff)
        bpy.context.scene.collection.objects.unlink(thing)
        fruit.objects.link(thing)
    copy = bpy.data.objects.new("More Fruit", None)
    copy.instance_type, copy.instance_collection = "COLLECTION", fruit
    copy.location, copy.rotation_euler = (0.52, -0.12, 0), (0, 0, 1.3)
    bpy.context.scene.collection.objects.link(copy)


def _book(cover: bpy.types.Material, gilt: bpy.types.Material) -> None:
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0.32, 0.22, 0.05), rotation=(0, 0, 0.4))
    bpy.context.object.scale = (0.62, 0.42, 0.1)
    bevel = bpy.context.object.modifiers.new("Bevel", "BEVEL")
    bevel.width, bevel.segments = 0.012, 3
    _finish("Book", cover, smooth=False)
    bpy.ops.object.text_add(location=(0.16, 0.02, 0.101), rotation=(0, 0, 0.4))
    text = bpy.context.object
    text.name, text.data.body, text.data.size, text.data.extrude = "Title", "VIBE", 0.14, 0.002
    text.data.materials.append(gilt)


def _finish(name: str, stuff: bpy.types.Material, smooth: bool = True) -> None:
    thing = bpy.context.view_layer.objects.active
    thing.name = name
    thing.data.materials.append(stuff)
    if smooth:
        thing.data.shade_smooth()
        thing.data.set_sharp_from_angle(angle=0.7)


def _light(name: str, kind: str, place: tuple, target: tuple, energy: float, color: tuple, **more: float) -> None:
    lamp = bpy.data.lights.new(name, kind)
    lamp.energy, lamp.color = energy, color
    for key, value in more.items():
        setattr(lamp, key, value)
    thing = bpy.data.objects.new(name, lamp)
    _aim(thing, place, target)
    bpy.context.scene.collection.objects.link(thing)


def _camera(scene: bpy.types.Scene, place: tuple, target: tuple, lens: float) -> None:
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.lens = lens
    _aim(camera, place, target)
    scene.collection.objects.link(camera)
    scene.camera = camera


def _aim(thing: bpy.types.Object, place: tuple, target: tuple) -> None:
    thing.location = place
    thing.rotation_euler = (Vector(target) - Vector(place)).to_track_quat("-Z", "Y").to_euler()


def _world(scene: bpy.types.Scene, color: tuple, strength: float) -> None:
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes = True
    background = scene.world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (*color, 1.0)
    background.inputs["Strength"].default_value = strength


def _environment(scene: bpy.types.Scene, image: bpy.types.Image, turn: float) -> None:
    _world(scene, (0, 0, 0), 1.0)
    tree = scene.world.node_tree
    texture, mapping = tree.nodes.new("ShaderNodeTexEnvironment"), tree.nodes.new("ShaderNodeMapping")
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    texture.image = image
    mapping.inputs["Rotation"].default_value[2] = turn
    tree.links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], tree.nodes["Background"].inputs["Color"])


if __name__ == "__main__":
    SCENES[sys.argv[-2]]()
    bpy.ops.wm.save_as_mainfile(filepath=str(Path(sys.argv[-1]).absolute()))
