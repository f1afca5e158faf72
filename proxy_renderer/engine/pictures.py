# SPDX-License-Identifier: Apache-2.0
"""Image files: reading, writing, and sheets of labeled panels."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image, ImageDraw

from ..schema import atomic
from .lettering import font, wrapped

if TYPE_CHECKING:
    from torch import Tensor

_PANEL = 512
_MARGIN = 24
_PAPER, _INK, _FAINT = (250, 250, 248), (32, 32, 36), (120, 120, 126)


def save_picture(picture: Tensor, path: Path) -> None:
    """Writes (H, W, 3) or (H, W) in [0, 1] as an 8-bit PNG, all at once or not at all.

    Args:
        picture: As for `image`.

    Raises:
        OSError: It cannot be written.
    """
    save_image(image(picture), path)


def image(picture: Tensor) -> Image.Image:
    """An 8-bit image of a picture (H, W, 3) or (H, W) in [0, 1]; what is outside is clipped."""
    data = (picture.detach().cpu().numpy().clip(0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)
    return Image.fromarray(data)


def save_image(image: Image.Image, path: Path) -> None:
    """Writes a PNG, all at once or not at all.

    Args:
        image: 8-bit, of any mode.

    Raises:
        OSError: It cannot be written.
    """
    with atomic.replacing(path) as part:
        image.save(part, format="PNG")


def load_picture(path: Path) -> np.ndarray:
    """Reads a picture as (H, W, 3) float32 in [0, 1]; what is transparent shows black."""
    with Image.open(path) as image:
        flat = Image.alpha_composite(Image.new("RGBA", image.size, (0, 0, 0, 255)), image.convert("RGBA"))
    return np.asarray(flat.convert("RGB"), np.float32) / 255.0


def compare(rows: Sequence[Sequence[tuple[str, Image.Image]]], prompt: str, fonts: Path) -> Image.Image:
    """Labeled panels side by side, rows of them one below the other, the prompt at the foot.

    Args:
        rows: (label, picture), from left to right; all in a row are as high as the first.
        prompt: Long ones are wrapped, and cut after four lines; "" for none.
    """
    title = font(26, prompt, fonts)
    label = font(18, "".join(name for row in rows for name, _ in row), fonts)
    sizes = [[_fitted(picture, _fitted(row[0][1])[1]) for _, picture in row] for row in rows]
    total = max(sum(width + _MARGIN for width, _ in row) for row in sizes) + _MARGIN
    lines = wrapped(f"“{prompt}”", title, total - 2 * _MARGIN, 4) if prompt.strip() else []
    head = 2 * _MARGIN + 8
    height = sum(head + row[0][1] for row in sizes)
    sheet = Image.new("RGB", (total, height + _MARGIN + 36 * len(lines) + _MARGIN), _PAPER)
    draw, top = ImageDraw.Draw(sheet), 0
    for row, row_sizes in zip(rows, sizes, strict=True):
        x = _MARGIN
        for (name, picture), size in zip(row, row_sizes, strict=True):
            draw.text((x + size[0] / 2, top + head / 2 + 2), name, _FAINT, label, anchor="mm")
            sheet.paste(picture.convert("RGB").resize(size, Image.Resampling.LANCZOS), (x, top + head))
            x += size[0] + _MARGIN
        top += head + row_sizes[0][1]
    for i, line in enumerate(lines):
        draw.text((total / 2, top + _MARGIN + 18 + 36 * i), line, _INK, title, anchor="mm")
    return sheet


def _fitted(picture: Image.Image, high: int = 0) -> tuple[int, int]:
    """Width and height of a panel that shows a picture; of a given height, if that is not 0."""
    width, height = picture.size
    scale = high / height if high else _PANEL / max(width, height)
    return max(round(width * scale), 1), max(round(height * scale), 1)
