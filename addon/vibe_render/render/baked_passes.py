# SPDX-License-Identifier: GPL-3.0-or-later
"""Baked passes: the values of node networks at every pixel of the camera's picture, from one Cycles render.

Each computed input of a material is sent to an AOV output for a moment, so every network that Cycles knows arrives,
wherever it gets its coordinates from, for all materials at once.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass

import bpy
import numpy as np

from ..core.compat import changed
from ..scene import scene_context
from ..scene.copies import copied_scene
from ..scene.nodes.trails import ValueOrigin
from . import exr
from .planar_captures import CapturePlane, straight_on

COLORS = ("base_color", "emission_color", "specular_tint", "normal")
"""Channels of three components, with "color0", "color1" …; the others have one.

Normals are in world space, halved and raised to [0, 1].
"""

_LONGEST = 512
_SAMPLES = 4
_FAR_SIDE, _FAR_SAMPLES = 384, 2  # what only mirrors show need not be as fine
_GROWN = 4  # pixels by which a map reaches beyond where its material is seen
_INDEX, _SQUARE = "Vibe Index", "Vibe Square"


@dataclass(frozen=True)
class PassRequest:
    """A computed input to bake: its material, its channel, and where it is computed.

    `origin` is None for the normal that Displacement makes where it is rendered as bump.
    """

    material: bpy.types.Material
    channel: str
    origin: ValueOrigin | None


@dataclass(frozen=True)
class BakedPicture:
    """A computed input where the camera sees its material.

    Attributes:
        image: (h, w, C) float32 linear, row 0 at the bottom.
        window: Left, bottom, right and top of the image in parts of the picture.
        mean: (C,) over the pixels that show nothing else.
    """

    image: np.ndarray
    window: tuple[float, float, float, float]
    mean: np.ndarray


def measure(
    scene: bpy.types.Scene, wanted: Sequence[PassRequest], plane: CapturePlane | None = None
) -> dict[tuple[str, str], BakedPicture]:
    """Bakes computed inputs with one render.

    Args:
        plane: Captured straight on, instead of what the scene's camera sees.

    Returns:
        By full name of the material and channel; without inputs that the camera does not see, and without
        materials of linked libraries.
    """
    wanted = [w for w in wanted if _editable(w)]
    if not wanted:
        return {}
    names = list(dict.fromkeys(w.material.name_full for w in wanted))
    sides = (_FAR_SIDE, _FAR_SIDE) if plane else (scene.render.resolution_x, scene.render.resolution_y)
    scale = min(1.0, _LONGEST / max(sides))
    width, height = (max(16, round(scale * side)) for side in sides)  # Blender refuses fewer
    with ExitStack() as stack:
        for w in _once(wanted):
            stack.enter_context(_sent(w, f"Vibe {w.channel}"))
        for number, name in enumerate(names, 1):
            material = next(w.material for w in wanted if w.material.name_full == name)
            stack.enter_context(_marked(material, float(number)))
        twin = stack.enter_context(
            copied_scene(
                scene,
                resolution_x=width,
                resolution_y=height,
                resolution_percentage=100,
                film_transparent=False,
            )
        )
        if plane:
            stack.enter_context(straight_on(twin, plane))
        channels = sorted({w.channel for w in wanted})
        passes = _render(twin, channels, _FAR_SAMPLES if plane else _SAMPLES)
    index, square = passes[_INDEX][..., 0], passes[_SQUARE][..., 0]
    alone = np.abs(square - index * index) < 1e-3 * (1 + square)
    baked = {}
    for w in wanted:
        number = names.index(w.material.name_full) + 1
        shown = alone & (np.abs(index - number) < 1e-3)
        values = passes[f"Vibe {w.channel}"][..., : 3 if _is_color(w.channel) else 1]
        if shown.any():
            baked[w.material.name_full, w.channel] = _cropped(values, shown)
    return baked


def _is_color(channel: str) -> bool:
    return channel in COLORS or channel.startswith("color")


def _editable(w: PassRequest) -> bool:
    """Whether nodes can be added where the value is computed."""
    tree = _tree(w)
    return w.material.library is None and tree.library is None and tree.override_library is None


def _once(wanted: Sequence[PassRequest]) -> list[PassRequest]:
    """What has to be sent: materials may share a node group, and outputs of one name would add up."""
    places = {(_tree(w).as_pointer(), w.channel): w for w in wanted}
    return list(places.values())


def _tree(w: PassRequest) -> bpy.types.NodeTree:
    """Where a value is computed."""
    return w.origin.socket.id_data if w.origin else w.material.node_tree


def _render(twin: bpy.types.Scene, channels: Sequence[str], samples: int) -> dict[str, np.ndarray]:
    """All AOVs; lamps, worlds and fog are left out as far as a scene's own settings can."""
    layer, cycles = scene_context.layer(twin), twin.cycles
    twin.world = None
    twin.render.engine = "CYCLES"
    for name in (*channels, _INDEX, _SQUARE):
        aov = layer.aovs.add()
        aov.name = name if name in (_INDEX, _SQUARE) else f"Vibe {name}"
        aov.type = "COLOR" if _is_color(name) else "VALUE"
    with (
        changed(
            cycles,
            device="CPU",
            samples=samples,
            use_denoising=False,
            use_adaptive_sampling=False,
            max_bounces=0,
            light_sampling_threshold=1.0,
            volume_max_steps=2,
            pixel_filter_type="BOX",
            time_limit=0.0,
        ),
        changed(layer, pass_alpha_threshold=0.0, material_override=None),
    ):
        return exr.passes_of(twin)


@contextmanager
def _sent(w: PassRequest, name: str) -> Iterator[None]:
    """An AOV output for a value, in the tree that computes it."""
    tree = _tree(w)
    added = []
    try:
        output = tree.nodes.new("ShaderNodeOutputAOV")
        added.append(output)
        output.aov_name = name
        source = w.origin.source if w.origin else None
        if w.channel == "normal":
            if source is None:
                added.append(tree.nodes.new("ShaderNodeNewGeometry"))
                source = added[-1].outputs["Normal"]
            half = tree.nodes.new("ShaderNodeVectorMath")
            added.append(half)
            half.operation = "MULTIPLY_ADD"  # AOVs lose what is negative
            half.inputs[1].default_value = half.inputs[2].default_value = (0.5, 0.5, 0.5)
            tree.links.new(source, half.inputs[0])
            source = half.outputs[0]
        tree.links.new(source, output.inputs["Color" if _is_color(w.channel) else "Value"])
        yield
    finally:
        for node in added:
            tree.nodes.remove(node)


@contextmanager
def _marked(material: bpy.types.Material, number: float) -> Iterator[None]:
    """AOV outputs that tell where a material is seen, and where it is seen alone."""
    nodes = material.node_tree.nodes
    added = []
    try:
        for name, value in ((_INDEX, number), (_SQUARE, number * number)):
            added.append(nodes.new("ShaderNodeOutputAOV"))
            added[-1].aov_name = name
            added[-1].inputs["Value"].default_value = value
        yield
    finally:
        for node in added:
            nodes.remove(node)


def _cropped(values: np.ndarray, shown: np.ndarray) -> BakedPicture:
    """The part of a picture (H, W, C) where a material is shown, grown a little over its edges."""
    height, width = shown.shape
    rows, columns = shown.any(1).nonzero()[0], shown.any(0).nonzero()[0]
    bottom, top = max(0, rows[0] - _GROWN), min(height, rows[-1] + 1 + _GROWN)
    left, right = max(0, columns[0] - _GROWN), min(width, columns[-1] + 1 + _GROWN)
    part, covered = values[bottom:top, left:right], shown[bottom:top, left:right]
    mean = part[covered].mean(0)
    image = _grown(part, covered, mean)
    window = (left / width, bottom / height, right / width, top / height)
    return BakedPicture(image.astype(np.float32), window, mean)


def _grown(values: np.ndarray, covered: np.ndarray, rest: np.ndarray) -> np.ndarray:
    """Fills unknown pixels (h, w, C) with the mean of known neighbors, from the edges outwards."""
    values = np.where(covered[..., None], values, 0.0)
    for _ in range(_GROWN):
        total, count = np.zeros_like(values), np.zeros(covered.shape)
        padded = np.pad(values, ((1, 1), (1, 1), (0, 0))), np.pad(covered, 1)
        for dy in range(3):
            for dx in range(3):
                place = slice(dy, dy + covered.shape[0]), slice(dx, dx + covered.shape[1])
                total += padded[0][place] * padded[1][place][..., None]
                count += padded[1][place]
        fresh = ~covered & (count > 0)
        values[fresh] = total[fresh] / count[fresh][:, None]
        covered = covered | fresh
    return np.where(covered[..., None], values, rest)
