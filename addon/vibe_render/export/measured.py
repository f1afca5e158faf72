# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures the material inputs that nodes compute: as textures over UVs where possible, otherwise by small renders.

One Cycles render of the camera's view measures most inputs of all materials at each pixel: a temporary AOV output is
linked to each input. This works for every node network, whatever its texture coordinates. Flat surfaces, such as floors
and walls, are also rendered straight on, because mirrors show parts outside the camera's view.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass

import bpy
import numpy as np
from bpy.types import Material, Node, NodeTree, Scene
from mathutils import Matrix

from ..core import rendered
from ..core.compat import changed
from ..core.temporary import temporary
from ..render import bake
from ..scene.copies import copied_scene
from ..scene.nodes.trails import ValueOrigin
from . import textures
from .analysis import SceneAnalysis
from .materials import COLORS, ExportedMaterial, MeasuredChannel, computed_inputs, export_material, uv_of

_GROWN = 4  # pixels by which a map reaches beyond where its material is seen
_INDEX, _SQUARE = "Vibe Index", "Vibe Square"
_REACH = 3.0  # camera distances from the pivot; farther away, the patterns of a plane look too small


def measured_materials(analysis: SceneAnalysis) -> dict[str, ExportedMaterial]:
    """All materials of a scene, by name, for the engine, with measured values of the inputs that nodes compute."""
    geometry = analysis.geometry
    by_name = {m.name_full: m for m in bpy.data.materials}
    chosen = {name: by_name.get(name) for name in geometry.materials}
    channels: dict[str, dict[str, MeasuredChannel]] = {name: {} for name in chosen}
    requests = []
    # Textures over UVs are read or baked one by one; the rest is baked in one render.
    for name, material in chosen.items():
        if material is None:
            continue
        uvs = geometry.uvs[geometry.material == geometry.materials.index(name)]
        for channel, origin in computed_inputs(material).items():
            picture = _over_uvs(material, channel, origin, uvs)
            if picture:
                channels[name][channel] = MeasuredChannel(picture.image.mean((0, 1)), picture)
            else:
                requests.append(PassRequest(material, channel, origin))
    baked = bake_passes(analysis.scene, requests)
    for request in requests:
        name = request.material.name_full
        view = baked.get((name, request.channel))
        if view:
            channels[name][request.channel] = view
            far = _straight_on(analysis, request) if request.channel == "base_color" else None
            if far:
                channels[name]["far"] = MeasuredChannel(view.mean, far)
        # Not baked (out of view, or from a library): measure its mean.
        elif request.origin is not None and request.channel != "normal":
            mask = analysis.visible.material == geometry.materials.index(name)
            mean = np.full(3, 0.5, np.float32)
            # Out of view, only inputs matter that set the light sent to other surfaces.
            if mask.any() or request.channel in ("base_color", "emission_color", "emission", "alpha"):
                mean = textures.mean_color(analysis.scene, request.material, request.origin, mask)
            channels[name][request.channel] = MeasuredChannel(mean)
    return {name: export_material(material, channels[name]) for name, material in chosen.items()}


def _over_uvs(
    material: Material, channel: str, origin: ValueOrigin | None, uvs: np.ndarray
) -> textures.ExportedTexture | None:
    """The texture of a base color or alpha over the material's UV map; None for inputs that a render must measure."""
    if origin is None or channel not in ("base_color", "alpha"):
        return None
    chosen, matrix = uv_of(material)
    name, own = textures.uv_mapping(origin.source)
    if name != chosen or not np.allclose(matrix, own):
        return None
    outputs = ("Color", "Alpha") if channel == "alpha" else ("Color",)
    tiles = textures.plain_image(origin.source, outputs) is not None
    inside = uvs.size and -1e-3 <= uvs.min() <= uvs.max() <= 1 + 1e-3
    return textures.uv_texture(material, channel, origin) if tiles or inside else None


def _straight_on(analysis: SceneAnalysis, request: PassRequest) -> textures.ExportedTexture | None:
    """A flat surface's texture, rendered straight on and also outside the camera's view; None for other surfaces."""
    geometry, eye = analysis.geometry, analysis.scene.camera.matrix_world.translation
    chosen = geometry.material == geometry.materials.index(request.material.name_full)
    pivot = np.array(analysis.pivot)
    corners = geometry.vertices[geometry.faces[chosen]].astype(float)
    plane = capture_plane(corners, pivot, float(np.linalg.norm(pivot - np.array(eye))))
    if plane is None:
        return None
    baked = bake_passes(analysis.scene, [request], plane)
    view = baked.get((request.material.name_full, request.channel))
    picture = view.picture if view else None
    if picture is None or picture.window is None:
        return None
    left, bottom, right, top = picture.window
    scale, shift = np.array([1 / (right - left), 1 / (top - bottom)]), np.array([left, bottom])
    mapping = np.array(plane.mapping)
    mapping[:, 3] -= shift
    return textures.ExportedTexture(picture.image, "CLIP", "", None, (mapping * scale[:, None]).tolist())


@dataclass(frozen=True)
class PassRequest:
    """A request to bake an input that nodes compute; `origin` is None for a normal from Displacement, shown as bump."""

    material: Material
    channel: str
    origin: ValueOrigin | None

    @property
    def tree(self) -> NodeTree:
        """The tree that computes the input."""
        return self.origin.socket.id_data if self.origin else self.material.node_tree


def bake_passes(
    scene: Scene, requests: Sequence[PassRequest], plane: CapturePlane | None = None
) -> dict[tuple[str, str], MeasuredChannel]:
    """Bakes inputs with one render of the camera's view, or of `plane`.

    Returns values by (name of the material, channel); inputs out of view or in linked libraries are missing.
    """
    # What comes from linked libraries cannot be changed.
    requests = [r for r in requests if not (r.material.library or r.tree.library or r.tree.override_library)]
    if not requests:
        return {}
    materials = {r.material.name_full: r.material for r in reversed(requests)}
    names = list(dict.fromkeys(r.material.name_full for r in requests))
    channels = sorted({r.channel for r in requests})
    # One AOV output for each tree and channel: materials may share a group, and outputs of the same name add up.
    outputs = {(r.tree.as_pointer(), r.channel): r for r in requests}
    # A plane, which only mirrors show, gets fewer pixels and samples.
    sides = (384, 384) if plane else (scene.render.resolution_x, scene.render.resolution_y)
    scale = min(1.0, 512 / max(sides))
    width, height = (max(16, round(scale * side)) for side in sides)  # Blender refuses fewer
    with ExitStack() as stack:
        for request in outputs.values():
            _send(stack, request)
        for number, name in enumerate(names, 1):  # a material's number and its square tell which pixels show only it
            for output, value in ((_INDEX, number), (_SQUARE, number * number)):
                node = _added(stack, materials[name].node_tree, "OutputAOV")
                node.aov_name, node.inputs["Value"].default_value = output, value
        twin = stack.enter_context(copied_scene(scene, size=(width, height), film_transparent=False))
        if plane:
            stack.enter_context(straight_on(twin, plane))
        passes = _render(twin, channels, 2 if plane else 4)
    index, square = passes[_INDEX][..., 0], passes[_SQUARE][..., 0]
    # The mean of squares equals the square of the mean only in pixels that show a single material.
    alone = np.abs(square - index * index) < 1e-3 * (1 + square)
    baked = {}
    for request in requests:
        name, channel = request.material.name_full, request.channel
        shown = alone & (np.abs(index - names.index(name) - 1) < 1e-3)
        if shown.any():
            values = passes[f"Vibe {channel}"][..., : 3 if _is_color(channel) else 1]
            baked[name, channel] = _cropped(values, shown)
    return baked


def _is_color(channel: str) -> bool:
    """True for channels of three components: colors, and "normal" (world space, mapped from [-1, 1] to [0, 1])."""
    return channel in (*COLORS, "normal") or channel.startswith("color")


def _render(twin: Scene, channels: Sequence[str], samples: int) -> dict[str, np.ndarray]:
    """AOV name -> its image, from one render without lights, world and fog, as far as a scene's settings allow."""
    layer, cycles = rendered.layer(twin), twin.cycles
    rendered.set_world(twin, None)
    twin.render.engine = "CYCLES"
    for name in (*channels, _INDEX, _SQUARE):
        aov = layer.aovs.add()
        aov.name = name if name in (_INDEX, _SQUARE) else f"Vibe {name}"
        aov.type = "COLOR" if _is_color(name) else "VALUE"
    exact = {"use_denoising": False, "use_adaptive_sampling": False, "pixel_filter_type": "BOX"}
    fast = {"device": "CPU", "max_bounces": 0, "light_sampling_threshold": 1.0, "volume_max_steps": 2}
    settings = {"samples": samples, "time_limit": 0.0, **exact, **fast}
    with changed(cycles, **settings), changed(layer, pass_alpha_threshold=0.0):
        return bake.render_passes(twin)


def _added(stack: ExitStack, tree: NodeTree, kind: str) -> Node:
    node = tree.nodes.new(f"ShaderNode{kind}")
    stack.callback(tree.nodes.remove, node)
    return node


def _send(stack: ExitStack, request: PassRequest) -> None:
    """Adds an AOV output for a requested input to the tree that computes the input; `stack` removes the output."""
    tree = request.tree
    output = _added(stack, tree, "OutputAOV")
    output.aov_name = f"Vibe {request.channel}"
    source = request.origin.source if request.origin else None
    if request.channel == "normal":
        if source is None:
            source = _added(stack, tree, "NewGeometry").outputs["Normal"]
        half = _added(stack, tree, "VectorMath")
        half.operation = "MULTIPLY_ADD"  # AOVs clip negative values
        half.inputs[1].default_value = half.inputs[2].default_value = (0.5, 0.5, 0.5)
        tree.links.new(source, half.inputs[0])
        source = half.outputs[0]
    tree.links.new(source, output.inputs["Color" if _is_color(request.channel) else "Value"])


def _cropped(values: np.ndarray, shown: np.ndarray) -> MeasuredChannel:
    """The mean of an image (H, W, C) where `shown` (H, W) is True, and the texture of this part, grown by `_GROWN`."""
    height, width = shown.shape
    rows, columns = shown.any(1).nonzero()[0], shown.any(0).nonzero()[0]
    bottom, top = max(0, rows[0] - _GROWN), min(height, rows[-1] + 1 + _GROWN)
    left, right = max(0, columns[0] - _GROWN), min(width, columns[-1] + 1 + _GROWN)
    part, covered = values[bottom:top, left:right], shown[bottom:top, left:right]
    mean = part[covered].mean(0)
    # Fill unknown pixels with the mean of known neighbors, as deep as the part was extended; all others with the mean.
    image = np.where(covered[..., None], part, 0.0)
    for _ in range(_GROWN):
        total, count = np.zeros_like(image), np.zeros(covered.shape)
        padded = np.pad(image, ((1, 1), (1, 1), (0, 0))), np.pad(covered, 1)
        for dy in range(3):
            for dx in range(3):
                place = slice(dy, dy + covered.shape[0]), slice(dx, dx + covered.shape[1])
                total += padded[0][place] * padded[1][place][..., None]
                count += padded[1][place]
        fresh = ~covered & (count > 0)
        image[fresh] = total[fresh] / count[fresh][:, None]
        covered = covered | fresh
    image = np.where(covered[..., None], image, mean).astype(np.float32)
    window = (left / width, bottom / height, right / width, top / height)
    return MeasuredChannel(mean, textures.ExportedTexture(image, "EXTEND", "", window))


@dataclass(frozen=True)
class CapturePlane:
    """A square in the plane of a flat surface."""

    center: np.ndarray  # (3,), world space, meters
    axes: np.ndarray  # (3, 3), unit vectors in columns: right, up, and the normal
    side: float  # meters

    @property
    def mapping(self) -> list[list[float]]:
        """The 2 x 4 matrix from a point (x, y, z, 1) to the square: (0, 0) is its lower left corner, (1, 1) the opposite."""
        rows = self.axes.T[:2] / self.side
        return np.column_stack((rows, 0.5 - rows @ self.center)).tolist()


def capture_plane(corners: np.ndarray, pivot: np.ndarray, distance: float) -> CapturePlane | None:
    """The square around a flat surface, at most `_REACH` camera distances from the pivot; None for other surfaces.

    `corners` (F, 3, 3), of the surface's triangles, and `pivot` (3,) are in world space; `distance` is from camera to pivot.
    """
    edges = corners[:, 1:] - corners[:, :1]
    areas = np.cross(edges[:, 0], edges[:, 1])
    out = areas[np.argmax(np.linalg.norm(areas, axis=1))]
    out = out / max(np.linalg.norm(out), 1e-20)
    points = corners.reshape(-1, 3)
    extent = float(np.ptp(points, axis=0).max())
    if extent <= 0 or np.abs((points - points[0]) @ out).max() > 1e-4 * extent:
        return None  # not flat
    helper = np.array([1.0, 0.0, 0.0]) if abs(out[0]) < 0.7 else np.array([0.0, 1.0, 0.0])
    right = helper - out * (helper @ out)
    right /= np.linalg.norm(right)
    axes = np.column_stack((right, np.cross(out, right), out))
    flat = (points - pivot) @ axes
    low, high = (np.clip(f(flat, axis=0)[:2], -_REACH * distance, _REACH * distance) for f in (np.min, np.max))
    if (high - low).min() <= 0:
        return None
    middle = np.append((low + high) / 2, flat[0, 2])
    return CapturePlane(pivot + axes @ middle, axes, float((high - low).max()))


@contextmanager
def straight_on(scene: Scene, plane: CapturePlane) -> Iterator[None]:
    """Inside the block, the scene has an orthographic camera that sees `plane`, and nothing before or behind it."""
    data = bpy.data.cameras.new("Vibe Bake")
    camera = bpy.data.objects.new("Vibe Bake", data)
    scene.collection.objects.link(camera)
    data.type, data.ortho_scale = "ORTHO", plane.side
    above = max(plane.side, 1e-3)
    data.clip_start, data.clip_end = above * (1 - 1e-3), above * (1 + 1e-3)
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = plane.axes, plane.center + plane.axes[:, 2] * above
    camera.matrix_world = Matrix(pose.tolist())
    scene.camera = camera
    with temporary(camera, data):
        yield
