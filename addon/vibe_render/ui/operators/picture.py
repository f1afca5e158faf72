# SPDX-License-Identifier: GPL-3.0-or-later
"""A picture from the clipboard, as the look that is wanted."""

from __future__ import annotations

from typing import ClassVar

import bpy

from ...core import compat
from ...core.schema_import import schema
from .base import IdleOperator


class VIBE_OT_paste_picture(IdleOperator):
    """Use the picture in the clipboard; it becomes an image of this .blend"""

    bl_idname = "vibe.paste_picture"
    bl_label = "Paste"
    bl_options: ClassVar[set[str]] = {"UNDO"}

    def act(self, context: bpy.types.Context) -> str:
        """Pastes it."""
        image = compat.pasted_picture(context)
        if image is None:
            raise schema.VibeError(
                "Blender sees no picture in the clipboard.",
                "Copy one first. Some desktops hand Blender none (X11 on Linux): save it, and choose File.",
            )
        image.pack()
        settings = context.scene.vibe
        settings.like_from, settings.like_image = "IMAGE", image
        return f"{image.name} is the look that is wanted"


CLASSES = (VIBE_OT_paste_picture,)
