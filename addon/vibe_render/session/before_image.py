# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture of a scene before its first vibe: kept until Keep or Revert, so that "before" stays the artist's own.

It lies in Blender's temporary folder, one for each camera and frame: another sight of the scene is no comparison.
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
    """Where the first picture of the scene as its camera sees it now is kept, if there is one."""
    camera, size = scene.camera, (scene.render.resolution_x, scene.render.resolution_y)
    pose = [round(x, 4) for row in camera.matrix_world for x in row] if camera else []
    lens = round(camera.data.angle, 4) if camera else 0.0
    framing = zlib.crc32(repr((size, scene.frame_current, pose, lens)).encode())
    return Path(bpy.app.tempdir) / f"{_name(scene)}{framing:08x}.png"


def store(path: Path, picture: Path, first: bool) -> Path:
    """The picture to compare with.

    Args:
        path: The place of what the picture shows, as it was when the scene was exported.
        picture: Of the scene as it was then.
        first: Whether nothing had been vibed yet, so that this is the one to keep.
    """
    if first:
        # on a full disk there is none to compare with later
        with contextlib.suppress(schema.VibeError), whole(path) as part:
            shutil.copyfile(picture, part)
    return path if path.is_file() else picture


def forget(scene: bpy.types.Scene) -> None:
    """What comes next starts from another scene."""
    for path in Path(bpy.app.tempdir).glob(f"{_name(scene)}*"):
        path.unlink(missing_ok=True)


def _name(scene: bpy.types.Scene) -> str:
    return f"vibe-before-{scene.session_uid}-"
