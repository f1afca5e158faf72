# SPDX-License-Identifier: Apache-2.0
"""Where rendered references are kept between measurements."""

from __future__ import annotations

import os
import sys
from pathlib import Path

VARIABLE = "VIBE_CACHE"


def folder(chosen: str = "") -> Path:
    """The folder chosen, else that of the environment variable VIBE_CACHE, else one in the user's cache."""
    named = chosen or os.environ.get(VARIABLE, "")
    if named:
        return Path(named).expanduser().resolve() / ("" if chosen else "fidelity")
    return _of_user() / "vibe-render" / "fidelity"


def _of_user() -> Path:
    home = Path.home()
    if sys.platform == "darwin":
        return home / "Library" / "Caches"
    if os.name == "nt":
        return Path(os.environ.get("LOCALAPPDATA") or home / "AppData" / "Local")
    return Path(os.environ.get("XDG_CACHE_HOME") or home / ".cache")
