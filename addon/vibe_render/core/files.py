# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of Blender's that appear whole or not at all, and what to say where they cannot be written. No bpy here."""

from __future__ import annotations

import errno
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from .schema_import import atomic, schema

_LEAST = 4096  # bytes: with fewer left, what was written last may have been cut off


@contextmanager
def whole(path: Path, remedy: str = "Choose another folder.") -> Iterator[Path]:
    """A temporary path beside a file, moved onto the file at the end of the block; removed after a failure.

    Args:
        remedy: What to do where it cannot be written, unless the disk is full.

    Raises:
        VibeError: It cannot be written. (What Blender cannot write is a RuntimeError, or an empty file.)
    """
    try:
        with atomic.replacing(path) as part:
            yield part
            _check(part)
    except (OSError, RuntimeError) as error:
        raise unwritable(path, error, remedy) from error


def unwritable(path: Path, error: Exception, remedy: str) -> schema.VibeError:
    """The error for a file that cannot be written, with the reason that Blender or Python gives.

    Args:
        error: What Blender or Python has raised.
        remedy: What to do, unless the disk is full.
    """
    if atomic.is_full(error):
        return schema.VibeError(f"There is no room left on the disk, in {path.parent}.", "Make room there.")
    reason = getattr(error, "strerror", None) or str(error).strip().removeprefix("Error: ")
    return schema.VibeError(f"{path} cannot be written: {reason.rstrip('.')}.", remedy)


def _check(part: Path) -> None:
    """Blender says that it has written a picture, also where the disk is full."""
    size = part.stat().st_size
    if not size or shutil.disk_usage(part.parent).free < _LEAST:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
