# SPDX-License-Identifier: GPL-3.0-or-later
"""A real disk of a few hundred kilobytes, to be filled; only root may make one, and only on Linux."""

import subprocess
from contextlib import contextmanager

import pytest

_PAGE = 4096  # what a file takes at least


class Disk:
    """A disk.

    Attributes:
        folder: Where it is.
    """

    def __init__(self, folder):
        self.folder = folder
        self._rest = folder / "rest"

    def fill(self, left=0):
        """Leaves room for some pages only."""
        with self._rest.open("ab", buffering=0) as file:
            try:
                while file.write(b"x" * _PAGE):
                    pass
            except OSError:
                file.truncate(file.tell() - left * _PAGE)

    def make_room(self):
        """Empties what `fill` has written."""
        self._rest.unlink()

    def protect(self):
        """Makes it read-only, for root too."""
        subprocess.run(["mount", "-o", "remount,ro", str(self.folder)], check=True)

    def files(self):
        """All files in it but for what fills it."""
        return {str(p.relative_to(self.folder)) for p in self.folder.rglob("*") if p.is_file()} - {"rest"}


@contextmanager
def small_disk(folder, kilobytes):
    """A disk at a new folder."""
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "tmpfs", str(folder)]
    try:
        done = subprocess.run(mount, capture_output=True, text=True)
    except OSError as error:
        pytest.skip(f"no small disk can be made here: {error}")
    if done.returncode:
        pytest.skip(f"no small disk can be made here: {done.stderr.strip()}")
    try:
        yield Disk(folder)
    finally:
        subprocess.run(["umount", "-l", str(folder)], check=True)
