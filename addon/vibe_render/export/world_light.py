# SPDX-License-Identifier: GPL-3.0-or-later
"""The world as the engine gets it: one color, or environment images without tint, strength and rotation."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

import numpy as np
from bpy.types import NodeTree, World

from ..core import compat
from ..core.journal import Journal
from ..core.temporary import temporary
from ..render import bake
from ..scene.nodes import backgrounds, inputs
from .textures import image_colors, is_encoded_usually

_LIGHT = {"Is Diffuse Ray": 1.0, "Is Reflection Ray": 1.0, "Ray Depth": 1.0, "Diffuse Depth": 1.0}
"""Outputs of a Light Path node for rays from a matte surface to the world; all other outputs are 0."""


def pictures(world: World | None) -> tuple[np.ndarray | None, np.ndarray | None, str]:
    """The image of a world that lights the scene, the image that the camera sees, and a note ("" if exact).

    Images are (H, W, 3) float32 linear, in Blender's equirectangular mapping, not rotated; row 0 is straight down. A
    single texel stands for an even image, None for one color. The second image is also None if the camera sees the
    first.
    """
    if world is None:
        return None, None, ""
    parted = backgrounds.has_backdrop(world)
    backdrop = _backdrop(world) if parted else None
    if backgrounds.mixed_backgrounds(world):
        light, seen = _mix(world)
        return light, backdrop if parted else seen, ""
    single = backgrounds.single_background(world)
    color = single.entry("Color") if single else None
    origin = inputs.artists_origin(color) if color else None
    if origin is None or origin.source is None:
        return None, backdrop, ""
    node = origin.source.node
    plain = node.bl_idname == "ShaderNodeTexEnvironment" and node.projection == "EQUIRECTANGULAR"
    if plain and is_encoded_usually(node.image) and backgrounds.is_only_turned(world):
        image = image_colors(node.image)
        if image is None:
            return np.array([[[1.0, 0.0, 1.0]]], np.float32), backdrop, "the world's image is missing"
        return image, backdrop, ""
    # Of any other color, render a copy at strength 1, not rotated: the rotation is a separate parameter.
    twin, journal = _copy(world), Journal()
    if turn := backgrounds.rotation_slot(twin):
        turn.set(journal, 0.0)
    with temporary(twin, *bake.emit(twin.node_tree, origin, "Background", "World")), ExitStack() as stack:
        stack.callback(journal.undo)
        return _panorama(twin), backdrop, ""


def _backdrop(world: World) -> np.ndarray | None:
    """The image that only the camera sees, without tint and strength; None for one color or the lighting image."""
    single = [backgrounds.single_background(world, part) for part in (backgrounds.BACKDROP, backgrounds.LIGHT)]
    colors = [background.entry("Color") if background else None for background in single]
    seen, lights = (inputs.artists_origin(color) if color else None for color in colors)
    if seen and (seen.source is None or (lights and seen.source == lights.source)):
        return None
    with _untinted(world) as (twin, _):
        if copy := backgrounds.single_background(twin, backgrounds.BACKDROP):
            for link in copy.node.inputs["Strength"].links:
                copy.node.id_data.links.remove(link)
            copy.node.inputs["Strength"].default_value = 1.0
        return _panorama(twin)


def _mix(world: World) -> tuple[np.ndarray, np.ndarray | None]:
    """Image of the mixed Backgrounds as they light surfaces, and as the camera sees them (None if it is the same)."""
    with _untinted(world) as (twin, trees):
        seen = _panorama(twin)
        paths = [node for tree in trees for node in tree.nodes if node.type == "LIGHT_PATH"]
        if not paths:
            return seen, None
        # Replace the Light Path nodes by their outputs for rays from matte surfaces.
        for output in [each for node in paths for each in node.outputs if each.is_linked]:
            tree, targets = output.id_data, [link.to_socket for link in output.links]
            constant = tree.nodes.new("ShaderNodeValue").outputs[0]
            constant.default_value = _LIGHT.get(output.name, 0.0)
            for target in targets:
                tree.links.new(constant, target)
        return _panorama(twin), seen


def _panorama(world: World) -> np.ndarray:
    """A world's image, (512, 1024, 3); (1, 1, 3) if it is the same in all directions."""
    with bake.empty_scene(1024, 512) as scene:
        scene.world = world
        picture = bake.bake_panorama(scene, samples=8)
    even = float(np.ptp(picture, axis=(0, 1)).max()) < 1e-5 * float(picture.max())
    return picture[:1, :1] if even else picture


def _copy(world: World) -> World:
    twin = world.copy()
    compat.drop_action(twin.node_tree)
    twin.cycles.sampling_method = "NONE"  # no importance map, which can take minutes: the copy lights nothing
    return twin


@contextmanager
def _untinted(world: World) -> Iterator[tuple[World, list[NodeTree]]]:
    """Yields a temporary copy of a world, with neutral Vibe Tints and Factors and without volume, and its trees."""
    twin = _copy(world)
    tree = twin.node_tree
    for node in [n for n in tree.nodes if n.bl_idname == "ShaderNodeOutputWorld"]:
        for link in list(node.inputs["Volume"].links):
            tree.links.remove(link)
    trees = [tree, *compat.copy_groups(tree)]
    for tree in trees:
        inputs.neutralize(tree)
    with temporary(twin, *trees[1:]):
        yield twin, trees
