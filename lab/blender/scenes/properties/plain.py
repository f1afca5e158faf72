# SPDX-License-Identifier: GPL-3.0-or-later
"""The plain scene that `hiding`, `lighting` and `imaging` add one property each to, and parts that they share."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import bpy
from bpy.types import Collection, Material, Node, NodeTree, Object, Scene
from mathutils import Matrix, Vector
from vibe_render.core import compat, rendered

AddProperty = Callable[[Scene, Object], None]
AIM = Vector((0.0, 0.0, 0.5))


def material(name: str, color: tuple[float, float, float], thing: Object | None = None) -> Material:
    """A material of a color, on an object if one is given."""
    made = bpy.data.materials.new(name)
    shader(compat.enable_nodes(made)).inputs["Base Color"].default_value = (*color, 1.0)
    if thing is not None:
        thing.data.materials.append(made)
    return made


def shader(tree: NodeTree) -> Node:
    """The Principled BSDF of a material's tree."""
    return next(n for n in tree.nodes if n.type == "BSDF_PRINCIPLED")


def background(world: bpy.types.World) -> Node:
    """The Background of a world."""
    return next(n for n in compat.enable_nodes(world).nodes if n.type == "BACKGROUND")


def cube(scene: Scene, name: str, location: Sequence[float] = (0.0, 0.0, 0.0), size: float = 1.0) -> Object:
    """A cube of its own mesh, with UVs."""
    corners = [(x * size / 2, y * size / 2, z * size / 2) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(corners, [], faces)
    mesh.uv_layers.new(name="UVMap")
    thing = bpy.data.objects.new(name, mesh)
    thing.location = location
    scene.collection.objects.link(thing)
    return thing


def plain(scene: Scene) -> Object:
    """A cube on a floor, lit by a sun and a plain world, seen a little from above; returns the cube."""
    subject = cube(scene, "Subject", tuple(AIM))
    material("Body", (0.7, 0.2, 0.1), subject)
    material("Ground", (0.3, 0.5, 0.3), cube(scene, "Floor", (0.0, 0.0, -5.0), 10.0))
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.rotation_euler = 2.0, (0.7, 0.1, 0.4)
    scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    place = Vector((1.5, -3.5, 1.8))
    scene.camera.matrix_world = Matrix.Translation(place) @ (place - AIM).to_track_quat("Z", "Y").to_matrix().to_4x4()
    for thing in (sun, scene.camera):
        scene.collection.objects.link(thing)
    scene.world = bpy.data.worlds.new("World")
    background(scene.world).inputs["Color"].default_value = (0.2, 0.25, 0.35, 1.0)
    scene.render.resolution_x, scene.render.resolution_y = 48, 32
    return subject


def apart(scene: Scene, *things: Object, inside: Collection | None = None) -> Collection:
    """A collection of a scene, or of another collection, with these objects and nothing else."""
    made = bpy.data.collections.new("Apart")
    (inside or scene.collection).children.link(made)
    for thing in things:
        for old in thing.users_collection:
            old.objects.unlink(thing)
        made.objects.link(thing)
    return made


def obstacle(scene: Scene) -> Object:
    """A red cube between the camera and the subject, beside those that are there."""
    others = sum(thing.name.startswith("Obstacle") for thing in bpy.data.objects)
    thing = cube(scene, "Obstacle", (0.75 - 0.7 * others, -1.7, 1.1 + 0.3 * others), 0.5)
    material("Red", (0.9, 0.02, 0.02), thing)
    return thing


def lamp(scene: Scene, kind: str = "SUN") -> Object:
    """A strong, cold light from the left."""
    data = bpy.data.lights.new("Cold", kind)
    data.energy, data.color = (6.0 if kind == "SUN" else 600.0), (0.2, 0.4, 1.0)
    thing = bpy.data.objects.new("Cold", data)
    thing.rotation_euler = (0.0, -0.9, 0.0)
    thing.location = (-3.0, -1.0, 2.5)
    scene.collection.objects.link(thing)
    return thing


def layer_collection(scene: Scene, collection: Collection) -> bpy.types.LayerCollection:
    """A collection of the scene's own, as the view layer has it."""
    return next(c for c in rendered.layer(scene).layer_collection.children if c.collection == collection)


def instanced(scene: Scene, *things: Object) -> Object:
    """An instancer of a collection that the scene has only through it."""
    made = apart(scene, *things)
    scene.collection.children.unlink(made)
    holder = bpy.data.objects.new("Holder", None)
    holder.instance_type, holder.instance_collection = "COLLECTION", made
    scene.collection.objects.link(holder)
    return holder


def emissive(name: str, color: tuple[float, float, float], strength: float, thing: Object | None = None) -> Material:
    """A black material that glows."""
    made = material(name, (0.0, 0.0, 0.0), thing)
    inputs = shader(made.node_tree).inputs
    inputs["Emission Color"].default_value, inputs["Emission Strength"].default_value = ((*color, 1.0), strength)
    return made
