# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene is read as a render gets it, whatever else its render would do."""

import bpy
from vibe_render.scene import copies


def test_freestyle_lines_are_not_drawn_meanwhile():
    """They take Blender down where an engine draws nothing."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    scene = bpy.context.scene
    scene.render.use_freestyle = True
    assert copies.evaluate_render(scene, lambda graph: len(graph.object_instances)) == len(scene.objects)
    assert scene.render.use_freestyle
