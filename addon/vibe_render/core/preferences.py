# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's preferences, and the folder of the user's files, which updates of the extension leave alone."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import Any

import bpy

from . import ADDON, compat

_FOLDER = "vibe-render"  # inside a chosen cache folder: what Clear deletes is ours


def own_folder(path: str, create: bool = False) -> Path:
    """A folder of the user's files; without an installed extension (no window), where one installed from disk has it."""
    try:
        folder = Path(bpy.utils.extension_path_user(ADDON, path=path))
    except ValueError:
        place = f".user/user_default/vibe_render/{path}"
        folder = Path(bpy.utils.user_resource("EXTENSIONS", path=place))
    if create:  # Blender's own `create` gives "", the current folder, where another Blender makes it just now
        with suppress(OSError):  # whoever writes into it says why that cannot be
            folder.mkdir(parents=True, exist_ok=True)
    return folder


def get(context: bpy.types.Context) -> Any:
    """The add-on's preferences; None where it is registered without being installed (tests)."""
    addon = context.preferences.addons.get(ADDON)
    return addon.preferences if addon else None


def engine_choice(context: bpy.types.Context) -> str:
    """The folder that the artist has chosen for the engine; "" to look for it."""
    chosen = get(context)
    return chosen.engine if chosen else ""


def cache_folder(context: bpy.types.Context) -> Path:
    """The cache: everything in it can be made again. A chosen folder gets a folder of ours inside."""
    chosen = get(context)
    if chosen and chosen.cache:
        return Path(bpy.path.abspath(chosen.cache)).expanduser() / _FOLDER
    return own_folder("cache") / _FOLDER


def online() -> bool:
    """True if other computers may be reached: Blender's own setting, which a Python module lacks."""
    return compat.IS_MODULE or bpy.app.online_access
