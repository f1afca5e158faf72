# SPDX-License-Identifier: GPL-3.0-or-later
"""A picture without the fog, as fog is measured by what it takes away."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path

import bpy
from vibe_render.core import compat
from vibe_render.core.compat import changed
from vibe_render.render.final_render import is_fog, render_picture


def render_clear(scene: bpy.types.Scene, path: Path, size: int, samples: int, seed: int = 0) -> None:
    """Renders the scene as `render` does, but without the fog in it. Arguments as for `render`."""
    with ExitStack() as stack:
        for thing in scene.objects:
            if thing.type == "VOLUME" or is_fog(thing):
                stack.enter_context(changed(thing, hide_render=True))
        tree = compat.node_tree(scene.world) if scene.world else None
        for node in tree.nodes if tree else ():
            if node.bl_idname.startswith("ShaderNodeVolume"):
                stack.enter_context(changed(node, mute=True))
        render_picture(scene, path, size, samples, seed)
