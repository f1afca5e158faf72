# SPDX-License-Identifier: Apache-2.0
"""Mistakes in a file that people wrote, with the line that has to be mended."""

from __future__ import annotations

from pathlib import Path

from ...schema import VibeError


def at_line(path: Path, text: str, what: str, remedy: str, *said: str) -> VibeError:
    """An error that names a line.

    Args:
        said: Texts that lead to the line: the first line that has the first, from there on the first that has the second.
    """
    lines, line = text.splitlines(), 0
    for quoted in said:
        line = next((i for i in range(line, len(lines)) if quoted in lines[i]), line)
    return VibeError(f"{path}, line {line + 1}: {what}.", remedy)
