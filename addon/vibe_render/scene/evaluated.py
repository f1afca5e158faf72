# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene exactly as a final render gets it: render-level modifiers, render visibility, instances.

Python can only ask for the viewport's version of a scene. A render engine is handed the other one,
so this module registers itself as a render engine for as long as it takes to read the scene.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import bpy

from . import scene_context
from .copies import copied_scene

T = TypeVar("T")

_SMALL = 32  # pixels; Blender refuses fewer than 16


def evaluate_render(scene: bpy.types.Scene, read: Callable[[bpy.types.Depsgraph], T]) -> T:
    """Calls `read` with the dependency graph of a final render of the current frame.

    Nothing is rendered, nothing in the file changes.

    Returns:
        What `read` returned.

    Raises:
        Exception: Whatever `read` raised.
    """
    results: list[T] = []
    errors: list[Exception] = []

    class Viewer(bpy.types.RenderEngine):
        bl_idname = "VIBE_VIEWER"
        bl_label = "Vibe Render (export)"

        def render(self, depsgraph: bpy.types.Depsgraph) -> None:
            try:
                results.append(read(depsgraph))
            except Exception as error:
                errors.append(error)

    bpy.utils.register_class(Viewer)
    try:
        with copied_scene(
            scene,
            engine=Viewer.bl_idname,
            resolution_percentage=100,
            resolution_x=_SMALL,
            resolution_y=_SMALL,
        ) as twin:
            bpy.ops.render.render(scene=twin.name, layer=scene_context.layer(twin).name)
    finally:
        bpy.utils.unregister_class(Viewer)
    if errors:
        raise errors[0]
    return results[0]
