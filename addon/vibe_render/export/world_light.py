# SPDX-License-Identifier: GPL-3.0-or-later
"""The world as the engine sees it: one color, or an environment picture without tint, strength and turn."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import bpy
import numpy as np

from ..render import bake
from ..scene.nodes import shaders, tint
from ..scene.nodes.trails import active_links
from .textures import image_colors

_HEIGHT = 256
_SAMPLES = 32


def environment(world: bpy.types.World | None) -> tuple[np.ndarray | None, str]:
    """The world's environment picture (None for one color), and a note about what is approximated.

    Returns:
        (H, 2H, 3) float32 linear, laid out as Blender's equirectangular mapping without rotation, row
        0 straight down; None for a world of one color. And a warning, or "".
    """
    background = shaders.background(world) if world else None
    if world is None or background is None:
        return None, ""
    color = background.entry("Color")
    source = tint.untinted(color).source if color else None
    if source is None:
        return None, _mixed(world, background.node)
    node = source.node
    if node.bl_idname == "ShaderNodeTexEnvironment" and node.projection == "EQUIRECTANGULAR":
        image = image_colors(node.image)
        if image is None:
            return np.array([[[1.0, 0.0, 1.0]]], np.float32), "the world's image is missing"
        return image, _mixed(world, background.node)
    if source.id_data != world.node_tree:
        return None, "the world's color is computed inside a node group and is shown as one color"
    with _plain(world, source) as twin:
        return bake.panorama_of(twin, _HEIGHT, _SAMPLES), _mixed(world, background.node)


def _mixed(world: bpy.types.World, background: bpy.types.Node) -> str:
    tree = world.node_tree
    output = tree.get_output_node("ALL") if tree else None
    links = active_links(output.inputs["Surface"]) if output else []
    straight = not links or links[0].from_node == background or background.id_data != tree
    return "" if straight else "the world's mix of backgrounds is shown as its first one"


@contextmanager
def _plain(world: bpy.types.World, source: bpy.types.NodeSocket) -> Iterator[bpy.types.World]:
    """A copy of a world that shows what an output gives, unturned, at strength 1; removed afterwards."""
    twin = world.copy()
    twin.cycles.sampling_method = "NONE"  # it lights nothing, and a map of its light can take minutes
    tree = twin.node_tree
    exit_ = next(s for s in tree.nodes[source.node.name].outputs if s.identifier == source.identifier)
    background = tree.nodes.new("ShaderNodeBackground")
    tree.links.new(exit_, background.inputs["Color"])
    for node in tree.nodes:
        if node.bl_idname == "ShaderNodeMapping":  # the turn is a parameter of its own
            node.inputs["Rotation"].default_value[2] = 0.0
        if node.bl_idname == "ShaderNodeOutputWorld":
            for link in [link for entry in node.inputs for link in entry.links]:
                tree.links.remove(link)
            tree.links.new(background.outputs["Background"], node.inputs["Surface"])
    try:
        yield twin
    finally:
        bpy.data.worlds.remove(twin)
