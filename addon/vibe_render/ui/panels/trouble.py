# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panel shows when the engine is missing or a vibe failed, with the remedy."""

from __future__ import annotations

import bpy

from ...core import ADDON, preferences
from ...core.drawing import paragraph
from ...core.schema_import import schema
from ...run.engine_state import engine_state
from .. import engine_line


def draw_failure(layout: bpy.types.UILayout, context: bpy.types.Context, failure: schema.VibeError) -> None:
    """A vibe's failure, and its remedy."""
    box = layout.box()
    row = box.row()
    row.alert = True
    row.label(text="The scene is as it was", icon="ERROR")
    row.operator("vibe.dismiss", text="", icon="X", emboss=False)
    paragraph(box, context, failure.message)
    if failure.remedy:
        paragraph(box, context, failure.remedy)
    if engine_state.problem:
        _engine_buttons(box)
    else:
        box.operator("preferences.addon_show", text="Preferences", icon="PREFERENCES").module = ADDON


def draw_no_engine(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """How to get an engine."""
    box = layout.box()
    box.label(text="One more step: the engine", icon="INFO")
    if engine_state.setting_up:
        engine_line.draw(box)
        return
    paragraph(
        box,
        context,
        "It turns words into looks. Set Up Engine downloads it once, and says how much first. Presets, strength, "
        "compare and revert work without it.",
    )
    if (
        engine_state.outcome
        and not engine_state.succeeded
        and engine_state.outcome != str(engine_state.problem)
    ):  # the buttons say what to do
        paragraph(box, context, engine_state.outcome, "ERROR")
    _engine_buttons(box)


def _engine_buttons(layout: bpy.types.UILayout) -> None:
    column = layout.column(align=True)
    column.scale_y = 1.2
    column.operator("vibe.setup_engine", icon="IMPORT")
    if not preferences.online():
        column.operator("extensions.userpref_show_online", text="Allow Online Access…", icon="INTERNET")
    row = column.row(align=True)
    row.operator("vibe.look_for_engine", icon="FILE_REFRESH")
    row.operator("preferences.addon_show", text="Preferences", icon="PREFERENCES").module = ADDON
