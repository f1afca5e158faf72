# SPDX-License-Identifier: Apache-2.0
"""Letters on pictures: Blender's own fonts, which have those of all languages that prompts are written in."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

from PIL import ImageFont

Font = ImageFont.FreeTypeFont | ImageFont.ImageFont

_LATIN, _CJK = "Inter.woff2", "Noto Sans CJK Regular.woff2"
_EAST_ASIAN = re.compile(r"[\u1100-\u11ff\u2e80-\u9fff\uac00-\ud7af\uf900-\ufaff\uff00-\uffef]")
_UNIT = re.compile(rf"{_EAST_ASIAN.pattern}|\s*(?:(?!{_EAST_ASIAN.pattern})\S)+")
"""What a line may end after: a letter of East Asia, or a word with the space before it."""


def font(size: int, text: str, fonts: Path) -> Font:
    """A font that has the letters of a text; the small one that Pillow has where Blender's fonts are missing.

    Args:
        size: In pixels.
    """
    return _font(size, fonts / (_CJK if _EAST_ASIAN.search(text) else _LATIN))


@cache
def _font(size: int, file: Path) -> Font:
    try:
        return ImageFont.truetype(str(file), size)
    except OSError:
        return ImageFont.load_default(size)


def wrapped(text: str, face: Font, width: float, most: int) -> list[str]:
    """The lines of a text; what is left out is shown by dots.

    Args:
        width: Of a line, in pixels.
        most: How many lines there may be.
    """
    lines = [""]
    for unit in _UNIT.findall(text):
        longer = lines[-1] + unit
        if lines[-1] and face.getlength(longer) > width:
            lines.append(unit.lstrip())
        else:
            lines[-1] = longer.lstrip()
    if len(lines) <= most:
        return lines
    last = lines[most - 1]
    while last and face.getlength(f"{last} …") > width:
        last = last[:-1]
    return [*lines[: most - 1], f"{last} …"]
