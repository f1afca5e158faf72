# SPDX-License-Identifier: GPL-3.0-or-later
"""The image of a scene before its first vibe, stored until Keep or Revert: "before" always shows the artist's scene.

There is one for each camera pose and frame, in Blender's temporary folder: only the same framing can be compared.
"""

from __future__ import annotations

import contextlib
import shutil
import zlib
from pathlib import Path

import bpy

from ..core.files import whole
from ..core.schema_import import schema


def path_of(scene: bpy.types.Scene) -> Path:
    """The path of the before image for the scene's present camera, frame and resolution, whether it exists or not."""
    camera, size = scene.camera, (scene.render.resolution_x, scene.render.resolution_y)
    pose = [round(x, 4) for row in camera.matrix_world for x in row] if camera else []
    lens = round(camera.data.angle, 4) if camera else 0.0
    framing = zlib.crc32(repr((size, scene.frame_current, pose, lens)).encode())
    return Path(bpy.app.tempdir) / f"{_name(scene)}{framing:08x}.png"


def store(path: Path, picture: Path, first: bool) -> Path:
    """Stores a picture of the exported scene, if that was the artist's own; returns the one to compare with."""
    if first:
        # On a full disk nothing is stored; a later vibe then compares with its own start.
        with contextlib.suppress(schema.VibeError), whole(path) as part:
            shutil.copyfile(picture, part)
    return path if path.is_file() else picture


def forget(scene: bpy.types.Scene) -> None:
    """Deletes the before images of a scene, after Keep or Revert."""
    for path in Path(bpy.app.tempdir).glob(f"{_name(scene)}*"):
        path.unlink(missing_ok=True)


def _name(scene: bpy.types.Scene) -> str:
    return f"vibe-before-{scene.session_uid}-"
