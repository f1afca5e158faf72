# SPDX-License-Identifier: GPL-3.0-or-later
"""How much the cache holds, for the preferences. No bpy calls."""

from __future__ import annotations

import time
from pathlib import Path

from ..core import drawing

_EVERY = 3.0  # seconds between two measurements: Blender draws many times a second
_measured: dict[Path, tuple[float, str]] = {}  # when a folder was measured, and what it held


def text(folder: Path) -> str:
    """How much a folder holds, such as "3.4 MB in 12 files"; "Empty" also where there is none."""
    when, size = _measured.get(folder, (0.0, ""))
    if time.monotonic() - when > _EVERY:
        files = [f.stat().st_size for f in folder.rglob("*") if f.is_file()] if folder.is_dir() else []
        count = f"{len(files)} file{'s' if len(files) > 1 else ''}"
        size = f"{drawing.size(sum(files))} in {count}" if files else "Empty"
        _measured[folder] = time.monotonic(), size
    return size


def measure_again() -> None:
    """Forgets what was measured."""
    _measured.clear()
