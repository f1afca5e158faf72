# SPDX-License-Identifier: Apache-2.0
"""A sheet of pictures that an encoder got wrong, with the sentence that was true and the one that it preferred."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from lab.train.evaluate import Mistake
from proxy_renderer.engine.pictures import save_image

_SIDE, _GAP, _TEXT, _COLUMNS, _MOST = 200, 10, 92, 6, 24
_PAPER, _INK, _TRUE, _FALSE = (24, 24, 26), (236, 236, 236), (130, 210, 140), (230, 130, 120)


def save_mistakes(mistakes: Sequence[Mistake], path: Path) -> None:
    """Writes a sheet of mistakes, of every kind in turn.

    Args:
        mistakes: As many as fit are shown.
        path: The picture file; an old one is removed where there are no mistakes.
    """
    kinds: dict[str, list[Mistake]] = {}
    for one in mistakes:
        kinds.setdefault(one.asked, []).append(one)
    turns = max(map(len, kinds.values()), default=0)
    chosen = [group[k] for k in range(turns) for group in kinds.values() if k < len(group)][:_MOST]
    if not chosen:
        path.unlink(missing_ok=True)
        return
    rows = -(-len(chosen) // _COLUMNS)
    sheet = Image.new("RGB", (_COLUMNS * (_SIDE + _GAP) + _GAP, rows * (_SIDE + _TEXT + _GAP) + _GAP), _PAPER)
    for number, one in enumerate(chosen):
        left, top = (_GAP + number % _COLUMNS * (_SIDE + _GAP), _GAP + number // _COLUMNS * (_SIDE + _TEXT + _GAP))
        _draw(sheet, one, left, top)
    save_image(sheet, path)


def _draw(sheet: Image.Image, one: Mistake, left: int, top: int) -> None:
    pixels = (255 * one.picture.permute(1, 2, 0).numpy()).round().astype(np.uint8)
    sheet.paste(Image.fromarray(pixels).resize((_SIDE, _SIDE), Image.Resampling.LANCZOS), (left, top))
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(12)
    lines = [(one.asked, _INK)]
    lines += [(line, _TRUE) for line in textwrap.wrap(one.true, 32)[:3]]
    lines += [(line, _FALSE) for line in textwrap.wrap(one.false, 32)[:3]]
    for number, (line, color) in enumerate(lines):
        draw.text((left, top + _SIDE + 3 + 13 * number), line, color, font)
