# SPDX-License-Identifier: Apache-2.0
"""The paper's blind judge (section 4.1): a model decides which of two rows of images follows the prompts better."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

from PIL import Image, ImageDraw, ImageFont, ImageOps

from .client import Client, Question, jpeg_of
from .transport import ModelError, clean

INSTRUCTIONS = """\
Unpaired Text-to-Appearance Evaluation Instructions
Role: You are an evaluator for an unpaired text-to-appearance task.
You will see ONE 2×3 comparison figure:
• Top row = Ours
• Bottom row = CLIP-only
• Columns are three objects: Dolphin, Teapot, Tree.
• Each column has its target prompt shown under the images.
Task: Decide which method is better overall across the 3 objects.
How to judge (only what is visible):
• Prompt adherence: color, material (glossy/matte), lighting, fog/no-fog, vignette, background
• Object visibility: object should be clearly visible (not too dark or washed out)
• Attribute correctness matters more than aesthetics
Output format (strict):
WINNER = OURS or CLIP-ONLY or TIE
REASON = one sentence summary"""
"""The paper's evaluation prompt, verbatim."""

PAPER = ("Dolphin", "Teapot", "Tree")
ROWS = ("Ours", "CLIP-only")
BEFORE_AFTER = ("After", "Before")

_CELL, _MARGIN, _LINE = 384, 16, 24
_PAPER_COLOR, _INK, _FAINT = (250, 250, 248), (32, 32, 36), (120, 120, 126)
_NUMBERS = ("zero", "one", "two", "three", "four", "five", "six")


@dataclass(frozen=True)
class Column:
    """A column of the comparison figure: two images of one object."""

    name: str  # of the object
    prompt: str  # the prompt of both images
    top: Image.Image  # the first row's image
    bottom: Image.Image  # the second row's image


@dataclass(frozen=True)
class Verdict:
    """A judge's decision."""

    winner: str  # a row's name in capitals, or "TIE"
    reason: str  # one sentence


def judge(client: Client, columns: Sequence[Column], rows: tuple[str, str] = ROWS, fresh: bool = False) -> Verdict:
    """Asks a model, in the paper's words, which row of a figure is better. Raises ModelError without a verdict."""
    text = instructions([c.name for c in columns], rows)
    question = Question(text, "The comparison figure:", jpeg_of(figure(columns, rows)), must_see=True)
    return read_verdict(client.ask(question, lambda reply: read_verdict(reply, rows), fresh), rows)


def instructions(names: Sequence[str], rows: tuple[str, str] = ROWS) -> str:
    """The evaluation prompt for a figure; for the paper's own figure it is the paper's word for word."""
    count = len(names)
    many = "objects" if count > 1 else "object"
    return (
        INSTRUCTIONS.replace("2×3", f"2×{count}")
        .replace("Columns are three objects", f"Columns are {_NUMBERS[count]} {many}")
        .replace(", ".join(PAPER), ", ".join(clean(n, 40) for n in names))
        .replace("the 3 objects", f"the {count} {many}")
        .replace("Top row = Ours", f"Top row = {rows[0]}")
        .replace("Bottom row = CLIP-only", f"Bottom row = {rows[1]}")
        .replace("OURS or CLIP-ONLY", f"{rows[0].upper()} or {rows[1].upper()}")
    )


def read_verdict(text: str, rows: tuple[str, str] = ROWS) -> Verdict:
    """The verdict in an answer; bold marks, a colon for the equals sign and other lines are tolerated.

    Raises ModelError if the answer does not name exactly one winner.
    """
    plain = text.rpartition("</think>")[2].replace("*", "").replace("`", "")
    options = "|".join(re.escape(name.upper()) for name in (*rows, "TIE"))
    winners = re.findall(rf"^\W*WINNER\s*[=:]\s*({options})\W*$", plain, re.IGNORECASE | re.MULTILINE)
    reasons = re.findall(r"^\W*REASON\s*[=:]\s*(.+)$", plain, re.IGNORECASE | re.MULTILINE)
    if len({w.upper() for w in winners}) != 1:
        raise ModelError("The judge's answer names no winner.", "Use a larger model.")
    return Verdict(winners[0].upper(), clean(reasons[0], 400) if reasons else "")


def figure(columns: Sequence[Column], rows: tuple[str, str] = ROWS) -> Image.Image:
    """The comparison figure: two rows of images, a column for each object, its prompt under it."""
    font, small = ImageFont.load_default(20), ImageFont.load_default(17)
    lines = [_wrapped(f"{c.name}: {c.prompt}", small) for c in columns]
    left, top = 110, _MARGIN
    width = left + len(columns) * (_CELL + _MARGIN)
    height = top + 2 * (_CELL + _MARGIN) + _LINE * max(map(len, lines)) + _MARGIN
    sheet = Image.new("RGB", (width, height), _PAPER_COLOR)
    draw = ImageDraw.Draw(sheet)
    tops = top, top + _CELL + _MARGIN  # of the rows
    for name, y in zip(rows, tops, strict=True):
        draw.text((left / 2, y + _CELL / 2), name, _FAINT, font, anchor="mm")
    for index, column in enumerate(columns):
        x = left + index * (_CELL + _MARGIN)
        for whole, y in zip((column.top, column.bottom), tops, strict=True):
            picture = ImageOps.contain(whole.convert("RGB"), (_CELL, _CELL), Image.Resampling.LANCZOS)
            sheet.paste(picture, (x + (_CELL - picture.width) // 2, y + (_CELL - picture.height) // 2))
        for number, line in enumerate(lines[index]):
            below = top + 2 * (_CELL + _MARGIN) + (number + 0.5) * _LINE
            draw.text((x + _CELL / 2, below), line, _INK, small, anchor="mm")
    return sheet


def _wrapped(text: str, font: ImageFont.FreeTypeFont | ImageFont.ImageFont) -> list[str]:
    """Lines that fit under a column; at most eight."""
    lines = [""]
    for word in clean(text, 1000).split():
        if lines[-1] and font.getlength(f"{lines[-1]} {word}") > _CELL:
            lines.append("")
        lines[-1] = f"{lines[-1]} {word}".strip()
    return lines[:8]
