# SPDX-License-Identifier: Apache-2.0
"""Folders of a user's files: settings, and caches."""

import os
from pathlib import Path

from platformdirs import user_cache_path, user_config_path

_NAME = "vibe-render"
CACHE = "VIBE_CACHE"  # the environment variable that names another cache folder


def config_folder() -> Path:
    """The folder of the user's settings for Vibe Render; it need not exist."""
    return user_config_path(_NAME, appauthor=False, roaming=True)


def cache_folder(part: str) -> Path:
    """The user's folder for one kind of cached files, such as "vlm", the answers of models; it need not exist."""
    if named := os.environ.get(CACHE):
        return Path(named).expanduser().resolve() / part
    return user_cache_path(_NAME, appauthor=False, opinion=False) / part
