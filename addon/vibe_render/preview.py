# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture in the panel: a PNG as an icon, loaded anew whenever the file has changed."""

from __future__ import annotations

from pathlib import Path

import bpy.utils.previews

_pictures: bpy.utils.previews.ImagePreviewCollection | None = None
_shown: tuple[Path, int] | None = None


def icon(picture: Path | None) -> int:
    """The icon's number for `layout.template_icon`; 0 where there is no picture (yet)."""
    global _pictures, _shown
    if picture is None or not picture.is_file():
        return 0
    if _pictures is None:
        _pictures = bpy.utils.previews.new()
    version = (picture, picture.stat().st_mtime_ns)
    if version != _shown:
        _pictures.clear()
        loaded = _pictures.load("vibe", str(picture), "IMAGE")
        loaded.image_size[:]  # reads the file now; otherwise the panel would flicker until a job has
        _shown = version
    return _pictures["vibe"].icon_id


def free() -> None:
    """Frees the picture."""
    global _pictures, _shown
    if _pictures is not None:
        bpy.utils.previews.remove(_pictures)
    _pictures = _shown = None
