# SPDX-License-Identifier: GPL-3.0-or-later
"""The colors that node networks give: read from image files where possible, otherwise measured by a render."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Color

from ..core.color import to_linear
from ..core.temporary import temporary
from ..render import bake
from ..scene.nodes.trails import ValueOrigin, active_links

_LONGEST = 1024
_BAKED = 512
_VIEW = 96

# Nodes whose result depends on nothing but their inputs; textures among them need their Vector linked.
_PURE = {
    "ShaderNodeMix", "ShaderNodeMixRGB", "ShaderNodeMath", "ShaderNodeVectorMath", "ShaderNodeMapRange",
    "ShaderNodeValToRGB", "ShaderNodeRGBCurve", "ShaderNodeHueSaturation", "ShaderNodeBrightContrast",
    "ShaderNodeGamma", "ShaderNodeInvert", "ShaderNodeSeparateColor", "ShaderNodeCombineColor",
    "ShaderNodeSeparateXYZ", "ShaderNodeCombineXYZ", "ShaderNodeRGBToBW", "ShaderNodeClamp", "ShaderNodeMapping",
    "ShaderNodeRGB", "ShaderNodeValue", "ShaderNodeUVMap", "NodeReroute", "ShaderNodeTexImage",
}  # fmt: skip
_TEXTURES = {
    "ShaderNodeTexNoise", "ShaderNodeTexVoronoi", "ShaderNodeTexChecker", "ShaderNodeTexBrick",
    "ShaderNodeTexWave", "ShaderNodeTexMagic", "ShaderNodeTexGradient", "ShaderNodeTexWhiteNoise",
}  # fmt: skip


@dataclass(frozen=True)
class ExportedTexture:
    """A picture of a material's input."""

    image: np.ndarray  # (H, W, C) float32 linear, row 0 at the bottom
    extension: str = "REPEAT"  # "REPEAT", "EXTEND" or "CLIP"
    warning: str = ""  # what is only approximate about it, "" if nothing
    # left, bottom, right and top in parts of the camera's picture; None for a texture over UVs
    window: tuple[float, float, float, float] | None = None
    # for a flat surface seen straight on: the 2 x 4 matrix that takes world-space points to the image
    plane: list[list[float]] | None = None


def uv_mapping(source: bpy.types.NodeSocket | None) -> tuple[str, np.ndarray]:
    """The UV map that the texture behind an output reads, and the 3x3 matrix of its Mapping node."""
    node = plain_image(source, ("Color", "Alpha"))
    if node is not None:
        return _coordinates(node) or ("", np.eye(3))
    maps = [n.uv_map for n in _upstream(source) if n.bl_idname == "ShaderNodeUVMap"] if source else []
    return (maps[0] if maps else ""), np.eye(3)


def uv_texture(material: bpy.types.Material, channel: str, origin: ValueOrigin) -> ExportedTexture | None:
    """The picture of an input ("alpha", or an untinted color) that depends only on UVs in the unit square; else None."""
    source = origin.source
    assert source
    node = plain_image(source, ("Color", "Alpha") if channel == "alpha" else ("Color",))
    if node is None:
        if not _reads_uv_only(source):
            return None
        with bake.emitting(material, origin) as glowing:
            return ExportedTexture(bake.bake_uvs(glowing, _BAKED))
    alpha = channel == "alpha" and source.name == "Alpha"
    image = image_alpha(node.image) if alpha else image_colors(node.image)
    if image is None:
        missing = f"The image {node.image.name!r} is missing"
        # as Cycles shows it
        return ExportedTexture(np.array([[[1.0, 0.0, 1.0]]], np.float32), warning=missing)
    return ExportedTexture(image, {"MIRROR": "REPEAT"}.get(node.extension, node.extension))


def mean_color(
    scene: bpy.types.Scene, material: bpy.types.Material, origin: ValueOrigin, mask: np.ndarray
) -> np.ndarray:
    """The mean color (3,) that an output gives over the part of a material where a camera mask (R, R) is true, linear.

    An image that is read directly counts whole. Of a material that the camera does not see, the unit square of its
    UVs counts: mirrors and light that bounces may show it.
    """
    assert origin.source
    plain = plain_image(origin.source)
    image = image_colors(plain.image) if plain else None
    if image is not None:
        return image.reshape(-1, 3).mean(0)
    with bake.emitting(material, origin) as glowing:
        if not mask.any():
            return bake.bake_uvs(glowing, _VIEW).mean((0, 1))
        view = bake.bake_view(scene, glowing, _VIEW)
    rows, columns = ((np.arange(len(mask)) + 0.5) / len(mask) * side for side in view.shape[:2])
    return view[rows.astype(int)][:, columns.astype(int)][mask].mean(0)


def image_colors(image: bpy.types.Image | None) -> np.ndarray | None:
    """A linear copy of an image with at most 1024 pixels a side; None if its file is missing."""
    if image is None or not image.size[0] or not image.size[1]:
        return None
    colors = shrink(bake.image_pixels(image), _LONGEST)
    if image.is_float or image.colorspace_settings.is_data:
        return colors
    primaries = [Color(row).from_rec709_linear_to_scene_linear() for row in np.eye(3)]
    return (to_linear(colors) @ np.array(primaries)).astype(np.float32)


def is_encoded_usually(image: bpy.types.Image | None) -> bool:
    """True if an image's colors are linear, data or encoded as those of new images, which is sRGB in any configuration.

    The color spaces of a configuration have any names, and only Blender can decode all of them: by a render.
    """
    if image is None or image.is_float:
        return True
    space = image.colorspace_settings
    if space.is_data or not space.name:  # an unknown space is taken for sRGB
        return True
    with temporary(bpy.data.images.new("Vibe Bake", 1, 1)) as fresh:
        return fresh.colorspace_settings.name == space.name


def image_alpha(image: bpy.types.Image | None) -> np.ndarray | None:
    """The alpha (H, W, 1) of an image with at most 1024 pixels a side; None if its file is missing."""
    if image is None or not image.size[0] or not image.size[1]:
        return None
    if image.channels < 4:
        return np.ones((1, 1, 1), np.float32)
    return shrink(bake.image_channels(image)[..., 3:4], _LONGEST)


def shrink(image: np.ndarray, longest: int) -> np.ndarray:
    """Averages blocks of pixels (H, W, C) until no side is longer than `longest`; pixels left over at the ends are dropped."""
    step = -(-max(image.shape[:2]) // longest)
    if step == 1:
        return image
    height, width = (max(1, side // step) for side in image.shape[:2])
    tall, wide = min(step, image.shape[0]), min(step, image.shape[1])
    blocks = image[: height * tall, : width * wide].reshape(height, tall, width, wide, image.shape[2])
    return blocks.mean((1, 3))


def plain_image(
    source: bpy.types.NodeSocket | None, outputs: tuple[str, ...] = ("Color",)
) -> bpy.types.Node | None:
    """The image texture node behind an output, if its image is still and flat over a UV map; else None."""
    while source is not None and source.node.type == "REROUTE":
        links = active_links(source.node.inputs[0])
        source = links[0].from_socket if links else None
    if source is None or source.node.bl_idname != "ShaderNodeTexImage" or source.name not in outputs:
        return None
    node = source.node
    flat = node.projection == "FLAT" and node.image and node.image.source in ("FILE", "GENERATED")
    return node if flat and is_encoded_usually(node.image) and _coordinates(node) else None


def _coordinates(node: bpy.types.Node) -> tuple[str, np.ndarray] | None:
    """The UV map and matrix that a texture node reads, or None if it reads something else."""
    matrix = np.eye(3)
    links = active_links(node.inputs["Vector"])
    while links:
        before, exit_ = links[0].from_node, links[0].from_socket
        if before.bl_idname == "ShaderNodeTexCoord" and exit_.name == "UV":
            return "", matrix
        if before.bl_idname == "ShaderNodeUVMap":
            return before.uv_map, matrix
        if before.type == "REROUTE":
            links = active_links(before.inputs[0])
        elif before.bl_idname == "ShaderNodeMapping" and (step := _mapping_matrix(before)) is not None:
            matrix = matrix @ step
            links = active_links(before.inputs["Vector"])
            if not links:
                return None
        else:
            return None
    return "", matrix


def _mapping_matrix(node: bpy.types.Node) -> np.ndarray | None:
    """The 3x3 matrix of a Mapping node in the plane; None if it is computed or turns out of the plane."""
    names = ("Location", "Rotation", "Scale")
    if node.vector_type != "POINT" or any(active_links(node.inputs[n]) for n in names):
        return None
    place, turn, size = (node.inputs[n].default_value for n in names)
    if turn[0] or turn[1]:
        return None
    c, s = np.cos(turn[2]), np.sin(turn[2])
    return np.array([[c * size[0], -s * size[1], place[0]], [s * size[0], c * size[1], place[1]], [0, 0, 1]])


def _upstream(source: bpy.types.NodeSocket) -> list[bpy.types.Node]:
    """All nodes that an output depends on."""
    upstream, pending = [], [source.node]
    while pending:
        node = pending.pop()
        if node not in upstream:
            upstream.append(node)
            pending += [link.from_node for entry in node.inputs for link in active_links(entry)]
    return upstream


def _reads_uv_only(source: bpy.types.NodeSocket) -> bool:
    """True if an output depends on nothing about the surface but its UVs."""
    for node in _upstream(source):
        if node.bl_idname == "ShaderNodeTexCoord":
            if any(s.is_linked for s in node.outputs if s.name != "UV"):
                return False
        elif node.bl_idname in _TEXTURES:
            place = node.inputs.get("Vector")  # textures of one dimension have none
            if place and not active_links(place):
                return False
        elif node.bl_idname not in _PURE or (
            node.bl_idname == "ShaderNodeTexImage" and node.projection != "FLAT"
        ):
            return False
    return True
