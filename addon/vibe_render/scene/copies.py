# SPDX-License-Identifier: GPL-3.0-or-later
"""Copies of a scene for the add-on's own renders, because Blender cannot restore all settings of the original."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from typing import Any, TypeVar

import bpy
from bpy.types import Depsgraph, Scene

from ..core import compat, rendered
from ..core.compat import changed

T = TypeVar("T")


@contextmanager
def copied_scene(
    scene: Scene, graded: bool = False, size: tuple[int, int] | None = None, **render: Any
) -> Iterator[Scene]:
    """Yields a copy of the scene that shares its objects, but has its own output and passes; removed after the block.

    Sequencer, borders and stereo are off. `size`: width and height in pixels; `render`: values of `scene.render`. A
    `graded` copy keeps film exposure and compositor, but its File Output nodes write nothing. Other copies lack both.
    """
    with ExitStack() as stack:
        twin = scene.copy()
        stack.callback(bpy.data.scenes.remove, twin)
        twin.name = "Vibe Bake"
        for key in [key for key in twin.keys() if key.startswith("vibe_")]:  # noqa: SIM118  no dict
            del twin[key]  # it refers to data-blocks, which Freestyle lines would keep in use forever
        if graded:
            for tree in compat.separate_compositor(twin, scene):
                stack.callback(bpy.data.node_groups.remove, tree)
        else:
            compat.drop_compositor(twin)
            twin.cycles.film_exposure = 1.0
            # Freestyle lines cost time, and crash the engine of `viewer`, which draws nothing.
            render = {"use_freestyle": False, **render}
        if size:
            compat.assign(twin.render, resolution_x=size[0], resolution_y=size[1], resolution_percentage=100)
        compat.assign(twin.render, **{"use_sequencer": False, "use_border": False, "use_multiview": False, **render})
        # A coarse importance map for a world without an environment texture: the fine one that Cycles chooses may take a
        # minute for stars of noise.
        world = rendered.world(scene)
        tree = compat.node_tree(world) if world else None
        computed = tree and all(node.bl_idname != "ShaderNodeTexEnvironment" for node in tree.nodes)
        if world and computed and world.is_editable and world.cycles.sampling_method == "AUTOMATIC":
            stack.enter_context(changed(world.cycles, sampling_method="MANUAL", sample_map_resolution=512))
        yield twin


def evaluate_render(scene: Scene, read: Callable[[Depsgraph], T]) -> T:
    """Calls `read` with the dependency graph of a final render of the current frame, and returns its result.

    The graph has render-level modifiers and render visibility. Blender gives it only to render engines, so this function
    registers one for the call. Nothing is rendered, and nothing in the file changes.
    """
    results: list[T] = []
    # Blender refuses fewer than 16 pixels.
    with copied_scene(scene, size=(32, 32)) as twin, viewer(twin, lambda graph: results.append(read(graph))):
        bpy.ops.render.render(scene=twin.name, layer=rendered.layer(twin).name)
    return results[0]


@contextmanager
def viewer(twin: Scene, look: Callable[[Depsgraph], None]) -> Iterator[None]:
    """For the block, gives a copied scene a render engine that only calls `look` with the dependency graph of a render.

    The first error in `look` is raised at the end of the block.
    """
    errors: list[Exception] = []

    class Viewer(bpy.types.RenderEngine):
        bl_idname = "VIBE_VIEWER"
        bl_label = "Vibe Render (export)"

        def render(self, depsgraph: Depsgraph) -> None:
            try:
                look(depsgraph)
            except Exception as error:
                errors.append(error)

    bpy.utils.register_class(Viewer)
    try:
        twin.render.engine = Viewer.bl_idname
        yield
    finally:
        bpy.utils.unregister_class(Viewer)
    if errors:
        raise errors[0]
