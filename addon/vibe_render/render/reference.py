# SPDX-License-Identifier: GPL-3.0-or-later
"""The reference image (a file, an image of the .blend, or a render slot), as a file for the engine."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from bpy.types import Image, Scene

from ..core.compat import changed
from ..core.schema_import import schema
from ..core.temporary import temporary
from . import bake

_NAME = "reference"


def picture_name(settings: Any) -> str:
    """The name of the reference image that the panel's settings choose; "" if none is chosen."""
    if settings.like_from == "FILE":
        return Path(settings.like.replace("\\", "/")).name
    if settings.like_from == "IMAGE":
        return settings.like_image.name if settings.like_image else ""
    return f"render slot {settings.like_slot}" if settings.like_from == "SLOT" else ""


def request_title(prompt: str, like: str) -> str:
    """The request as panels show it: “red metal” like photo.png; an empty part is left out."""
    parts = [f"“{prompt}”" if prompt else "", f"like {like}" if like else ""]
    return " ".join(filter(None, parts))


def picture_obstacle(settings: Any) -> str:
    """The reason why the reference image cannot be used; "" if it can be, or none is chosen."""
    if settings.like_from == "FILE" and settings.like and not Path(_absolute(settings.like)).is_file():
        return f"There is no picture {picture_name(settings)}"
    if settings.like_from == "SLOT" and _render_result() is None:
        return "Nothing has been rendered yet"
    return ""


def picture_path(scene: Scene, folder: Path) -> str:
    """The path of the reference image, after saving it to `folder` if it is no file; "" if none is chosen.

    Raises VibeError if the reference image is missing.
    """
    settings = scene.vibe
    if not picture_name(settings):
        return ""
    if reason := picture_obstacle(settings):
        raise schema.VibeError(f"{reason}.", "Choose another one, or give words only.")
    if settings.like_from == "FILE":
        return _absolute(settings.like)
    if settings.like_from == "SLOT":
        return str(_save_slot(scene, settings.like_slot, folder))
    return str(_save_image(settings.like_image, folder))


def _absolute(path: str) -> str:
    """The absolute form of a path that is relative to the .blend's folder ("//…") or to the current folder."""
    return os.path.abspath(bpy.path.abspath(os.path.expanduser(path)))


def _save_image(image: Image, folder: Path) -> Path:
    """Saves an image's pixels as Blender has them, also painted or packed ones, as EXR (floats) or PNG (bytes)."""
    width, height = image.size
    if width * height == 0:  # `size` reads the file; it is 0 if that fails
        raise schema.VibeError(f"The image {image.name} has no pixels.", "Choose another one.")
    rgba = np.ones((width * height, 4), np.float32)
    rgba[:, : image.channels] = bake.image_channels(image).reshape(-1, image.channels)
    if image.channels < 3:
        rgba[:, :3] = rgba[:, :1]
    path = folder / f"{_NAME}.{'exr' if image.is_float else 'png'}"
    with temporary(bpy.data.images.new(_NAME, width, height, alpha=True, float_buffer=image.is_float)) as copy:
        copy.alpha_mode = image.alpha_mode
        # Without a color space, numbers are saved unchanged: linear for floats, encoded for bytes.
        copy.colorspace_settings.is_data = True
        copy.pixels.foreach_set(rgba.ravel())
        copy.file_format = "OPEN_EXR" if image.is_float else "PNG"
        copy.filepath_raw = str(path)
        copy.save()
    return path


def _save_slot(scene: Scene, slot: int, folder: Path) -> Path:
    """Saves the render in a slot (from 1), with the scene's view transform, as a PNG; returns the path."""
    result = _render_result()
    assert result is not None
    path, slots = folder / f"{_NAME}.png", result.render_slots
    if slot > len(slots):
        raise schema.VibeError(f"There is no render slot {slot}.", f"Use 1 to {len(slots)}.")
    shown = slots.active_index
    # The scene itself is used, because a copy of it has no render result.
    with changed(scene.render.image_settings, **bake.png("RGBA", "16")):
        try:
            slots.active_index = slot - 1
            result.save_render(str(path), scene=scene)
        except RuntimeError as error:
            raise schema.VibeError(f"Render slot {slot} is empty.", "Render into it, or choose another one.") from error
        finally:
            slots.active_index = shown
    return path


def _render_result() -> Image | None:
    return next((image for image in bpy.data.images if image.type == "RENDER_RESULT"), None)
