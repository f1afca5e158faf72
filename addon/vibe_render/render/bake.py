# SPDX-License-Identifier: GPL-3.0-or-later
"""Linear Cycles renders of temporary scenes, which measure the values of node networks; and pixels of image files."""

from __future__ import annotations

import math
import struct
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import bmesh
import bpy
import numpy as np
from bpy.types import Image, Light, Material, NodeTree, Object, Scene
from mathutils import Vector

from ..core import compat, rendered
from ..core.compat import assign, changed
from ..core.files import whole
from ..core.temporary import temporary
from ..scene.copies import copied_scene
from ..scene.light_types import type_of
from ..scene.nodes import light_nodes
from ..scene.nodes.trails import ValueOrigin, group_output, same_socket

_FACTOR_HEIGHT, _FACTOR_SAMPLES = 32, 64
LINEAR = {"media_type": "IMAGE", "file_format": "OPEN_EXR", "color_depth": "32", "color_mode": "RGB"}
"""`image_settings` of a linear EXR, to be set in this order: the later ones are valid only after the earlier ones."""
LAYERS = {"media_type": "MULTI_LAYER_IMAGE", "file_format": "OPEN_EXR_MULTILAYER", "color_depth": "32"}


def png(mode: str, depth: str = "8") -> dict[str, Any]:
    """`image_settings` of a PNG: `mode` is "RGB" or "RGBA", `depth` the bits of a channel."""
    kind = {"media_type": "IMAGE", "file_format": "PNG"}
    return {**kind, "color_mode": mode, "color_depth": depth, "compression": 15}


def render_file(scene: Scene, path: Path, kind: Mapping[str, Any], **options: str) -> None:
    """Renders a temporary scene to a file, atomically, with `image_settings` such as `LINEAR` and operator options."""
    assign(scene.render.image_settings, **kind)
    assign(scene.render, use_overwrite=True, use_file_extension=True)
    with whole(path) as part:
        scene.render.filepath = str(part)
        bpy.ops.render.render(scene=scene.name, write_still=True, **options)


def render_pixels(scene: Scene, kind: Mapping[str, Any], **options: str) -> np.ndarray:
    """Renders a temporary scene as `render_file` does; returns the pixels as `read_file` does."""
    with tempfile.TemporaryDirectory(prefix="vibe-") as folder:
        path = Path(folder) / f"pixels.{'png' if kind['file_format'] == 'PNG' else 'exr'}"
        render_file(scene, path, kind, **options)
        return read_file(path)


def _render_linear(scene: Scene, samples: int) -> np.ndarray:
    """Renders the scene with Cycles, without bounces: (H, W, 3) float32, scene-linear, row 0 at the bottom."""
    scene.render.engine = "CYCLES"
    exact = {"samples": samples, "use_denoising": False, "use_adaptive_sampling": False}
    with changed(scene.cycles, device="CPU", max_bounces=0, **exact):
        pixels = render_pixels(scene, LINEAR, layer=rendered.layer(scene).name)
    return np.nan_to_num(pixels[..., :3], nan=0.0, posinf=0.0, neginf=0.0)


def render_passes(scene: Scene) -> dict[str, np.ndarray]:
    """Renders a scene; returns the passes (H, W, C) float32 of its first view layer by name, row 0 at the bottom."""
    layer = rendered.layer(scene)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "passes.exr"
        render_file(scene, path, {**LAYERS, "exr_codec": "NONE", "use_exr_interleave": True}, layer=layer.name)
        channels = read_exr(path)
    passes: dict[str, dict[str, np.ndarray]] = {}
    for name, values in channels.items():
        owner, _, letter = name.rpartition(".")
        if owner.startswith(f"{layer.name}."):
            passes.setdefault(owner[len(layer.name) + 1 :], {})[letter] = values
    order = "RGBAXYZW"
    return {
        name: np.stack([letters[k] for k in sorted(letters, key=order.index)], -1) for name, letters in passes.items()
    }


def read_exr(path: Path) -> dict[str, np.ndarray]:
    """Channels (H, W) float32 of an OpenEXR file by their full names, row 0 at the bottom.

    Blender's Python API writes multilayer files but cannot read them. This reads only files with the settings of
    `render_passes`: one part, scan lines, no compression, 32-bit floats (openexr.com/en/latest/OpenEXRFileLayout.html).
    """
    data = path.read_bytes()
    if data[:4] != b"v/1\x01" or data[5] & 0b11010:  # tiles, deep data, several parts
        raise ValueError(f"{path.name} is not a plain OpenEXR file")
    header, at = {}, 8
    while data[at]:
        name_end = data.index(b"\0", at)
        kind_end = data.index(b"\0", name_end + 1)
        size = struct.unpack_from("<i", data, kind_end + 1)[0]
        header[data[at:name_end].decode()] = data[kind_end + 5 : kind_end + 5 + size]
        at = kind_end + 5 + size
    if header["compression"] != b"\0":
        raise ValueError(f"{path.name} is compressed")
    left, low, right, high = struct.unpack("<4i", header["dataWindow"])
    width, height = right - left + 1, high - low + 1
    names, table, place = [], header["channels"], 0  # channels, in the order in which each scan line has them
    while table[place]:
        end = table.index(b"\0", place)
        if struct.unpack_from("<i", table, end + 1)[0] != 2:
            raise ValueError("a channel does not hold 32-bit floats")
        names.append(table[place:end].decode())
        place = end + 17
    line = 4 * width * len(names)
    begin = at + 1 + 8 * height  # the first scan line, after the table of their offsets
    rows = np.frombuffer(data, np.uint8, height * (line + 8), begin).reshape(height, line + 8)
    values = np.ascontiguousarray(rows[:, 8:]).view("<f4").reshape(height, len(names), width)
    return {name: values[::-1, i] for i, name in enumerate(names)}


def image_channels(image: Image) -> np.ndarray:
    """The stored pixels of an image: (H, W, C) float32, row 0 at the bottom, in its own color space."""
    width, height = image.size
    flat = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(flat)
    return flat.reshape(height, width, image.channels)


def read_file(path: Path) -> np.ndarray:
    """The pixels of an image file as they are stored: (H, W, C) float32, row 0 at the bottom."""
    with temporary(bpy.data.images.load(str(path))) as image:
        image.colorspace_settings.is_data = True
        return image_channels(image)


def image_pixels(image: Image) -> np.ndarray:
    """Red, green and blue of `image_channels`: (H, W, 3); values that are not finite become 0, as in Cycles."""
    values = np.nan_to_num(image_channels(image), copy=False, nan=0.0, posinf=0.0, neginf=0.0)
    return values[..., :3] if image.channels >= 3 else np.repeat(values[..., :1], 3, axis=-1)


@contextmanager
def emitting(material: Material, origin: ValueOrigin) -> Iterator[Material]:
    """Yields a copy of a material that emits the value of the node output `origin.source`; removed after the block."""
    twin = material.copy()
    compat.drop_action(twin.node_tree)
    with temporary(twin, *emit(twin.node_tree, origin, "Emission", "Material")):
        yield twin


def emit(tree: NodeTree, origin: ValueOrigin, shader: str, output: str) -> list[NodeTree]:
    """Makes the tree of a copied material or world emit the value of `origin.source`; returns copied node groups.

    `shader` and `output` are "Emission" and "Material", or "Background" and "World".
    """
    # Copy the groups around the value, and give it an output through them to the top level of the tree.
    inner, groups, holders = tree, [], []
    for name in (group.name for group in origin.inside):
        holders.append(inner.nodes[name])
        inner = holders[-1].node_tree = holders[-1].node_tree.copy()
        compat.drop_action(inner)
        groups.append(inner)
    source = origin.source
    assert source
    socket = same_socket(inner.nodes[source.node.name].outputs, source)
    for holder, group in zip(reversed(holders), reversed(groups), strict=True):
        item = group.interface.new_socket("Vibe Bake", in_out="OUTPUT", socket_type="NodeSocketColor")
        group.links.new(socket, next(s for s in group_output(holder) if s.identifier == item.identifier))
        socket = next(s for s in holder.outputs if s.identifier == item.identifier)
    glow = tree.nodes.new(f"ShaderNode{shader}")
    tree.links.new(socket, glow.inputs["Color"])
    for node in [n for n in tree.nodes if n.bl_idname == f"ShaderNodeOutput{output}"]:
        for link in [link for entry in node.inputs for link in entry.links]:
            tree.links.remove(link)
        tree.links.new(glow.outputs[0], node.inputs["Surface"])
    return groups


def bake_view(scene: Scene, material: Material, size: int) -> np.ndarray:
    """The camera's view with an emitting material on all objects: (H, W, 3), scene-linear; `size`: longer side."""
    sides = scene.render.resolution_x, scene.render.resolution_y
    width, height = (max(16, round(size * side / max(sides))) for side in sides)  # 16: Blender's minimum
    with copied_scene(scene, size=(width, height), film_transparent=False) as twin:
        rendered.set_world(twin, None)
        rendered.layer(twin).material_override = material
        return _render_linear(twin, samples=4)


def bake_uvs(material: Material, size: int) -> np.ndarray:
    """The light of an emitting material over the unit square of UVs: (size, size, 3), scene-linear, row 0 at v = 0."""
    with empty_scene(size, size) as scene:
        mesh = bpy.data.meshes.new("Vibe Bake")
        mesh.from_pydata([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [], [(0, 1, 2, 3)])
        mesh.uv_layers.new().uv.foreach_set("vector", [0, 0, 1, 0, 1, 1, 0, 1])
        mesh.materials.append(material)
        plane = bpy.data.objects.new("Vibe Bake", mesh)
        scene.collection.objects.link(plane)
        scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 1.0
        scene.camera.location = (0.5, 0.5, 1.0)
        with temporary(plane, mesh):
            return _render_linear(scene, samples=4)


def bake_panorama(scene: Scene, samples: int) -> np.ndarray:
    """The surroundings of a temporary scene's camera, equirectangular: (H, 2H, 3), scene-linear, row 0 straight down."""
    camera = scene.camera
    camera.data.type = "PANO"
    target = camera.data if hasattr(camera.data, "panorama_type") else camera.data.cycles
    target.panorama_type = "EQUIRECTANGULAR"
    # The middle of an environment texture is +X, with +Z upwards.
    camera.rotation_euler = (math.pi / 2, 0.0, -math.pi / 2)
    return _render_linear(scene, samples)


@contextmanager
def empty_scene(width: int, height: int) -> Iterator[Scene]:
    """Yields a new scene with nothing but a camera, for renders of this size in pixels; removed after the block."""
    scene = bpy.data.scenes.new("Vibe Bake")
    data = bpy.data.cameras.new("Vibe Bake")
    camera = bpy.data.objects.new("Vibe Bake", data)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.resolution_percentage = 100
    with temporary(camera, data, scene):
        yield scene


def mean_light_factor(light: Object, pivot: Vector) -> tuple[float, float, float]:
    """Mean (red, green, blue) by which a light's nodes (IES, gobos; no Blackbody) scale its light toward the pivot."""
    # The ratio of two renders of a ball around the light, with and without the nodes. Its radius is that of the pivot's
    # distance, or 1 for a sun.
    endless = not type_of(light).has_position
    way = pivot - light.matrix_world.translation
    toward = -light.matrix_world.col[2].xyz if endless else way
    with _lit_ball(light, 1.0 if endless else max(way.length, 1e-3)) as (scene, data):
        light_nodes.whiten(data)
        with_nodes = bake_panorama(scene, _FACTOR_SAMPLES)
        light_nodes.flatten(data)
        without_nodes = bake_panorama(scene, _FACTOR_SAMPLES)
    # The weight of each texel of a panorama, (H, 2H, 1): solid angle times the cosine to the pivot, at least 0.
    elevation = ((np.arange(_FACTOR_HEIGHT) + 0.5) / _FACTOR_HEIGHT - 0.5) * math.pi
    azimuth = (0.5 - (np.arange(2 * _FACTOR_HEIGHT) + 0.5) / (2 * _FACTOR_HEIGHT)) * 2 * math.pi
    across = np.cos(elevation)[:, None]
    x, y, z = across * np.cos(azimuth), across * np.sin(azimuth), np.sin(elevation)[:, None]
    toward = toward.normalized()
    weight = (across * np.maximum(x * toward.x + y * toward.y + z * toward.z, 0.0))[..., None]
    total = (without_nodes * weight).sum((0, 1))
    if total.max() <= 0.0:  # the light shines away from the subject: count all directions
        weight = np.ones_like(weight)
        total = (without_nodes * weight).sum((0, 1))
    red, green, blue = ((with_nodes * weight).sum((0, 1)) / np.maximum(total, 1e-9)).tolist()
    return red, green, blue


@contextmanager
def _lit_ball(light: Object, radius: float) -> Iterator[tuple[Scene, Light]]:
    """Yields (temporary scene with a copy of a light at the center of a ball, the copy's light data)."""
    data, mesh = light.data.copy(), bpy.data.meshes.new("Vibe Bake")
    shape = bmesh.new()
    bmesh.ops.create_uvsphere(shape, u_segments=32, v_segments=16, radius=radius)
    shape.to_mesh(mesh)
    shape.free()
    lamp, ball = bpy.data.objects.new("Vibe Bake", data), bpy.data.objects.new("Vibe Bake", mesh)
    data.energy, data.color, data.use_temperature = 1000.0, (1.0, 1.0, 1.0), False
    lamp.visible_camera = ball.visible_shadow = False
    matrix = light.matrix_world.copy()
    matrix.translation = (0.0, 0.0, 0.0)
    lamp.matrix_world = matrix
    with temporary(lamp, ball, data, mesh), empty_scene(2 * _FACTOR_HEIGHT, _FACTOR_HEIGHT) as scene:
        for obj in (lamp, ball):
            scene.collection.objects.link(obj)
        yield scene, data
