# SPDX-License-Identifier: Apache-2.0
"""The paper's figures, from the pictures of the first seed."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont, ImageOps

from lab.bench.paper.pairs import Pair
from proxy_renderer.engine.pictures import save_image
from proxy_renderer.vlm import judge
from proxy_renderer.vlm.transport import clean

_CELL, _MARGIN, _LINE = 384, 16, 24
_LETTERS = 44  # that fit under a column
_PAPER_COLOR, _INK, _FAINT = (250, 250, 248), (32, 32, 36), (120, 120, 126)


@dataclass(frozen=True)
class Column:
    """One object's two pictures."""

    name: str  # of the object
    prompt: str  # what both were asked for
    top: Image.Image  # the first row's picture
    bottom: Image.Image  # the second row's


def columns(rows: Sequence[tuple[Pair, Path, Path]]) -> list[Column]:
    """The judge's columns, one for each pair.

    Args:
        rows: The pair, and the folders of its two runs.
    """
    return [Column(_name(pair), pair.prompt, picture(a), picture(b)) for pair, a, b in rows]


def save_benchmark(rows: Sequence[tuple[Pair, Path, Path]], path: Path) -> None:
    """Figure 2: two rows, ours and CLIP-only, a column for each object with its prompt.

    Args:
        rows: Pair, folder of our run and folder of the CLIP-only run.
    """
    save_image(figure(columns(rows)), path)


def save_ablation(rows: Sequence[tuple[Pair, Path]], path: Path) -> None:
    """Figures 3 and 4: what each prompt made of the artist's picture, above it.

    Args:
        rows: Pair and folder of its run.
    """
    columns = [
        Column(pair.name, pair.prompt, picture(folder), picture(folder, "before")) for pair, folder in rows
    ]
    save_image(figure(columns, ("Ours", "Before")), path)


def figure(columns: Sequence[Column], rows: tuple[str, str] = judge.ROWS) -> Image.Image:
    """The comparison figure: two rows of pictures, a column for each object, its prompt under it."""
    font, small = ImageFont.load_default(20), ImageFont.load_default(17)
    lines = [textwrap.wrap(clean(f"{c.name}: {c.prompt}", 1000), _LETTERS)[:8] for c in columns]
    left, top = 110, _MARGIN
    width = left + len(columns) * (_CELL + _MARGIN)
    height = top + 2 * (_CELL + _MARGIN) + _LINE * max(map(len, lines)) + _MARGIN
    sheet = Image.new("RGB", (width, height), _PAPER_COLOR)
    draw = ImageDraw.Draw(sheet)
    for row, name in enumerate(rows):
        y = top + row * (_CELL + _MARGIN)
        draw.text((left / 2, y + _CELL / 2), name, _FAINT, font, anchor="mm")
        for index, column in enumerate(columns):
            whole = (column.top, column.bottom)[row].convert("RGB")
            picture = ImageOps.contain(whole, (_CELL, _CELL), Image.Resampling.LANCZOS)
            x = left + index * (_CELL + _MARGIN)
            sheet.paste(picture, (x + (_CELL - picture.width) // 2, y + (_CELL - picture.height) // 2))
    for index, text in enumerate(lines):
        middle = left + index * (_CELL + _MARGIN) + _CELL / 2
        for number, line in enumerate(text):
            below = top + 2 * (_CELL + _MARGIN) + (number + 0.5) * _LINE
            draw.text((middle, below), line, _INK, small, anchor="mm")
    return sheet


def picture(folder: Path, which: str = "after") -> Image.Image:
    """A run's picture.

    Args:
        which: "before" for the artist's, "after" for the result.
    """
    with Image.open(folder / f"{which}.png") as image:
        return image.convert("RGB")


def _name(pair: Pair) -> str:
    return pair.name.replace("_", " ").capitalize()
