# SPDX-License-Identifier: Apache-2.0
"""A file is written whole, or what was there stays."""

import errno

import pytest

from proxy_renderer.schema import atomic


def test_it_takes_the_files_place(tmp_path):
    path = tmp_path / "look.json"
    path.write_text("old", encoding="utf-8")
    with atomic.replacing(path) as part:
        part.write_text("new", encoding="utf-8")
        assert (part.suffix, part.parent, path.read_text(encoding="utf-8")) == (".json", tmp_path, "old")
    assert [p.name for p in tmp_path.iterdir()] == ["look.json"]
    assert path.read_text(encoding="utf-8") == "new"


def test_a_failure_leaves_everything_as_it_was(tmp_path):
    path = tmp_path / "look.json"
    path.write_text("old", encoding="utf-8")
    with pytest.raises(KeyboardInterrupt), atomic.replacing(path) as part:  # noqa: PT012
        part.write_text("half", encoding="utf-8")
        raise KeyboardInterrupt
    assert [p.name for p in tmp_path.iterdir()] == ["look.json"]
    assert path.read_text(encoding="utf-8") == "old"


def test_text_is_utf8(tmp_path):
    atomic.write_text(tmp_path / "a.txt", "naïve\n")
    assert (tmp_path / "a.txt").read_bytes().replace(b"\r\n", b"\n") == "naïve\n".encode()


def test_a_folder_that_is_not_there(tmp_path):
    with pytest.raises(FileNotFoundError):
        atomic.write_text(tmp_path / "no" / "a.txt", "")


@pytest.mark.parametrize(
    ("error", "full"),
    [
        (OSError(errno.ENOSPC, "No space left on device"), True),
        (OSError(errno.EDQUOT, "Quota exceeded"), True),
        (RuntimeError("Error: No space left on device"), True),  # of Blender
        (PermissionError(errno.EACCES, "Permission denied"), False),
        (ValueError("bad"), False),
    ],
)
def test_a_full_disk_is_told_from_other_errors(error, full):
    assert atomic.is_full(error) is full
