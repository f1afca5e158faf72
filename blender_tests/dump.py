# SPDX-License-Identifier: GPL-3.0-or-later
"""What a vibe may leave in a .blend, and what it must not: `lab.blender.contents` without Blender's own doings."""

from __future__ import annotations

from typing import Any

import bpy
from vibe_render.core import compat

from lab.blender.contents import difference as difference
from lab.blender.contents import dump as dump


def contents() -> dict[str, Any]:
    """Everything in the file but the panel's own fields and the picture that Blender makes for any render.

    Blender 4 cannot delete a compositor tree: one that is switched off is left out, too.
    """
    left_out = [".vibe", "images[Render Result]"]
    if compat.compositor(bpy.context.scene) is None:
        left_out.append("scenes[Scene].node_tree")
    return {path: value for path, value in dump().items() if not any(part in path for part in left_out)}


def changes(before: dict[str, Any]) -> dict[str, tuple]:
    """What differs from before, apart from the one thing that Blender 4 offers no way to take back.

    A scene there has no compositor tree until the first use; then it has one for good. It is left
    empty and switched off.
    """
    found = difference(before, dump())
    for scene in bpy.data.scenes:
        tree = getattr(scene, "node_tree", None)
        path = f"scenes[{scene.name}].node_tree"
        if not compat.COMPOSITOR_IS_GROUP and before.get(path, 0) is None and not scene.use_nodes:
            assert tree is None or not tree.nodes
            found = {k: v for k, v in found.items() if not k.startswith(path)}
    return found
