# SPDX-License-Identifier: GPL-3.0-or-later
"""Vibe Light Mix: a compositor group, added after Render Layers, that multiplies the passes of light groups by colors.

It adds (color - 1) times each pass to the image, so that light groups with the color white stay as rendered.
"""

from __future__ import annotations

from collections.abc import Mapping

from bpy.types import Node, NodeTree, Scene

from ...core import compat, rendered
from ...core.color import Color
from ...core.journal import Journal
from ...core.schema_import import schema
from . import owned

NAME = "Vibe Light Mix"
GUIDES = ("Denoising Albedo", "Denoising Normal")
PASS = "Combined_"  # followed by a light group's name: the name of the group's pass
_WHITE, _BLACK = (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)


def insert_mix(journal: Journal, scene: Scene, colors: Mapping[str, Color]) -> None:
    """Adds the mix after the Render Layers node, or changes the existing one; `colors`: light group -> color."""
    tree = compat.editable_compositor(journal, scene)
    layer = rendered.layer(scene)
    if scene.cycles.use_denoising and not layer.cycles.denoising_store_passes:
        journal.set(layer.cycles, "denoising_store_passes", True)
    layer.update_render_passes()
    source, node = _render_layers(tree, scene), next(iter(owned.group_nodes(tree, NAME)), None)
    if node is None:
        targets = [link.to_socket for link in source.outputs["Image"].links]
        node = owned.group_node(journal, tree, NAME, _declare, targets[0].node)
        for target in targets:
            journal.link(node.outputs["Image"], target)
        journal.link(source.outputs["Image"], node.inputs["Image"])
    elif node.mute:
        journal.set(node, "mute", False)
    inputs = node.node_tree.interface.items_tree
    colors = {name: color for name, color in colors.items() if color != _WHITE or name in inputs}
    for name in colors:
        if name not in inputs:
            owned.group_input(node.node_tree, name, (*_BLACK, 1.0))
            owned.group_input(node.node_tree, _color_of(name), (*_WHITE, 1.0))
    _fill(node.node_tree, scene.cycles.use_denoising)
    for name in (*colors, *(GUIDES if scene.cycles.use_denoising else ())):
        journal.link(source.outputs[name if name in GUIDES else PASS + name], node.inputs[name])
    for name, color in colors.items():
        journal.set(node.inputs[_color_of(name)], "default_value", (*color, 1.0))


def read_mix(scene: Scene) -> dict[str, Color]:
    """Light group -> color by which the scene's mix multiplies the group's pass; empty without a mix, or if muted."""
    found = {}
    for node in owned.group_nodes(compat.compositor(scene), NAME):
        for entry in node.inputs if not node.mute else ():
            if color := node.inputs.get(_color_of(entry.name)):
                red, green, blue, _ = color.default_value
                found[entry.name] = (red, green, blue)
    return found


def mute_mix(journal: Journal, scene: Scene) -> None:
    """Switches the mix off, if the scene has one."""
    for node in owned.group_nodes(compat.compositor(scene), NAME):
        if not node.mute:
            journal.set(node, "mute", True)


def denoise_node(tree: NodeTree) -> Node:
    """Adds and returns a Denoise node, not linked yet."""
    node = tree.nodes.new("CompositorNodeDenoise")
    compat.set_option(node, "prefilter", "Prefilter", "FAST", "Fast")
    return node


def _color_of(name: str) -> str:
    """The name of the mix's input for the color of a light group."""
    return f"{name} Color"


def _render_layers(tree: NodeTree, scene: Scene) -> Node:
    """The Render Layers node of the first rendered view layer; raises VibeError if its image is not used."""
    first = rendered.layer(scene).name
    for node in tree.nodes:
        here = node.bl_idname == "CompositorNodeRLayers" and node.scene in (None, scene)
        if here and node.layer == first and node.outputs["Image"].is_linked:
            return node
    message = f'The compositor does not use the image of the view layer "{first}".'
    raise schema.VibeError(message, "Link it to the output, or use Apply.")


def _declare(tree: NodeTree) -> None:
    owned.declare(tree, {"Image": (_BLACK,), "Denoising Albedo": (_BLACK,)}, "Image")
    owned.group_input(tree, "Denoising Normal", _BLACK)


def _fill(tree: NodeTree, denoised: bool) -> None:
    """Rebuilds the nodes inside the group for all its light groups; if `denoised`, denoises each pass first."""
    tree.nodes.clear()
    build = owned.Builder(tree)
    image, albedo, normal = build.inputs("Image", *GUIDES)
    inputs = [s.name for s in build.entry.outputs if s.name]
    mixed = image
    for name in inputs:
        if _color_of(name) not in inputs:
            continue
        light, color = build.inputs(name, _color_of(name))
        if denoised:
            node = build.add(denoise_node(tree))
            for target, given in (("Image", light), ("Albedo", albedo), ("Normal", normal)):
                build.put(node.inputs[target], given)
            light = node.outputs[0]
        mixed = build.vector("MULTIPLY_ADD", light, build.vector("SUBTRACT", color, _WHITE), mixed)
    build.output_with_alpha(build.vector("MAXIMUM", mixed, _BLACK), image)
