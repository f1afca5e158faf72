# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts what the camera sees of a world from what lights: a Mix Shader by Is Camera Ray between two Backgrounds."""

from __future__ import annotations

from bpy.types import World

from ...core import compat
from ...core.journal import Journal
from . import backgrounds, owned
from .insets import artists
from .trails import active_links

_LEFT = 200.0  # from a node of ours to the next


def can_have_backdrop(world: World) -> bool:
    """Whether a world is one plain Background, in its own tree, that both lights and is seen."""
    tree = compat.node_tree(world)
    output = tree.get_output_node("ALL") if tree else None
    single = backgrounds.single_background(world)
    if output is None or single is None or backgrounds.has_backdrop(world):
        return False
    return not single.inside and bool(active_links(output.inputs["Surface"]))


def add_backdrop(journal: Journal, world: World) -> None:
    """Lets the camera see a Background of its own, which starts as the one that lights, without what we do to its color.

    Args:
        world: One that this is possible with.
    """
    single = backgrounds.single_background(world)
    tree = compat.node_tree(world)
    assert single
    assert tree
    output = tree.get_output_node("ALL")
    surface = output.inputs["Surface"]
    lighting = active_links(surface)[0].from_socket
    mix = journal.node(tree, "ShaderNodeMixShader", "Vibe Backdrop")
    owned.dress(journal, tree, mix, output)
    seen = journal.node(tree, "ShaderNodeBackground", "Vibe Backdrop Background")
    path = journal.node(tree, "ShaderNodeLightPath", "Vibe Backdrop Light Path")
    for node, rows in ((seen, 1), (path, -2)):
        node.parent, node.use_custom_color, node.color = mix.parent, True, owned.COLOR
        node.location = (mix.location.x - _LEFT, mix.location.y - rows * _LEFT)
    for name in ("Color", "Strength"):
        entry = single.entry(name)
        assert entry
        origin = artists(entry)
        if origin.source:
            journal.link(origin.source, seen.inputs[name])
        else:
            seen.inputs[name].default_value = origin.socket.default_value
    journal.link(path.outputs["Is Camera Ray"], mix.inputs[0])
    journal.link(lighting, mix.inputs[1])
    journal.link(seen.outputs[0], mix.inputs[2])
    journal.link(mix.outputs[0], surface)
