# SPDX-License-Identifier: GPL-3.0-or-later
"""Thumbnails of looks: the square in the middle of an image, as a small JPEG."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import bpy
import numpy as np

from ..core.files import whole
from ..core.temporary import temporary
from ..render import bake, final_render

SIZE = 128  # pixels
SUFFIX = ".jpg"
_SAMPLES = 48


@contextmanager
def rendered_thumbnail(scene: bpy.types.Scene) -> Iterator[Path]:
    """The path of a JPEG: the middle square of a small Cycles render of the scene. It is deleted after the block."""
    width, height = scene.render.resolution_x, scene.render.resolution_y
    longer = round(SIZE * max(width, height) / min(width, height))
    with tempfile.TemporaryDirectory(prefix="vibe-") as folder:
        picture, middle = Path(folder) / "whole.png", Path(folder) / f"middle{SUFFIX}"
        final_render.render_picture(scene, picture, longer, _SAMPLES)
        save_thumbnail(picture, middle)
        yield middle


def save_thumbnail(picture: Path, out: Path) -> None:
    """Writes the middle square of an image file as a JPEG, `SIZE` pixels wide; raises VibeError if that fails."""
    pixels = bake.read_file(picture)
    side = min(pixels.shape[:2])
    top, left = ((n - side) // 2 for n in pixels.shape[:2])
    middle = np.ascontiguousarray(pixels[top : top + side, left : left + side])
    middle[..., 3] = 1.0
    small = bpy.data.images.new("Vibe Thumbnail", side, side, alpha=False, is_data=True)
    with temporary(small), whole(out, "Check the folder.") as part:
        small.pixels.foreach_set(middle.ravel())
        small.scale(SIZE, SIZE)
        small.filepath_raw, small.file_format = str(part), "JPEG"
        small.save(quality=92)
