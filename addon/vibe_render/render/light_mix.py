# SPDX-License-Identifier: GPL-3.0-or-later
"""A light mix: the light layers of a render, each times a color, added up and graded without another render."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

import bpy
import numpy as np
from bpy.types import Image, Node, NodeTree, Scene

from ..core import compat, rendered
from ..core.compat import assign
from ..core.files import whole
from ..core.journal import Journal
from ..scene.copies import copied_scene
from ..scene.nodes import mix
from . import bake

_LITTLE = 1e-3
"""The share of all light below which what no layer has is rounding and the denoiser's, and not light."""
_LINEAR = {"media_type": "IMAGE", "file_format": "OPEN_EXR", "color_depth": "32", "color_mode": "RGBA"}
_COLORS = {"media_type": "IMAGE", "file_format": "PNG", "color_mode": "RGBA", "color_depth": "8"}


class LightMix:
    """The light layers of a render in memory. With all factors 1 the mix is that render.

    Attributes:
        layers: By the name of the light group, (H, W, 3) float32, scene-linear, row 0 at the bottom, without noise.
        rest: (H, W, 4) float32: what no layer has, and the alpha of the image.
    """

    def __init__(self, path: Path, view_layer: str, names: Sequence[str], size: tuple[int, int]) -> None:
        """Reads light groups of a file of `render_picture`, which has to stay; `size` is width and height."""
        self._path = path
        self.layers: dict[str, np.ndarray] = {}
        with _opened(path, size) as (scene, image):
            tree = compat.compositor(scene)
            assert tree
            source = _image_node(tree, image, view_layer)
            denoised = "Noisy Image" in source.outputs
            whole = _rendered(scene, source, "Combined")
            noisy = _rendered(scene, source, "Noisy Image") if denoised else whole
            unnamed = noisy[..., :3].copy()
            for name in names:
                unnamed -= _rendered(scene, source, mix.PASS + name)[..., :3]
                self.layers[name] = _rendered(scene, source, mix.PASS + name, denoised)[..., :3]
        self.rest = whole
        total = np.sum([*self.layers.values(), np.zeros_like(unnamed)], 0)
        if np.abs(unnamed).sum() < _LITTLE * np.abs(noisy[..., :3]).sum():
            # The denoiser makes each layer a little different from its share of the whole.
            share = np.divide(whole[..., :3], total, out=np.ones_like(total), where=total > 1e-6)
            for layer in self.layers.values():
                layer *= share
            total *= share
        self.rest[..., :3] -= total

    def mixed(self, factors: Mapping[str, Sequence[float]]) -> np.ndarray:
        """The sum of the layers times their factors, 1 without one: (H, W, 4) float32, scene-linear."""
        image = self.rest.copy()
        for name, layer in self.layers.items():
            image[..., :3] += layer * np.array(factors.get(name, (1.0, 1.0, 1.0)), np.float32)
        return np.maximum(image, 0.0, out=image)

    def write(self, scene: Scene, path: Path, factors: Mapping[str, Sequence[float]]) -> None:
        """Writes the mix as a PNG, through the scene's compositor and view transform. Nothing is rendered.

        Other passes that the compositor uses are those of the file. A mix of ours in it is left out.
        """
        height, width, _ = self.rest.shape
        image = bpy.data.images.new("Vibe Mix", width, height, alpha=True, float_buffer=True, is_data=True)
        size = {"resolution_x": width, "resolution_y": height, "resolution_percentage": 100}
        journal = Journal()
        passes = bpy.data.images.load(str(self._path))
        try:
            image.pixels.foreach_set(self.mixed(factors).ravel())
            with copied_scene(scene, graded=True, **size) as twin:
                try:
                    tree = compat.compositor(twin) or compat.start_compositor(journal, twin)
                    _feed(tree, image, passes, rendered.layer(scene).name)
                    _render(twin, path, _COLORS)
                finally:
                    journal.undo()
        finally:
            bpy.data.images.remove(image)
            bpy.data.images.remove(passes)


def _feed(tree: NodeTree, image: Image, passes: Image, first: str) -> None:
    """Puts images in the place of Render Layers nodes, `image` in that of the first view layer."""
    for node in list(tree.nodes):
        if node.type == "GROUP" and node.node_tree:
            node.mute = node.mute or node.node_tree.get(rendered.MARK) == mix.NAME
            _feed(node.node_tree, image, passes, first)
        if node.bl_idname != "CompositorNodeRLayers":
            continue
        for output in [each for each in node.outputs if each.is_linked]:
            name = "Combined" if output.name == "Image" else output.name
            is_mixed = name == "Combined" and node.layer == first
            given = _image_node(tree, image) if is_mixed else _image_node(tree, passes, node.layer)
            source = given.outputs.get("Image" if is_mixed else name)
            for link in list(output.links) if source else ():
                tree.links.new(source, link.to_socket)
        tree.nodes.remove(node)


def _image_node(tree: NodeTree, image: Image, view_layer: str = "") -> Node:
    node = tree.nodes.new("CompositorNodeImage")
    node.image = image
    if view_layer:
        with contextlib.suppress(TypeError):  # a layer of another scene, which the file does not have
            node.layer = view_layer
    return node


@contextmanager
def _opened(path: Path, size: tuple[int, int]) -> Iterator[tuple[Scene, Image]]:
    """A scene with nothing but a compositor, and an image of a file; both removed afterwards."""
    journal, scene = Journal(), bpy.data.scenes.new("Vibe Mix")
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    image = bpy.data.images.load(str(path))
    try:
        tree = compat.start_compositor(journal, scene)
        for node in [n for n in tree.nodes if n.bl_idname == "CompositorNodeRLayers"]:
            tree.nodes.remove(node)
        yield scene, image
    finally:
        journal.undo()
        bpy.data.scenes.remove(scene)
        bpy.data.images.remove(image)


def _rendered(scene: Scene, source: Node, name: str, denoised: bool = False) -> np.ndarray:
    """A pass of an Image node: (H, W, 4) float32."""
    tree = source.id_data
    target, output = compat.compositor_output(tree), source.outputs[name]
    assert target
    if denoised:
        node = mix.denoise_node(tree)
        for guide in ("Albedo", "Normal"):
            tree.links.new(source.outputs[f"Denoising {guide}"], node.inputs[guide])
        tree.links.new(output, node.inputs["Image"])
        output = node.outputs[0]
    tree.links.new(output, target)
    path = Path(bpy.app.tempdir) / "vibe-pass.exr"
    try:
        _render(scene, path, _LINEAR)
        return bake.read_file(path)
    finally:
        path.unlink(missing_ok=True)


def _render(scene: Scene, path: Path, kind: Mapping[str, str]) -> None:
    """Renders a compositor that needs no scene to a file, atomically."""
    assign(scene.render.image_settings, **kind)
    with whole(path) as part:
        assign(scene.render, use_overwrite=True, use_file_extension=True, filepath=str(part))
        bpy.ops.render.render(scene=scene.name, write_still=True)
