# SPDX-License-Identifier: GPL-3.0-or-later
"""Small scenes of the kinds that artists make, each built into an empty file."""

from __future__ import annotations

import math
from pathlib import Path

import bpy
import numpy as np
from bpy.types import Light, Material, Object, Scene, World
from vibe_render.core import compat

from lab.blender.scenes.properties.plain import cube as cube


def principled(name: str, obj: Object) -> Material:
    """A fresh material on an object."""
    material = bpy.data.materials.new(name)
    compat.enable_nodes(material)
    obj.data.materials.append(material)
    return material


def shader(material: Material) -> bpy.types.Node:
    """The Principled BSDF of a fresh material."""
    return next(n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED")


def light(scene: Scene, kind: str, location=(2.0, -2.0, 3.0)) -> Object:
    """A light named after its type, aimed nowhere in particular."""
    data: Light = bpy.data.lights.new(kind.title(), kind)
    obj = bpy.data.objects.new(kind.title(), data)
    obj.location = location
    obj.rotation_euler = (0.7, 0.1, 0.4)
    scene.collection.objects.link(obj)
    return obj


def camera(scene: Scene, location=(0.0, -6.0, 1.0)) -> Object:
    """A camera that looks along +Y."""
    obj = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    obj.location = location
    obj.rotation_euler = (math.radians(88.0), 0.0, 0.0)
    scene.collection.objects.link(obj)
    scene.camera = obj
    return obj


def world(scene: Scene) -> World:
    """A world of one color."""
    made = bpy.data.worlds.new("World")
    compat.enable_nodes(made)
    scene.world = made
    return made


def backdrop(world: World) -> bpy.types.Node:
    """Lets the camera see a Background of its own, which this returns; the world's Background lights."""
    tree = world.node_tree
    names = ("MixShader", "LightPath", "Background")
    mix, path, seen = (tree.nodes.new(f"ShaderNode{name}") for name in names)
    tree.links.new(path.outputs["Is Camera Ray"], mix.inputs[0])
    tree.links.new(tree.nodes["Background"].outputs[0], mix.inputs[1])
    tree.links.new(seen.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], tree.nodes["World Output"].inputs["Surface"])
    return seen


def picture(name: str = "Picture") -> bpy.types.Image:
    """A small image inside the file."""
    image = bpy.data.images.new(name, 8, 8)
    image.pack()
    return image


def wide_picture(folder: Path) -> Path:
    """A wide picture, red on the left and right, green in the middle."""
    image = bpy.data.images.new("wide", 300, 100)
    pixels = np.zeros((100, 300, 4), np.float32)
    pixels[..., 0], pixels[:, 100:200, 0], pixels[:, 100:200, 1], pixels[..., 3] = 1.0, 0.0, 1.0, 1.0
    image.pixels.foreach_set(pixels.ravel())
    image.filepath_raw, image.file_format = str(folder / "wide.jpg"), "JPEG"
    image.save()
    bpy.data.images.remove(image)
    return folder / "wide.jpg"


def bare(scene: Scene) -> list[Object]:
    """A cube and nothing else: no material, light, camera or world."""
    return [cube(scene, "Cube")]


def studio(scene: Scene) -> list[Object]:
    """Every kind of light, two materials, a floor, a plain world."""
    subject, floor = cube(scene, "Subject", (0.0, 0.0, 0.5)), cube(scene, "Floor", (0.0, 0.0, -5.0), 10.0)
    principled("Body", subject)
    principled("Ground", floor)
    for number, kind in enumerate(("POINT", "SPOT", "AREA", "SUN")):
        light(scene, kind, (2.0 - number, -2.0 + 1.5 * number, 3.0))
    bpy.data.lights["Area"].shape = "RECTANGLE"
    camera(scene)
    world(scene)
    return [subject]


def textured(scene: Scene) -> list[Object]:
    """A base color and roughness from a picture, an environment map that is the backdrop too, an existing compositor."""
    subject = cube(scene, "Subject")
    material = principled("Painted", subject)
    nodes, links = material.node_tree.nodes, material.node_tree.links
    texture = nodes.new("ShaderNodeTexImage")
    texture.image = picture()
    links.new(texture.outputs["Color"], shader(material).inputs["Base Color"])
    links.new(texture.outputs["Color"], shader(material).inputs["Roughness"])
    light(scene, "POINT")
    camera(scene)
    tree = world(scene).node_tree
    environment = tree.nodes.new("ShaderNodeTexEnvironment")
    environment.image = picture("Sky")
    tree.links.new(environment.outputs["Color"], tree.nodes["Background"].inputs["Color"])
    tree.links.new(environment.outputs["Color"], backdrop(scene.world).inputs["Color"])
    compositor(scene)
    return [subject]


def foggy(scene: Scene) -> list[Object]:
    """The artist's own fog in the world, and a backdrop of one color."""
    subject = studio(scene)
    backdrop(scene.world)
    tree = scene.world.node_tree
    volume = tree.nodes.new("ShaderNodeVolumePrincipled")
    volume.inputs["Density"].default_value = 0.03
    tree.links.new(volume.outputs["Volume"], tree.nodes["World Output"].inputs["Volume"])
    return subject


def compositor(scene: Scene) -> bpy.types.NodeTree:
    """An artist's compositing: Render Layers → Exposure → output."""
    if compat.COMPOSITOR_IS_GROUP:
        tree = bpy.data.node_groups.new("My Compositing", "CompositorNodeTree")
        tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        scene.compositing_node_group = tree
        output = tree.nodes.new("NodeGroupOutput")
    else:
        images = set(bpy.data.images)
        scene.use_nodes = True
        tree = scene.node_tree
        tree.nodes.clear()
        for image in set(bpy.data.images) - images:  # of the Viewer node that Blender puts there
            bpy.data.images.remove(image)
        output = tree.nodes.new("CompositorNodeComposite")
    layers, exposure = tree.nodes.new("CompositorNodeRLayers"), tree.nodes.new("CompositorNodeExposure")
    tree.links.new(layers.outputs["Image"], exposure.inputs["Image"])
    tree.links.new(exposure.outputs["Image"], output.inputs["Image"])
    return tree


ALL = {"bare": bare, "studio": studio, "textured": textured, "foggy": foggy}
