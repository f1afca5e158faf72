# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panel shows while a vibe runs."""

from __future__ import annotations

from collections.abc import Mapping

import bpy

from ...core import drawing
from ...core.drawing import paragraph
from ...run.live import Live
from ...run.session import PAUSING, SILENT, Session
from ...run.status import LOOKING
from .. import picture_icons


def draw(layout: bpy.types.UILayout, context: bpy.types.Context, session: Session) -> None:
    """The picture so far, the progress bar, Stop and Cancel; or a question."""
    box = layout.box()
    if session.scene != context.scene.name:
        box.label(text=f"In the scene {session.scene}", icon="SCENE_DATA")
    if session.question:
        _draw_question(box, context, session.question)
    else:
        if icon := picture_icons.icon(session.before, session.preview):
            box.template_icon(icon_value=icon, scale=11.5)
        box.progress(factor=session.fraction, text=_stage(session))
        if session.words:
            paragraph(
                box,
                context,
                _open_words(session.words),
                "CHECKMARK" if all(session.words.values()) else "TIME",
            )
        for note in session.view_notes:
            paragraph(box, context, note, "ERROR")
        if session.silence > SILENT:
            note = f"No word from the engine for {drawing.duration(session.silence)}. Wait, or cancel: "
            paragraph(box, context, f"{note}the next vibe starts a new one.", "ERROR")
    if session.look:
        drawing.see_rendered(box, context)
    buttons = box.column(align=True)
    buttons.scale_y = 1.3
    if not session.question:
        buttons.operator("vibe.stop", text="Stop and Use Best", icon="CHECKMARK")
    buttons.operator("vibe.cancel", icon="X")
    hint = box.row()
    hint.active, hint.alignment = False, "CENTER"
    esc = "Esc stops and uses the best" if session.can_stop else "Esc cancels"
    hint.label(text="Blender pauses for a moment" if session.stage in PAUSING else esc)


def draw_live(layout: bpy.types.UILayout, context: bpy.types.Context, live: Live) -> None:
    """The look of the words so far, and which of them it does not show."""
    if not live.look:
        return
    box = layout.box()
    if icon := picture_icons.icon(live.before, live.preview):
        box.template_icon(icon_value=icon, scale=8.5)
    if live.words:
        _draw_words(box, context, live.words)
    drawing.see_rendered(box, context)


def _draw_words(layout: bpy.types.UILayout, context: bpy.types.Context, words: Mapping[str, bool]) -> None:
    paragraph(layout, context, _open_words(words), "CHECKMARK" if all(words.values()) else "TIME")


def _open_words(words: Mapping[str, bool]) -> str:
    """Which words the look so far does not show."""
    missing = [word for word, shown in words.items() if not shown]
    if not missing:
        return "The look so far shows all words" if len(words) > 1 else "The look so far shows the word"
    verb = "does" if len(missing) == 1 else "do"
    return f"{len(missing)} of {len(words)} words {verb} not show yet: {', '.join(missing)}"


def _stage(session: Session) -> str:
    progress = session.progress
    if progress and session.stage == LOOKING:
        left = drawing.duration(progress.seconds_left)
        return f"Round {progress.round} of {progress.rounds}  ·  {left} left"
    return f"{session.stage}…"


def _draw_question(
    layout: bpy.types.UILayout, context: bpy.types.Context, question: dict[str, list[str]]
) -> None:
    """The shared materials, and the two answers."""
    paragraph(layout, context, "The subject shares materials with other things:", "QUESTION")
    for name, users in list(question.items())[:4]:
        more = f" and {len(users) - 2} more" if len(users) > 2 else ""
        paragraph(layout, context, f"{name}, also on {', '.join(users[:2])}{more}", "MATERIAL")
    if len(question) > 4:
        layout.label(text=f"and {len(question) - 4} more materials", icon="BLANK1")
    column = layout.column(align=True)
    column.scale_y = 1.2
    column.operator("vibe.answer", text="Affect All Users", icon="LINKED").shared = "ALL"
    column.operator("vibe.answer", text="Make Single-User", icon="UNLINKED").shared = "SINGLE"
