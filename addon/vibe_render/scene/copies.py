# SPDX-License-Identifier: GPL-3.0-or-later
"""Copies of a scene for renders of ours: the artist's settings, some of which Blender cannot put back, stay untouched."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import Any

import bpy

from ..core import compat
from ..core.compat import changed

_COARSE_LIGHT = {"sampling_method": "MANUAL", "sample_map_resolution": 512}
"""A map of a world's light that is computed in a moment. Cycles' own choice may take a minute for stars of noise."""


@contextmanager
def copied_scene(scene: bpy.types.Scene, graded: bool = False, **render: Any) -> Iterator[bpy.types.Scene]:
    """A copy of the scene that shares its objects; removed after the block.

    Output, passes and the picture of a render belong to a scene: those of the artist are left alone this way. The
    sequencer, borders and stereo are off.

    Args:
        scene: The artist's; left as it is.
        graded: Keep the compositor; its File Output nodes write nothing. Otherwise it is left out.
        **render: Settings of the copy's `render`.
    """
    with ExitStack() as stack:
        twin = scene.copy()
        stack.callback(bpy.data.scenes.remove, twin)
        twin.name = "Vibe Bake"
        if graded:
            for tree in compat.separate_compositor(twin, scene):
                stack.callback(bpy.data.node_groups.remove, tree)
        else:
            compat.drop_compositor(twin)
            render = {
                "use_freestyle": False,
                **render,
            }  # lines cost time, and crash an engine that draws nothing
        settings = {"use_sequencer": False, "use_border": False, "use_multiview": False, **render}
        for name, value in settings.items():
            setattr(twin.render, name, value)
        if scene.world and _is_computed(scene.world):
            stack.enter_context(changed(scene.world.cycles, **_COARSE_LIGHT))
        yield twin


def _is_computed(world: bpy.types.World) -> bool:
    """Whether nodes without a picture give a world's light, and Cycles decides how finely it is sampled."""
    tree = compat.node_tree(world)
    pictures = any(node.bl_idname == "ShaderNodeTexEnvironment" for node in tree.nodes) if tree else True
    return world.is_editable and not pictures and world.cycles.sampling_method == "AUTOMATIC"
