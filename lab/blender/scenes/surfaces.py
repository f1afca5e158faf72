# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials of the measured scenes, with textures that are pictures or networks of nodes."""

from __future__ import annotations

import random
from collections.abc import Callable

import bpy
import numpy as np
from bpy.types import Material, NodeSocket, NodeTree
from vibe_render.core import compat
from vibe_render.core.color import Color

from lab.blender.scenes.recipe import FinishRecipe

TextureBuilder = Callable[[NodeTree, Color], NodeSocket]


def material(name: str, finish: FinishRecipe, chance: random.Random) -> Material:
    """A Principled material.

    Args:
        chance: Shifts its color a little.
    """
    new_material = bpy.data.materials.new(name)
    tree = compat.enable_nodes(new_material)
    shader = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled")
    color = shifted(finish.color, chance)
    shader.inputs["Base Color"].default_value = (*color, 1.0)
    shader.inputs["Roughness"].default_value = finish.roughness
    for socket, value in finish.inputs.items():
        shader.inputs[socket].default_value = (*value, 1.0) if isinstance(value, tuple) else value
    if finish.texture == "cut-out":
        _cut_out(tree, shader)
    elif finish.texture:
        tree.links.new(TEXTURES[finish.texture](tree, color), shader.inputs["Base Color"])
    if finish.texture == "worn":
        _worn(tree, shader)
    return new_material


def shifted(color: Color, chance: random.Random, by: float = 0.15) -> Color:
    """A color whose components are each a little darker or lighter; black stays.

    Args:
        by: The largest share of a component.
    """
    return tuple(min(max(c * chance.uniform(1 - by, 1 + by), 0.0), max(c, 0.95)) for c in color)  # type: ignore[return-value]


def picture(name: str, pixels: np.ndarray) -> bpy.types.Image:
    """A packed image.

    Args:
        pixels: (H, W, 3 or 4), sRGB-encoded, row 0 at the bottom.
    """
    height, width, channels = pixels.shape
    new_image = bpy.data.images.new(name, width, height, alpha=channels == 4)
    if channels == 3:
        pixels = np.concatenate([pixels, np.ones((height, width, 1))], -1)
    new_image.pixels.foreach_set(np.clip(pixels, 0, 1).astype(np.float32).ravel())
    new_image.pack()
    return new_image


def _square(side: int) -> tuple[np.ndarray, np.ndarray]:
    """u and v (side, side) in [0, 1), v upwards."""
    line = (np.arange(side) + 0.5) / side
    v, u = np.meshgrid(line, line, indexing="ij")
    return u, v


def _image(tree: NodeTree, name: str, pixels: np.ndarray) -> bpy.types.Node:
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = picture(name, pixels)
    return node


def _map(tree: NodeTree, _: Color) -> NodeSocket:
    """Land and sea of a few waves."""
    u, v = _square(256)
    u = 2 * np.pi * u
    waves = np.sin(2 * u + 5 * v) + np.sin(3 * u - 7 * v + 1) + 0.6 * np.sin(5 * u + 13 * v) + 0.4 * np.sin(9 * u)
    land = 1 / (1 + np.exp(-12 * (waves - 0.4)))[..., None]
    return _image(tree, "Map", land * (0.78, 0.68, 0.4) + (1 - land) * (0.15, 0.4, 0.62)).outputs["Color"]


def _weave(tree: NodeTree, color: Color) -> NodeSocket:
    """A tartan in the color, repeated three times."""
    u, v = _square(128)
    warp, weft = (0.5 + 0.5 * np.sign(np.sin(2 * np.pi * (2 * x + 0.3 * np.sin(6.3 * x)))) for x in (u, v))
    base = np.array(color) ** (1 / 2.2)
    cloth = 0.25 + 0.75 * (0.5 * warp + 0.5 * weft)[..., None] * base
    cloth[np.abs(u - 0.7) < 0.03] = (0.9, 0.85, 0.6)
    node = _image(tree, "Weave", cloth)
    spread = tree.nodes.new("ShaderNodeMapping")
    spread.inputs["Scale"].default_value = (3.0, 3.0, 1.0)
    place = tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(place.outputs["UV"], spread.inputs["Vector"])
    tree.links.new(spread.outputs["Vector"], node.inputs["Vector"])
    return node.outputs["Color"]


def _crate(tree: NodeTree, color: Color) -> NodeSocket:
    """Planks with a frame."""
    u, v = _square(128)
    plank = 0.75 + 0.15 * np.sin(40 * v + 3 * np.sin(5 * u)) + 0.1 * np.floor(5 * u) % 0.2
    frame = (np.minimum(np.minimum(u, 1 - u), np.minimum(v, 1 - v)) < 0.1) | (np.abs(u - v) < 0.06)
    wood = np.where(frame[..., None], 1.25, 1.0) * plank[..., None] * np.array(color) ** (1 / 2.2)
    return _image(tree, "Crate", wood).outputs["Color"]


def _cut_out(tree: NodeTree, shader: bpy.types.Node) -> None:
    """Holes by the picture's alpha."""
    u, v = _square(256)
    near = np.hypot((6 * u) % 1 - 0.5, (6 * v) % 1 - 0.5)
    color = np.stack([0.2 + 0.7 * u, 0.45 + 0.3 * v, 0.35 + 0 * u, (near > 0.3).astype(float)], -1)
    node = _image(tree, "Cut-Out", color)
    tree.links.new(node.outputs["Color"], shader.inputs["Base Color"])
    tree.links.new(node.outputs["Alpha"], shader.inputs["Alpha"])


def _node(tree: NodeTree, kind: str, vector: str, **inputs: float | Color) -> bpy.types.Node:
    """A texture node that reads these coordinates."""
    node, place = tree.nodes.new(kind), tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(place.outputs[vector], node.inputs["Vector"])
    for name, value in inputs.items():
        node.inputs[name].default_value = (*value, 1.0) if isinstance(value, tuple) else value
    return node


def _ramp(tree: NodeTree, value: NodeSocket, *stops: tuple[float, Color]) -> NodeSocket:
    ramp = tree.nodes.new("ShaderNodeValToRGB")
    tree.links.new(value, ramp.inputs["Fac"])
    points = ramp.color_ramp.elements
    while len(points) < len(stops):
        points.new(0.5)
    for point, (place, color) in zip(points, sorted(stops), strict=True):
        point.position, point.color = place, (*color, 1.0)
    return ramp.outputs["Color"]


def _dark(color: Color, by: float) -> Color:
    r, g, b = color
    return (r * by, g * by, b * by)


def _marble(tree: NodeTree, color: Color) -> NodeSocket:
    """Veins: a wave bent by noise, in object space."""
    wave = _node(tree, "ShaderNodeTexWave", "Object", Scale=1.1, Distortion=9.0, Detail=4.0)
    return _ramp(tree, wave.outputs["Color"], (0.0, _dark(color, 0.15)), (0.25, _dark(color, 0.7)), (1.0, color))


def _wood(tree: NodeTree, color: Color) -> NodeSocket:
    """Rings along z, in generated coordinates."""
    wave = _node(tree, "ShaderNodeTexWave", "Generated", Scale=3.0, Distortion=4.0, Detail=3.0)
    wave.wave_type = "RINGS"
    return _ramp(tree, wave.outputs["Color"], (0.0, _dark(color, 0.4)), (1.0, color))


def _checker(tree: NodeTree, color: Color) -> NodeSocket:
    """A board of squares, in object space."""
    return _node(tree, "ShaderNodeTexChecker", "Object", Scale=1.5, Color1=color, Color2=_dark(color, 0.2)).outputs[
        "Color"
    ]


def _brick(tree: NodeTree, color: Color) -> NodeSocket:
    """A wall, over the UVs."""
    node = _node(
        tree, "ShaderNodeTexBrick", "UV", Color1=color, Color2=_dark(color, 0.55), Mortar=(0.5, 0.48, 0.45), Scale=6.0
    )
    return node.outputs["Color"]


def _speckles(tree: NodeTree, color: Color) -> NodeSocket:
    """Cells of granite, in generated coordinates."""
    cells = _node(tree, "ShaderNodeTexVoronoi", "Generated", Scale=22.0)
    return _ramp(tree, cells.outputs["Distance"], (0.1, _dark(color, 0.25)), (0.5, color))


def _worn(tree: NodeTree, shader: bpy.types.Node) -> None:
    """Roughness and metallic from a noise: paint worn off metal."""
    noise = _node(tree, "ShaderNodeTexNoise", "Object", Scale=2.5, Detail=4.0)
    mask = _ramp(tree, noise.outputs["Fac"], (0.46, (0.0, 0.0, 0.0)), (0.54, (1.0, 1.0, 1.0)))
    tree.links.new(mask, shader.inputs["Metallic"])
    tree.links.new(
        _ramp(tree, noise.outputs["Fac"], (0.3, (0.6, 0.6, 0.6)), (0.6, (0.2, 0.2, 0.2))), shader.inputs["Roughness"]
    )


def _paint(tree: NodeTree, color: Color) -> NodeSocket:
    """The same noise as that of `_worn`: paint where it is low, metal where it is high."""
    noise = _node(tree, "ShaderNodeTexNoise", "Object", Scale=2.5, Detail=4.0)
    return _ramp(tree, noise.outputs["Fac"], (0.46, color), (0.54, (0.7, 0.68, 0.65)))


TEXTURES: dict[str, TextureBuilder] = {
    "map": _map,
    "weave": _weave,
    "crate": _crate,
    "marble": _marble,
    "wood": _wood,
    "checker": _checker,
    "brick": _brick,
    "speckles": _speckles,
    "worn": _paint,
}
