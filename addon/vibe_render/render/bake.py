# SPDX-License-Identifier: GPL-3.0-or-later
"""Linear pictures that Cycles renders in a scene of ours, to measure the values of node networks."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import bpy
import numpy as np

from ..core.compat import changed
from ..core.files import whole
from ..scene.copies import copied_scene
from ..scene.nodes.trails import ValueOrigin, group_output, same_socket


def render_linear(scene: bpy.types.Scene, samples: int, bounces: int = 0) -> np.ndarray:
    """Renders the scene with Cycles as it is set up.

    Returns:
        (H, W, 3) float32, scene linear, row 0 at the bottom.
    """
    cycles = scene.cycles
    scene.render.engine = "CYCLES"
    with (
        tempfile.TemporaryDirectory() as folder,
        changed(
            cycles,
            device="CPU",
            samples=samples,
            use_denoising=False,
            max_bounces=bounces,
            use_adaptive_sampling=False,
        ),
    ):
        path = Path(folder) / "linear.exr"
        picture = scene.render.image_settings
        if hasattr(picture, "media_type"):
            picture.media_type = "IMAGE"
        picture.file_format, picture.color_depth, picture.color_mode = "OPEN_EXR", "32", "RGB"
        with whole(path) as part:
            scene.render.filepath = str(part)
            bpy.ops.render.render(scene=scene.name, layer=scene.view_layers[0].name, write_still=True)
        image = bpy.data.images.load(str(path))
        try:
            return pixels(image)
        finally:
            bpy.data.images.remove(image)


def pixels(image: bpy.types.Image) -> np.ndarray:
    """The stored pixels of an image: (H, W, 3) float32, row 0 at the bottom, in its own color space.

    What is not finite counts as 0, as it does in Cycles.
    """
    width, height = image.size
    flat = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(flat)
    flat = np.nan_to_num(flat, copy=False, nan=0.0, posinf=0.0, neginf=0.0)
    values = flat.reshape(height, width, image.channels)
    return values[..., :3] if image.channels >= 3 else np.repeat(values[..., :1], 3, axis=-1)


@contextmanager
def emitting(material: bpy.types.Material, origin: ValueOrigin) -> Iterator[bpy.types.Material]:
    """A copy of a material that emits the value of one of its outputs; removed after the block.

    Args:
        material: The artist's; left as it is.
        origin: Where the output is: in the material's own tree, or in node groups, which are copied for the time.
    """
    twin = material.copy()
    tree = twin.node_tree
    exit_, groups = _led_out(tree, origin)
    glow = tree.nodes.new("ShaderNodeEmission")
    tree.links.new(exit_, glow.inputs["Color"])
    for output in [n for n in tree.nodes if n.bl_idname == "ShaderNodeOutputMaterial"]:
        for entry in output.inputs:
            for link in list(entry.links):
                tree.links.remove(link)
        tree.links.new(glow.outputs["Emission"], output.inputs["Surface"])
    try:
        yield twin
    finally:
        bpy.data.materials.remove(twin)
        for group in groups:
            bpy.data.node_groups.remove(group)


def _led_out(
    tree: bpy.types.NodeTree, origin: ValueOrigin
) -> tuple[bpy.types.NodeSocket, list[bpy.types.NodeTree]]:
    """An output in a tree that gives the value of one inside its node groups, and the copies of groups made for it."""
    groups, holders = [], []
    for name in (group.name for group in origin.inside):
        holders.append(tree.nodes[name])
        holders[-1].node_tree = holders[-1].node_tree.copy()
        tree = holders[-1].node_tree
        groups.append(tree)
    source = origin.source
    assert source
    socket = same_socket(tree.nodes[source.node.name].outputs, source)
    for holder, group in zip(reversed(holders), reversed(groups), strict=True):
        item = group.interface.new_socket("Vibe Bake", in_out="OUTPUT", socket_type="NodeSocketColor")
        group.links.new(socket, next(s for s in group_output(holder) if s.identifier == item.identifier))
        socket = next(s for s in holder.outputs if s.identifier == item.identifier)
    return socket, groups


def view_of(scene: bpy.types.Scene, material: bpy.types.Material, size: int) -> np.ndarray:
    """The camera's view of the scene when everything has this (glowing) material: (H, W, 3) linear."""
    sides = scene.render.resolution_x, scene.render.resolution_y
    width, height = (max(16, round(size * side / max(sides))) for side in sides)  # Blender refuses fewer
    with copied_scene(
        scene, resolution_x=width, resolution_y=height, resolution_percentage=100, film_transparent=False
    ) as twin:
        twin.world = None
        twin.view_layers[0].material_override = material
        return render_linear(twin, samples=4)


def plane_of(material: bpy.types.Material, size: int) -> np.ndarray:
    """A (glowing) material over the unit square of its UVs: (size, size, 3) linear, row 0 at v = 0."""
    with empty_scene(size, size) as scene:
        mesh = bpy.data.meshes.new("Vibe Bake")
        mesh.from_pydata([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [], [(0, 1, 2, 3)])
        mesh.uv_layers.new().uv.foreach_set("vector", [0, 0, 1, 0, 1, 1, 0, 1])
        mesh.materials.append(material)
        plane = bpy.data.objects.new("Vibe Bake", mesh)
        scene.collection.objects.link(plane)
        scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 1.0
        scene.camera.location = (0.5, 0.5, 1.0)
        try:
            return render_linear(scene, samples=4)
        finally:
            bpy.data.objects.remove(plane)
            bpy.data.meshes.remove(mesh)


def panorama_of(world: bpy.types.World, height: int, samples: int) -> np.ndarray:
    """A world as an environment texture: (height, 2 * height, 3) linear, row 0 straight down."""
    with empty_scene(2 * height, height) as scene:
        scene.world = world
        return panorama(scene, samples)


def panorama(scene: bpy.types.Scene, samples: int) -> np.ndarray:
    """What is around the camera of a scene of ours, likewise."""
    camera = scene.camera
    camera.data.type = "PANO"
    target = camera.data if hasattr(camera.data, "panorama_type") else camera.data.cycles
    target.panorama_type = "EQUIRECTANGULAR"
    # The middle of an environment texture is +X, with +Z upwards.
    camera.rotation_euler = (math.pi / 2, 0.0, -math.pi / 2)
    return render_linear(scene, samples)


@contextmanager
def empty_scene(width: int, height: int) -> Iterator[bpy.types.Scene]:
    """A new scene with nothing but a camera."""
    scene = bpy.data.scenes.new("Vibe Bake")
    data = bpy.data.cameras.new("Vibe Bake")
    camera = bpy.data.objects.new("Vibe Bake", data)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.resolution_percentage = 100
    try:
        yield scene
    finally:
        bpy.data.objects.remove(camera)
        bpy.data.cameras.remove(data)
        bpy.data.scenes.remove(scene)
