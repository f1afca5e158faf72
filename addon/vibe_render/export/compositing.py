# SPDX-License-Identifier: GPL-3.0-or-later
"""The artist's compositor as a color table (LUT), if the output color of a pixel depends only on its input color."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Iterator
from pathlib import Path

import bpy
import numpy as np
from bpy.types import Image, Node, NodeTree, Scene

from ..core import compat, rendered
from ..core.schema_import import schema
from ..core.temporary import temporary
from ..render import bake
from ..scene.copies import copied_scene, viewer

SIZE = 33  # colors along each axis of the table
TABLE_TOE, TABLE_STOPS = schema.radiometry.TABLE_TOE, schema.radiometry.TABLE_STOPS
_SIDE = math.isqrt(SIZE**3 - 1) + 1  # pixels, of a square image with all colors of the table
_TOLERANCE = 0.02  # in units of `_in_stops`


def color_table(scene: Scene) -> np.ndarray | None:
    """Scene-linear colors after the compositor, (SIZE, SIZE, SIZE, 3), on the scale of `_in_stops`.

    The axes are the input's blue, green and red, evenly spaced on the same scale from 0 to TABLE_STOPS. None if the
    compositor leaves colors alone, and if no table can describe it: the result depends on a pixel's position or on its
    neighbors, or the compositor reads more than the image of the first rendered view layer.
    """
    if rendered.changing_compositor(scene) is None:
        return None
    axis = TABLE_TOE * (2 ** np.linspace(0.0, TABLE_STOPS, SIZE) - 1)
    blue, green, red = np.meshgrid(axis, axis, axis, indexing="ij")
    colors = np.zeros((_SIDE**2, 3), np.float32)
    colors[: SIZE**3] = np.stack((red, green, blue), -1).reshape(-1, 3)
    # The same colors at other pixels show whether the position matters.
    order = np.random.default_rng(0).permutation(len(colors))
    image = bpy.data.images.new("Vibe Colors", _SIDE, _SIDE, float_buffer=True, is_data=True)
    size = {"resolution_x": _SIDE, "resolution_y": _SIDE, "resolution_percentage": 100}
    with temporary(image), copied_scene(scene, graded=True, **size) as twin:
        layers = list(_layers(compat.compositor(twin)))
        if not all(_is_plain(node, twin) for node in layers):
            return None
        for node in layers:
            source = node.id_data.nodes.new("CompositorNodeImage")
            source.image = image
            for link in list(node.outputs["Image"].links):
                node.id_data.links.new(source.outputs["Image"], link.to_socket)
        straight, mixed = (_in_stops(_composited(twin, image, each)) for each in (colors, colors[order]))
    if np.abs(straight[order] - mixed).max() > _TOLERANCE:
        return None
    return straight[: SIZE**3].reshape(SIZE, SIZE, SIZE, 3)


def _layers(tree: NodeTree | None) -> Iterator[Node]:
    """The linked Render Layers nodes of a tree and its groups; also mutes Vibe Render's own grades."""
    for node in tree.nodes if tree else ():
        if node.bl_idname == "CompositorNodeRLayers" and any(s.is_linked for s in node.outputs):
            yield node
        elif node.type == "GROUP" and node.node_tree:
            node.mute = node.mute or rendered.MARK in node.node_tree
            yield from _layers(node.node_tree)


def _is_plain(node: Node, scene: Scene) -> bool:
    """True if a Render Layers node passes on only the image of the scene's first rendered view layer."""
    names = {socket.name for socket in node.outputs if socket.is_linked}
    return names == {"Image"} and node.scene in (None, scene) and node.layer == rendered.layer(scene).name


def _composited(twin: Scene, image: Image, colors: np.ndarray) -> np.ndarray:
    """The compositor's output for `image` filled with these colors: (N, 3) like the input, one color a pixel."""
    image.pixels.foreach_set(np.insert(colors, 3, 1.0, axis=1).ravel())
    image.update()
    with tempfile.TemporaryDirectory(prefix="vibe-") as folder, viewer(twin, lambda _: None):
        path = Path(folder) / "colors.exr"
        bake.render_file(twin, path, bake.LINEAR)
        return bake.read_file(path)[..., :3].reshape(-1, 3)


def _in_stops(colors: np.ndarray) -> np.ndarray:
    """Linear colors c of any shape as sign(c) · log2(|c| / TABLE_TOE + 1): stops, but 0 at black."""
    return np.sign(colors) * np.log2(np.abs(np.nan_to_num(colors)) / TABLE_TOE + 1)
