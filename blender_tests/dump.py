# SPDX-License-Identifier: GPL-3.0-or-later
"""What a vibe may leave in a .blend, and what it must not: `lab.blender.contents` without Blender's own doings."""

from __future__ import annotations

import re
from typing import Any

import bpy
from vibe_render.core import compat

from lab.blender.contents import difference as difference
from lab.blender.contents import dump as dump

_COUNTED = re.compile(r"scenes\[.*?\]\.users")
"""Blender's own counting: a Render Layers node that comes a second time counts twice, though both are gone."""


def contents() -> dict[str, Any]:
    """Everything in the file but the panel's own fields and the picture that Blender makes for any render.

    Blender 4 cannot delete a compositor tree: one that is switched off is left out, too.
    """
    left_out = [".vibe", "images[Render Result]"]
    counted = _COUNTED.fullmatch
    if compat.compositor(bpy.context.scene) is None:
        left_out.append("scenes[Scene].node_tree")
    found = dump().items()
    return {p: value for p, value in found if not (counted(p) or any(part in p for part in left_out))}


def changes(before: dict[str, Any]) -> dict[str, tuple]:
    """What differs from before, apart from the one thing that Blender 4 offers no way to take back.

    A scene there has no compositor tree until the first use; then it has one for good. It is left
    empty and switched off.
    """
    found = {path: pair for path, pair in difference(before, dump()).items() if not _COUNTED.fullmatch(path)}
    for scene in bpy.data.scenes:
        tree = getattr(scene, "node_tree", None)
        path = f"scenes[{scene.name}].node_tree"
        if not compat.COMPOSITOR_IS_GROUP and before.get(path, 0) is None and not scene.use_nodes:
            assert tree is None or not tree.nodes
            found = {k: v for k, v in found.items() if not k.startswith(path)}
    return found
