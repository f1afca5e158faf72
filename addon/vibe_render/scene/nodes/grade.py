# SPDX-License-Identifier: GPL-3.0-or-later
"""Vibe Grade: an owned compositor group before the output of the artist's own compositing.

In order, on linear colors c: bloom; c·2^Exposure; lift, midtone, gain; contrast around
middle gray, 0.18·(c/0.18)^Contrast; saturation around Rec.709 luma; hue; c^Gamma; vignette. The engine
has the same formulas in torch (proxy_renderer/render/film.py).
"""

from __future__ import annotations

import math

from bpy.types import Node, NodeSocket, NodeTree, Scene

from ...core import compat
from ...core.color import LUMA
from ...core.journal import Journal
from ...core.value_slots import LazySlot, ValueSlot, socket_slot
from . import owned
from .trails import active_links

NAME = "Vibe Grade"
_WHITE = (1.0, 1.0, 1.0)
_INPUTS: dict[str, tuple] = {  # name: identity, least, greatest
    "Glare": (0.0, 0.0, 1.0),
    "Exposure": (0.0, -10.0, 10.0),
    "Lift": (_WHITE,),
    "Midtone": (_WHITE,),
    "Gain": (_WHITE,),
    "Contrast": (1.0, 0.1, 4.0),
    "Saturation": (1.0, 0.0, 4.0),
    "Hue": (0.0, -math.pi, math.pi),
    "Gamma": (1.0, 0.1, 4.0),
    "Vignette": (0.0, 0.0, 1.0),
}
BLOOM = {"Highlights Threshold": 1.0, "Highlights Smoothness": 0.1, "Saturation": 1.0, "Size": 0.5}
"""The Glare node's settings, by socket identifier."""


def slot(scene: Scene, name: str) -> LazySlot | None:
    """An input of the scene's grade; None on a Blender that cannot have one (before 4.5)."""
    if not compat.HAS_IMAGE_COORDINATES:
        return None
    tree = compat.compositor(scene)

    def find() -> ValueSlot | None:
        nodes = owned.group_nodes(compat.compositor(scene), NAME)
        return socket_slot(nodes[0].inputs[name]) if nodes else None

    def make(journal: Journal) -> ValueSlot:
        chain(journal, scene)
        node_slot = find()
        assert node_slot
        return node_slot

    return LazySlot(find, make, _INPUTS[name][0], _lock(tree))


def cut_off(tree: NodeTree | None) -> bool:
    """Whether no picture reaches the output of a compositor, so that every render is black."""
    if tree is None:
        return False
    target = compat.compositor_output(tree)
    return target is None or not active_links(target)


def _lock(tree: NodeTree | None) -> str:
    if tree is None:
        return ""
    if tree.library:
        return f'the compositor tree "{tree.name}" is linked from another file'
    return "no picture reaches the output of the compositor" if cut_off(tree) else ""


def chain(journal: Journal, scene: Scene) -> Node:
    """Puts the grade before the output; makes the compositing of a scene that has none."""
    tree = compat.compositor(scene)
    if tree is None:
        tree = compat.start_compositor(journal, scene)
    tree = compat.own_compositor(journal, scene, tree)
    target = compat.compositor_output(tree)
    assert target
    node = owned.group_node(journal, tree, _group(journal), target.node)
    owned.insert(journal, active_links(target)[0].from_socket, node, "Image", target, "Image")
    return node


def _group(journal: Journal) -> NodeTree:
    tree, new = owned.group(journal, NAME, "CompositorNodeTree")
    if new:
        owned.socket(tree, "Image", "NodeSocketColor", (0.0, 0.0, 0.0, 1.0))
        for name, (identity, *ends) in _INPUTS.items():
            if ends:
                owned.socket(tree, name, "NodeSocketFloat", identity, *ends)
            else:
                owned.socket(tree, name, "NodeSocketColor", (*identity, 1.0))
        tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        _fill(tree)
    return tree


def _fill(tree: NodeTree) -> None:
    build = owned.Builder(tree)
    image, strength, exposure, lift, midtone, gain, contrast, saturation, hue, gamma, vignette = build.inputs(
        "Image", *_INPUTS
    )
    color = _bloom(build, image, strength)
    color = build.node("CompositorNodeExposure", Image=color, Exposure=exposure).outputs[0]
    color = _balance(build, color, lift, midtone, gain)
    color = _contrast(build, color, contrast)
    color = _saturation(build, color, saturation)
    turn = build.math("MULTIPLY_ADD", hue, 0.5 / math.pi, 0.5)
    color = build.node("CompositorNodeHueSat", Image=color, Hue=turn).outputs[0]
    color = _gamma(build, color, gamma)
    color = build.vector("SCALE", color, scale=_vignette(build, image, vignette))
    build.output(_with_alpha_of(build, color, image))


def _bloom(build: owned.Builder, image: NodeSocket, strength: NodeSocket) -> NodeSocket:
    node = build.node("CompositorNodeGlare", Image=image, Strength=strength)
    compat.set_option(node, "glare_type", "Type", "BLOOM", "Bloom")
    compat.set_option(node, "quality", "Quality", "HIGH", "High")
    for identifier, setting in BLOOM.items():
        _input(node, identifier).default_value = setting
    return node.outputs["Image"]


def _balance(
    build: owned.Builder, color: NodeSocket, lift: NodeSocket, midtone: NodeSocket, gain: NodeSocket
) -> NodeSocket:
    """max(((c − 1)·(2 − lift) + 1)·gain, 0) ^ (1 / midtone): the Color Balance node of Blender 5.

    Built of Vector Math nodes, for in Blender 4 that node does the same on the sRGB curve.
    """
    below_white = build.vector("SUBTRACT", color, _WHITE)
    lifted = build.vector(
        "MULTIPLY_ADD", below_white, build.vector("SUBTRACT", (2.0, 2.0, 2.0), lift), _WHITE
    )
    gained = build.vector("MAXIMUM", build.vector("MULTIPLY", lifted, gain), (0.0, 0.0, 0.0))
    return build.vector("POWER", gained, build.vector("DIVIDE", _WHITE, midtone))


def _contrast(build: owned.Builder, color: NodeSocket, contrast: NodeSocket) -> NodeSocket:
    stops = math.log2(1.0 / 0.18)
    color = build.node("CompositorNodeExposure", Image=color, Exposure=stops).outputs[0]
    color = _gamma(build, color, contrast)
    return build.node("CompositorNodeExposure", Image=color, Exposure=-stops).outputs[0]


def _gamma(build: owned.Builder, color: NodeSocket, gamma: NodeSocket) -> NodeSocket:
    node = build.node(compat.GAMMA_NODE)
    build.put(node.inputs[0], color)
    build.put(node.inputs["Gamma"], gamma)
    return node.outputs[0]


def _saturation(build: owned.Builder, color: NodeSocket, saturation: NodeSocket) -> NodeSocket:
    luma = build.vector("DOT_PRODUCT", color, LUMA)
    spread = build.vector("SCALE", build.vector("SUBTRACT", color, luma), scale=saturation)
    return build.vector("MAXIMUM", build.vector("ADD", luma, spread), (0.0, 0.0, 0.0))


def _vignette(build: owned.Builder, image: NodeSocket, vignette: NodeSocket) -> NodeSocket:
    """1 − Vignette·t²(3 − 2t), t from 0 at radius 0.3 to 1 at the corners."""
    place_ = build.node("CompositorNodeImageCoordinates", Image=image).outputs["Normalized"]
    centered = build.vector("MULTIPLY_ADD", place_, (2.0, 2.0, 0.0), (-1.0, -1.0, 0.0))
    radius = build.math("MULTIPLY", build.vector("LENGTH", centered), math.sqrt(0.5))
    t = build.math("MULTIPLY_ADD", radius, 1.0 / 0.7, -0.3 / 0.7, clamp=True)
    smooth = build.math("MULTIPLY", build.math("MULTIPLY", t, t), build.math("MULTIPLY_ADD", t, -2.0, 3.0))
    return build.math("SUBTRACT", 1.0, build.math("MULTIPLY", smooth, vignette))


def _with_alpha_of(build: owned.Builder, color: NodeSocket, image: NodeSocket) -> NodeSocket:
    alpha = build.node("CompositorNodeSeparateColor", Image=image).outputs["Alpha"]
    node = build.node("CompositorNodeSetAlpha", Image=color, Alpha=alpha)
    compat.set_option(node, "mode", "Type", "REPLACE_ALPHA", "Replace Alpha")
    return node.outputs[0]


def _input(node: Node, identifier: str) -> NodeSocket:
    return next(s for s in node.inputs if s.identifier == identifier)
