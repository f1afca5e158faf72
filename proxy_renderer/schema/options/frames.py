# SPDX-License-Identifier: Apache-2.0
"""Frame numbers as people write them."""

from __future__ import annotations

import re

from ..errors import VibeError


def frame_numbers(text: str) -> list[int]:
    """Frames as people write them: "1,50,100-110"; none from "".

    Raises:
        VibeError: A part is neither a number nor a range of two.

    >>> frame_numbers("1, 50, 100-102, 50")
    [1, 50, 100, 101, 102]
    """
    numbers: dict[int, None] = {}
    for part in filter(None, re.split(r"[,\s]+", text)):
        match = re.fullmatch(r"(\d+)(?:-(\d+))?", part)
        if not match:
            raise VibeError(f"{part!r} names no frames.", "Write them as in 1,50,100 or 1-24.")
        first = int(match[1])
        numbers |= dict.fromkeys(range(first, int(match[2] or first) + 1))
    return list(numbers)
