# SPDX-License-Identifier: Apache-2.0
"""The paper's blind judge (section 4.1): a model says which of two rows of pictures follows its prompts better."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from PIL import Image

from .client import Client, Question, jpeg_of
from .transport import ModelError, clean

INSTRUCTIONS = Path(__file__).with_name("judge.txt").read_text("utf-8").strip()
"""The paper's evaluation prompt, verbatim."""

PAPER = ("Dolphin", "Teapot", "Tree")
ROWS = ("Ours", "CLIP-only")
BEFORE_AFTER = ("After", "Before")

_NUMBERS = ("zero", "one", "two", "three", "four", "five", "six")


@dataclass(frozen=True)
class Verdict:
    """A judge's decision."""

    winner: str  # a row's name in capitals, or "TIE"
    reason: str  # one sentence


def judge(
    client: Client,
    figure: Image.Image,
    names: Sequence[str],
    rows: tuple[str, str] = ROWS,
    fresh: bool = False,
) -> Verdict:
    """Asks a model which row of a figure is better, in the paper's words; raises ModelError if it gives no verdict.

    The figure has a column for each of the named objects.
    """
    question = Question(instructions(names, rows), "The comparison figure:", jpeg_of(figure), must_see=True)
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
    r"""Reads a verdict; bold marks, a colon for the equals sign and other lines are tolerated.

    Raises:
        ModelError: The answer names no winner, or more than one.

    Example:
        >>> read_verdict("**WINNER: Ours**\nREASON = softer light").winner
        'OURS'
    """
    plain = text.rpartition("</think>")[2].replace("*", "").replace("`", "")
    options = "|".join(re.escape(name.upper()) for name in (*rows, "TIE"))
    winners = re.findall(rf"^\W*WINNER\s*[=:]\s*({options})\W*$", plain, re.IGNORECASE | re.MULTILINE)
    reasons = re.findall(r"^\W*REASON\s*[=:]\s*(.+)$", plain, re.IGNORECASE | re.MULTILINE)
    if len({w.upper() for w in winners}) != 1:
        raise ModelError("The judge's answer names no winner.", "Use a larger model.")
    return Verdict(winners[0].upper(), clean(reasons[0], 400) if reasons else "")
