# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a picture is black, in words for the artist."""

from __future__ import annotations

from pathlib import Path

import bpy

from ..core import compat
from ..scene.nodes import grade
from . import bake

_BLACKEST = 0.02  # of white, as the picture is stored: what is darker everywhere shows nothing


def black_note(scene: bpy.types.Scene, picture: Path) -> str:
    """What to say of a black picture of a scene; "" for any other."""
    image = bpy.data.images.load(str(picture))
    try:
        image.colorspace_settings.name = "Non-Color"
        shows = bool(bake.image_pixels(image).max() >= _BLACKEST)
    finally:
        bpy.data.images.remove(image)
    if shows:
        return ""
    if grade.cut_off(compat.compositor(scene)):
        return (
            "The scene renders black: no picture reaches the output of its compositor. Connect one, or take the "
            "compositor out."
        )
    return (
        "The scene renders black: no light reaches what the camera sees. Switch a light on, or ask for one."
    )
