# SPDX-License-Identifier: GPL-3.0-or-later
"""Colors that node networks compute: read from images where possible, otherwise measured by a render."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from bpy.types import Image, Material, Node, NodeSocket, Scene
from mathutils import Color

from ..core.color import to_linear
from ..core.temporary import temporary
from ..render import bake
from ..scene.nodes.trails import ValueOrigin, active_links

_LONGEST = 1024  # pixels, longest side of a copied image
_VIEW = 96  # pixels, longer side of a render for a mean color

# Nodes whose result depends only on their inputs; those of `_TEXTURES` only if their Vector is linked.
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
    """The texture of a material's input."""

    image: np.ndarray  # (H, W, C) float32 linear, row 0 at the bottom
    extension: str = "REPEAT"  # "REPEAT", "EXTEND" or "CLIP"
    warning: str = ""  # a note on an approximation; "" for none
    # left, bottom, right and top in the camera's image, from 0 to 1; None for a texture over UVs
    window: tuple[float, float, float, float] | None = None
    # for a flat surface rendered straight on: the 2 x 4 matrix from world space to image coordinates in [0, 1]
    plane: list[list[float]] | None = None


def uv_mapping(source: NodeSocket | None) -> tuple[str, np.ndarray]:
    """The UV map that the texture behind `source` reads ("" for the active one), and its Mapping node's 3x3 matrix."""
    node = plain_image(source, ("Color", "Alpha"))
    if node is not None:
        return _coordinates(node) or ("", np.eye(3))
    maps = [n.uv_map for n in _upstream(source) if n.bl_idname == "ShaderNodeUVMap"] if source else []
    return (maps[0] if maps else ""), np.eye(3)


def uv_texture(material: Material, channel: str, origin: ValueOrigin) -> ExportedTexture | None:
    """The texture of an input that depends only on UVs: its image, or a bake of the unit square; None for other inputs."""
    source = origin.source
    assert source
    node = plain_image(source, ("Color", "Alpha") if channel == "alpha" else ("Color",))
    if node is None:
        if not _reads_uv_only(source):
            return None
        with bake.emitting(material, origin) as glowing:
            return ExportedTexture(bake.bake_uvs(glowing, 512))
    alpha = channel == "alpha" and source.name == "Alpha"
    image = image_alpha(node.image) if alpha else image_colors(node.image)
    if image is None:
        pink = np.array([[[1.0, 0.0, 1.0]]], np.float32)  # as Cycles shows it
        return ExportedTexture(pink, warning=f"The image {node.image.name!r} is missing")
    return ExportedTexture(image, {"MIRROR": "REPEAT"}.get(node.extension, node.extension))


def mean_color(scene: Scene, material: Material, origin: ValueOrigin, mask: np.ndarray) -> np.ndarray:
    """The mean linear color (3,) of a material's input, where `mask` (R, R) of the camera's image is True.

    A plain image is averaged as a whole; with an empty mask, so is the unit square of UVs.
    """
    assert origin.source
    plain = plain_image(origin.source)
    image = image_colors(plain.image) if plain else None
    if image is not None:
        return image.reshape(-1, 3).mean(0)
    with bake.emitting(material, origin) as glowing:
        if not mask.any():  # mirrors and bounced light may still show the material
            return bake.bake_uvs(glowing, _VIEW).mean((0, 1))
        view = bake.bake_view(scene, glowing, _VIEW)
    rows, columns = ((np.arange(len(mask)) + 0.5) / len(mask) * side for side in view.shape[:2])
    return view[rows.astype(int)][:, columns.astype(int)][mask].mean(0)


def image_colors(image: Image | None) -> np.ndarray | None:
    """A scene-linear copy of an image, (H, W, 3), at most 1024 pixels a side; None if its file is missing."""
    if image is None or not image.size[0] or not image.size[1]:
        return None
    colors = shrink(bake.image_pixels(image), _LONGEST)
    if image.is_float or image.colorspace_settings.is_data:
        return colors
    primaries = [Color(row).from_rec709_linear_to_scene_linear() for row in np.eye(3)]
    return (to_linear(colors) @ np.array(primaries)).astype(np.float32)


def is_encoded_usually(image: Image | None) -> bool:
    """True if an image's colors are float, data, or in the color space of new images, which is always sRGB."""
    # Names of color spaces depend on the OCIO configuration. Only Blender can decode all of them, by a render.
    if image is None or image.is_float:
        return True
    space = image.colorspace_settings
    if space.is_data or not space.name:  # Blender treats an unknown space as sRGB
        return True
    with temporary(bpy.data.images.new("Vibe Bake", 1, 1)) as fresh:
        return fresh.colorspace_settings.name == space.name


def image_alpha(image: Image | None) -> np.ndarray | None:
    """The alpha (H, W, 1) of an image, at most 1024 pixels a side; (1, 1, 1) if it has none, None if it is missing."""
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
    return image[: height * tall, : width * wide].reshape(height, tall, width, wide, -1).mean((1, 3))


def plain_image(source: NodeSocket | None, outputs: tuple[str, ...] = ("Color",)) -> Node | None:
    """The Image Texture node behind `source`, if it lays a still, decodable image flat over a UV map; else None.

    `outputs`: names of the node's outputs that `source` may come from.
    """
    while source is not None and source.node.type == "REROUTE":
        links = active_links(source.node.inputs[0])
        source = links[0].from_socket if links else None
    if source is None or source.node.bl_idname != "ShaderNodeTexImage" or source.name not in outputs:
        return None
    node = source.node
    flat = node.projection == "FLAT" and node.image and node.image.source in ("FILE", "GENERATED")
    return node if flat and is_encoded_usually(node.image) and _coordinates(node) else None


def _coordinates(node: Node) -> tuple[str, np.ndarray] | None:
    """The UV map of a texture node ("" for the active one), and its mapping matrix (3, 3); None without a UV map."""
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
        elif before.bl_idname == "ShaderNodeMapping" and before.vector_type == "POINT":
            links = active_links(before.inputs["Vector"])
            entries = [before.inputs[name] for name in ("Location", "Rotation", "Scale")]
            place, turn, size = (entry.default_value for entry in entries)
            # its values have to be constant, and its rotation about Z alone
            if any(map(active_links, entries)) or turn[0] or turn[1] or not links:
                return None
            c, s = np.cos(turn[2]), np.sin(turn[2])
            step = [[c * size[0], -s * size[1], place[0]], [s * size[0], c * size[1], place[1]], [0, 0, 1]]
            matrix = matrix @ np.array(step)
        else:
            return None
    return "", matrix


def _upstream(source: NodeSocket) -> list[Node]:
    """All nodes that an output depends on."""
    upstream, pending = [], [source.node]
    while pending:
        node = pending.pop()
        if node not in upstream:
            upstream.append(node)
            pending += [link.from_node for entry in node.inputs for link in active_links(entry)]
    return upstream


def _reads_uv_only(source: NodeSocket) -> bool:
    """True if an output depends only on the surface's UVs."""
    for node in _upstream(source):
        if node.bl_idname == "ShaderNodeTexCoord":
            if any(s.is_linked for s in node.outputs if s.name != "UV"):
                return False
        elif node.bl_idname in _TEXTURES:
            place = node.inputs.get("Vector")  # textures of one dimension have none
            if place and not active_links(place):
                return False
        elif node.bl_idname not in _PURE or (node.bl_idname == "ShaderNodeTexImage" and node.projection != "FLAT"):
            return False
    return True
