# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension's folder for the user's files; updates of the extension leave it alone."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

import bpy

from . import ADDON


def own_folder(path: str, create: bool = False) -> Path:
    """A folder in it.

    Where we are not installed as an extension (a Blender without a window), it is where one that was
    installed from disk has it.

    Args:
        create: Whether to make it if it is not there.
    """
    try:
        folder = Path(bpy.utils.extension_path_user(ADDON, path=path))
    except ValueError:
        place = f".user/user_default/vibe_render/{path}"
        folder = Path(bpy.utils.user_resource("EXTENSIONS", path=place))
    if create:  # Blender's own `create` gives "", the current folder, where another Blender makes it just now
        with suppress(OSError):  # whoever writes into it says why that cannot be
            folder.mkdir(parents=True, exist_ok=True)
    return folder
