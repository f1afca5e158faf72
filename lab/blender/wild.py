# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's side of `python -m lab wild`: whether Revert gives a file back, value by value, after saving and reopening.

python -m lab.blender.wild ORIGINAL.blend VIBED.blend FOLDER
"""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

import bpy
from vibe_render.core import compat
from vibe_render.headless.scenes import open_blend, save_blend
from vibe_render.scene import snapshot

from lab.blender import side
from lab.blender.contents import difference, dump

_SHOWN = 8


def compare(original: Path, vibed: Path, folder: Path) -> dict[str, Any]:
    """Reverts a vibed file and compares it with its original; both as this Blender saves and reopens them.

    Both have been saved twice then: each time Blender drops what nothing in the file uses.

    Args:
        vibed: What a vibe has made of it.
        folder: Gets original.blend and reverted.blend.

    Returns:
        `values`: how many were compared; `differ`: how many are not the same; `examples`: some of them, as lines;
        `lost`: what Revert says that it could not restore.
    """
    open_blend(original)
    _save(folder / "original.blend")
    before = _saved(folder / "original.blend")
    open_blend(vibed)
    lost = [line for scene in bpy.data.scenes if snapshot.exists(scene) for line in snapshot.revert(scene)]
    apart = difference(before, _saved(folder / "reverted.blend"))
    examples = [f"{path}: {old!s:.60} -> {new!s:.60}" for path, (old, new) in list(apart.items())[:_SHOWN]]
    return {"values": len(before), "differ": len(apart), "examples": examples, "lost": lost}


def _saved(path: Path) -> dict[str, Any]:
    """Contents of the open file after it has been saved and opened again.

    Left out are what Blender makes for any render, and compositor trees that are switched off: Blender 4 cannot delete one.
    """
    _save(path)
    off = [f"scenes[{s.name_full}].node_tree" for s in bpy.data.scenes if compat.compositor(s) is None]
    left_out = ("images[Render Result]", *off)
    return {path: value for path, value in dump().items() if not path.startswith(left_out)}


def _save(path: Path) -> None:
    """Saves the open file and opens what has been saved."""
    save_blend(path)
    open_blend(path)


if __name__ == "__main__":
    side.say("scene", **compare(*map(Path, sys.argv[1:4])))
    sys.stdout.flush()
    os._exit(0)  # Blender 4.5's own exit handlers may wait for ever
