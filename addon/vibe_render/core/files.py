# SPDX-License-Identifier: GPL-3.0-or-later
"""Atomic writing of files, and the errors for files that cannot be written. No bpy here."""

from __future__ import annotations

import contextlib
import errno
import json
import os
import shutil
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from .schema_import import atomic, schema

_REMEDY = "Choose another --out."
_LEAST = 4096  # bytes free on the disk; with fewer, the file just written may be truncated


@contextmanager
def whole(path: Path, remedy: str = "Choose another folder.") -> Iterator[Path]:
    """Yields a temporary path; after the block, its file replaces `path`. A failure raises VibeError with `remedy`."""
    try:
        with atomic.replacing(path) as part:
            yield part
            # Blender reports success even if the disk was full.
            if not part.stat().st_size or shutil.disk_usage(part.parent).free < _LEAST:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    except (OSError, RuntimeError) as error:  # the latter from Blender
        raise unwritable(path, error, remedy) from error


def unwritable(path: Path, error: Exception, remedy: str) -> schema.VibeError:
    """The error for a file that cannot be written, with the reason that Blender or Python gives, and the `remedy`."""
    if atomic.is_full(error):
        return schema.VibeError(f"There is no room left on the disk, in {path.parent}.", "Make room there.")
    reason = getattr(error, "strerror", None) or str(error).strip().removeprefix("Error: ")
    return schema.VibeError(f"{path} cannot be written: {reason.rstrip('.')}.", remedy)


class Outputs:
    """New files in an existing folder, all moved into place when the block ends, or deleted if it raises."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._run = uuid.uuid4().hex[:8]
        self._names: list[str] = []

    def path(self, name: str) -> Path:
        """The temporary path of file `name`: in the same folder, because a .blend stores paths relative to itself."""
        if name not in self._names:
            self._names.append(name)
        return self.folder / f"{atomic.part_prefix()}{self._run}-{name}"

    def write_json(self, name: str, content: Any) -> None:
        """Adds a JSON file; raises ValueError for a number that is not finite."""
        self.write_text(name, json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False))

    def write_text(self, name: str, text: str) -> None:
        """Adds a text file, UTF-8, with a newline at its end."""
        with self._writing(name) as path:
            path.write_text(text + "\n", encoding="utf-8")

    def copy(self, name: str, source: Path) -> None:
        """Adds a copy of the file `source` under this name."""
        with self._writing(name) as path:
            shutil.copyfile(source, path)

    @contextmanager
    def _writing(self, name: str) -> Iterator[Path]:
        try:
            yield self.path(name)
        except OSError as error:
            raise unwritable(self.folder / name, error, _REMEDY) from error

    def __enter__(self) -> Outputs:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        try:
            if kind is None:
                for name in self._names:
                    os.replace(self.path(name), self.folder / name)
        except OSError as broken:
            raise unwritable(self.folder / self._names[-1], broken, _REMEDY) from broken
        finally:
            for name in self._names:
                with contextlib.suppress(OSError):
                    self.path(name).unlink(missing_ok=True)
