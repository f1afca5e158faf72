# SPDX-License-Identifier: Apache-2.0
"""Contact sheets: for every scene its pictures side by side, with its name and error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from PIL import Image, ImageDraw, ImageFont

from lab.bench.metrics import delta_e_map
from proxy_renderer.engine.pictures import save_image

_SIDE, _GAP, _LINE = 256, 6, 24
_PAPER, _INK, _FAINT = (24, 24, 26), (236, 236, 236), (150, 150, 156)
_FULL = 15.0
"""CIEDE2000 that is shown at full brightness."""


@dataclass(frozen=True)
class Strip:
    """One scene of a sheet: a title, a smaller line, and labeled pictures from left to right."""

    title: str
    note: str
    panels: Sequence[tuple[str, Image.Image]]


def error_picture(picture: torch.Tensor, reference: torch.Tensor) -> Image.Image:
    """CIEDE2000 as brightness: red where the picture is lighter than the reference, blue where darker, gray for hue.

    Args:
        picture: (H, W, 3), sRGB-encoded, 0 to 1.
        reference: Of the same shape.
    """
    errors, lighter = delta_e_map(picture, reference)
    strength = (errors / _FULL).clamp(0, 1)[..., None].numpy()
    lean = (lighter / errors.clamp_min(1e-3)).clamp(-1, 1)[..., None].numpy()
    gray, red, blue = (np.array(c) for c in ((0.85, 0.85, 0.85), (1.0, 0.25, 0.1), (0.15, 0.45, 1.0)))
    tone = gray + np.maximum(lean, 0) * (red - gray) + np.maximum(-lean, 0) * (blue - gray)
    return Image.fromarray((255 * strength * tone).round().astype(np.uint8))


def save_sheets(strips: Sequence[Strip], out: Path, columns: int = 3, page: int = 8) -> list[Path]:
    """Writes OUT/contact.png with all scenes, and OUT/contact_01.png … in two columns; older sheets are removed.

    Args:
        strips: A row of pictures for each scene.
        page: Scenes on each of the others.

    Returns:
        The files; none without strips.
    """
    if not strips:
        return []
    save_image(_sheet(strips, columns), out / "contact.png")
    for old in out.glob("contact_*.png"):
        old.unlink()
    paths = [out / "contact.png"]
    for number, first in enumerate(range(0, len(strips), page), 1):
        paths.append(out / f"contact_{number:02d}.png")
        save_image(_sheet(strips[first : first + page], 2), paths[-1])
    return paths


def _sheet(strips: Sequence[Strip], columns: int) -> Image.Image:
    columns = min(columns, len(strips))
    across = max(len(strip.panels) for strip in strips)
    width = across * (_SIDE + _GAP) + 3 * _GAP
    height = _SIDE + 2 * _LINE + 2 * _GAP
    rows = -(-len(strips) // columns)
    sheet = Image.new("RGB", (columns * width + 3 * _GAP, rows * height + 3 * _GAP), _PAPER)
    for number, strip in enumerate(strips):
        place = (3 * _GAP + number % columns * width, 2 * _GAP + number // columns * height)
        _draw(sheet, strip, place)
    return sheet


def _draw(sheet: Image.Image, strip: Strip, place: tuple[int, int]) -> None:
    left, top = place
    draw, large, small = ImageDraw.Draw(sheet), ImageFont.load_default(18), ImageFont.load_default(13)
    width = max(len(strip.panels), 1) * (_SIDE + _GAP)
    draw.text((left, top), _cut(strip.title, large, width), _INK, large)
    draw.text((left, top + _LINE), _cut(strip.note, small, width), _FAINT, small)
    for number, (label, picture) in enumerate(strip.panels):
        x, y = left + number * (_SIDE + _GAP), top + 2 * _LINE - 4
        scale = _SIDE / max(picture.size)
        size = (max(round(picture.width * scale), 1), max(round(picture.height * scale), 1))
        sheet.paste(picture.convert("RGB").resize(size, Image.Resampling.LANCZOS), (x, y))
        draw.text((x + 5, y + 3), label, _INK, small, stroke_width=2, stroke_fill=(0, 0, 0))


def _cut(text: str, font: ImageFont.FreeTypeFont | ImageFont.ImageFont, width: int) -> str:
    """As much of a text as fits a width in pixels; what is left out is shown by dots."""
    if font.getlength(text) <= width:
        return text
    return next(f"{text[:n]}…" for n in range(len(text), -1, -1) if n == 0 or font.getlength(f"{text[:n]}…") <= width)
