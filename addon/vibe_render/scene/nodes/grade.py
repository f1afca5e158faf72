# SPDX-License-Identifier: GPL-3.0-or-later
"""Vibe Grade: a compositor group that Vibe Render adds between the artist's own compositing and its output.

In order, on linear colors c: bloom; c·2^Exposure; lift, midtone, gain; contrast around
middle gray, 0.18·(c/0.18)^Contrast; saturation around Rec.709 luma; hue; c^Gamma; vignette. The engine
has the same formulas in torch (proxy_renderer/render/film.py).
"""

from __future__ import annotations

import math
from typing import Any

from bpy.types import NodeSocket, NodeTree, Scene

from ...core import compat
from ...core.color import LUMA
from ...core.journal import Journal
from ...core.value_slots import LazySlot, ValueSlot, socket_slot
from . import owned
from .trails import active_links

NAME = "Vibe Grade"
_WHITE = (1.0, 1.0, 1.0)
_INPUTS: owned.GroupInputs = {
    "Image": ((0.0, 0.0, 0.0),),
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


def graded(name: str, context: Any, scene: Scene) -> LazySlot:
    """The slot of input `name` of the scene's grade, which writing adds if it is missing. A locator, see `bindings`."""
    tree = compat.compositor(scene)

    def find() -> ValueSlot | None:
        nodes = owned.group_nodes(compat.compositor(scene), NAME)
        return socket_slot(nodes[0].inputs[name]) if nodes else None

    def make(journal: Journal) -> ValueSlot:
        """Adds the grade in front of the output; a scene without compositing gets a compositor tree first."""
        tree = compat.editable_compositor(journal, scene)
        target = compat.compositor_output(tree)
        assert target
        node = owned.group_node(journal, tree, NAME, _fill, target.node)
        journal.link(active_links(target)[0].from_socket, node.inputs["Image"])
        journal.link(node.outputs["Image"], target)
        return socket_slot(node.inputs[name])

    locked = ""
    if tree is not None and tree.library:
        locked = f'the compositor tree "{tree.name}" is linked from another file'
    elif cut_off(tree):
        locked = "no picture reaches the output of the compositor"
    return LazySlot(find, make, _INPUTS[name][0], locked)


def cut_off(tree: NodeTree | None) -> bool:
    """True if no image reaches the output of a compositor, so every render is black; False without a compositor."""
    if tree is None:
        return False
    target = compat.compositor_output(tree)
    return target is None or not active_links(target)


def _fill(tree: NodeTree) -> None:
    owned.declare(tree, _INPUTS, "Image")
    build = owned.Builder(tree)
    image, strength, exposure, lift, midtone, gain, contrast, saturation, hue, gamma, vignette = build.inputs(*_INPUTS)
    black, white, two = (0.0, 0.0, 0.0), _WHITE, (2.0, 2.0, 2.0)

    def exposed(color: NodeSocket, stops: NodeSocket | float) -> NodeSocket:
        return build.node("CompositorNodeExposure", Image=color, Exposure=stops).outputs[0]

    def to_power(color: NodeSocket, power: NodeSocket) -> NodeSocket:
        return build.node(compat.GAMMA_NODE, color, Gamma=power).outputs[0]

    # bloom
    glare = build.node("CompositorNodeGlare", Image=image, Strength=strength)
    compat.set_option(glare, "glare_type", "Type", "BLOOM", "Bloom")
    compat.set_option(glare, "quality", "Quality", "HIGH", "High")
    for identifier, setting in BLOOM.items():
        next(s for s in glare.inputs if s.identifier == identifier).default_value = setting
    color = exposed(glare.outputs["Image"], exposure)
    # max(((c − 1)·(2 − lift) + 1)·gain, 0) ^ (1 / midtone): the Color Balance node of Blender 5. Built from Vector Math
    # nodes, because the Color Balance node of Blender 4 applies the formula to sRGB-encoded values.
    below_white = build.vector("SUBTRACT", color, white)
    lifted = build.vector("MULTIPLY_ADD", below_white, build.vector("SUBTRACT", two, lift), white)
    gained = build.vector("MAXIMUM", build.vector("MULTIPLY", lifted, gain), black)
    color = build.vector("POWER", gained, build.vector("DIVIDE", white, midtone))
    # contrast around middle gray
    stops = math.log2(1.0 / 0.18)
    color = exposed(to_power(exposed(color, stops), contrast), -stops)
    # saturation, hue and gamma
    luma = build.vector("DOT_PRODUCT", color, LUMA)
    spread = build.vector("SCALE", build.vector("SUBTRACT", color, luma), Scale=saturation)
    color = build.vector("MAXIMUM", build.vector("ADD", luma, spread), black)
    turn = build.math("MULTIPLY_ADD", hue, 0.5 / math.pi, 0.5)
    color = to_power(build.node("CompositorNodeHueSat", Image=color, Hue=turn).outputs[0], gamma)
    # vignette: 1 − Vignette·t²(3 − 2t), t from 0 at radius 0.3 to 1 at the corners
    place = build.node("CompositorNodeImageCoordinates", Image=image).outputs["Normalized"]
    centered = build.vector("MULTIPLY_ADD", place, (2.0, 2.0, 0.0), (-1.0, -1.0, 0.0))
    radius = build.math("MULTIPLY", build.vector("LENGTH", centered), math.sqrt(0.5))
    t = build.math("MULTIPLY_ADD", radius, 1.0 / 0.7, -0.3 / 0.7, clamp=True)
    smooth = build.math("MULTIPLY", build.math("MULTIPLY", t, t), build.math("MULTIPLY_ADD", t, -2.0, 3.0))
    factor = build.math("SUBTRACT", 1.0, build.math("MULTIPLY", smooth, vignette))
    color = build.vector("SCALE", color, Scale=factor)
    build.output_with_alpha(color, image)
