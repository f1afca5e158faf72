# SPDX-License-Identifier: Apache-2.0
"""Writes files so that they appear whole or not at all, even if the writing process fails."""

import errno
import os
import uuid
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A temporary path next to `path`. After the block its file replaces `path`; if the block raises, it is deleted."""
    part = path.with_name(f"{part_prefix()}{uuid.uuid4().hex[:8]}-{path.name}")
    try:
        yield part
        os.replace(part, path)
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)


def part_prefix(process: int | None = None) -> str:
    """The first characters in names of unfinished files of a process, given by its id; None for this process."""
    return f".part-{process or os.getpid()}-"


def write_text(path: Path, text: str) -> None:
    """Writes a text file as UTF-8, whole or not at all, see `replacing`."""
    with replacing(path) as part:
        part.write_text(text, encoding="utf-8")


def is_full(error: Exception) -> bool:
    """True if an error says that the disk, or the user's quota, is full."""
    return getattr(error, "errno", 0) in (errno.ENOSPC, errno.EDQUOT) or "No space left" in str(error)
