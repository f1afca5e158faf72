# SPDX-License-Identifier: GPL-3.0-or-later
"""The pictures of the preset grid as icons, loaded once, and again when their file changes."""

from __future__ import annotations

import bpy
import bpy.utils.previews

from ..looks.library import Look

_pictures: bpy.utils.previews.ImagePreviewCollection | None = None


def icon(look: Look) -> int:
    """The icon number of a look's picture for `layout.template_icon`; one of Blender's own icons if it has none."""
    global _pictures
    try:
        key = f"{look.picture}?{look.picture.stat().st_mtime_ns}"
    except OSError:
        return _sign("ERROR" if look.problem else "IMAGE_DATA")
    if _pictures is None:
        _pictures = bpy.utils.previews.new()
    if key not in _pictures:
        loaded = _pictures.load(key, str(look.picture), "IMAGE")
        loaded.image_size[:]  # reads the file now; else a job would read it, and the grid would flicker
    return _pictures[key].icon_id


def _sign(name: str) -> int:
    """The number of one of Blender's own icons."""
    return bpy.types.UILayout.bl_rna.functions["prop"].parameters["icon"].enum_items[name].value


def free() -> None:
    """Frees the pictures."""
    global _pictures
    if _pictures is not None:
        bpy.utils.previews.remove(_pictures)
    _pictures = None
