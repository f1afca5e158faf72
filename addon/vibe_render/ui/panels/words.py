# SPDX-License-Identifier: GPL-3.0-or-later
"""The words of the prompt, each marked as understood, guessed or left out."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import bpy

from ...core.drawing import columns, paragraph
from ...core.schema_import import messages

_ICONS = {"understood": "CHECKMARK", "guessed": "QUESTION", "left out": "X"}
_ICON_LETTERS = 5  # room that an icon and its margins take, in letters


def draw(layout: bpy.types.UILayout, context: bpy.types.Context, readings: messages.Readings) -> None:
    """Draws the words as buttons, which tell more of each, in lines; and why nothing is understood, if so."""
    if readings.note:
        paragraph(layout, context, readings.note, "INFO", faint=True)
    column = layout.column(align=True)
    column.scale_y = 0.9
    for line in _lines(readings.words, columns(context)):
        row = column.row(align=True)
        row.alignment = "LEFT"
        for word in line:
            place = row.row(align=True)
            place.alignment, place.active = "LEFT", word.state != "left out"
            button = place.operator("vibe.reading", text=word.text, icon=_ICONS[word.state], emboss=False)
            button.key, button.state, button.meaning = word.key, word.state, word.meaning


def _lines(words: Iterable[messages.WordReading], width: int) -> Iterator[list[messages.WordReading]]:
    """Words in lines of so many letters, at least one in each."""
    line: list[messages.WordReading] = []
    used = 0
    for word in words:
        needed = len(word.text) + _ICON_LETTERS
        if line and used + needed > width:
            yield line
            line, used = [], 0
        line.append(word)
        used += needed
    if line:
        yield line
