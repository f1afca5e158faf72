# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's preferences, and the folder of the user's files, which updates of the extension leave alone."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy

from . import ADDON, compat

_FOLDER = "vibe-render"  # subfolder of the chosen cache folder: Clear deletes only this


def own_folder(path: str) -> Path:
    """The user's folder for files of the extension; `path`: its place in the extension's folder, such as "cache"."""
    try:
        return Path(bpy.utils.extension_path_user(ADDON, path=path))
    except ValueError:  # no extension is installed (command line): the folder of an extension installed from disk
        return Path(bpy.utils.user_resource("EXTENSIONS", path=f".user/user_default/vibe_render/{path}"))


def get(context: bpy.types.Context) -> Any:
    """The add-on's preferences; None if it is registered without being installed, as in tests."""
    addon = context.preferences.addons.get(ADDON)
    return addon.preferences if addon else None


def engine_choice(context: bpy.types.Context) -> str:
    """The folder that the artist has chosen for the engine; "" to search for the engine."""
    chosen = get(context)
    return chosen.engine if chosen else ""


def cache_folder(context: bpy.types.Context) -> Path:
    """The folder of files that can be made again: in the cache folder of the preferences, or else in `own_folder`."""
    chosen = get(context)
    if chosen and chosen.cache:
        return Path(bpy.path.abspath(chosen.cache)).expanduser() / _FOLDER
    return own_folder("cache") / _FOLDER


def online() -> bool:
    """True if the network may be used: Blender's Online Access setting; always, where Blender is a Python module."""
    return compat.IS_MODULE or bpy.app.online_access
