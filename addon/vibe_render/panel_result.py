# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel of a result: pictures, variants, strength, what changed and why."""

from __future__ import annotations

import math
from itertools import groupby
from typing import Any

import bpy

from . import changes, preview, result_operators, snapshot
from .contract import labels, schema
from .desk import desk
from .drawing import GROUP_ICONS, columns, paragraph
from .session import Session
from .value_list import draw_lock

_VISIBLE = 3.0
"""Mean CIEDE2000 from which a prediction and a render look different side by side."""


class Result:
    """What the last vibe did, and what to do with it."""

    bl_label = "Result"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only when there is one."""
        return snapshot.exists(context.scene) and not desk.running

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        layout, settings = self.layout, context.scene.vibe  # type: ignore[attr-defined]
        if not settings.vibed_prompt:
            paragraph(layout, context, "A vibe has been in this scene; Revert takes away what is left of it.")
        elif settings.vibed_prompt != settings.prompt.strip():
            paragraph(layout, context, f"“{settings.vibed_prompt}”")
        if desk.session and desk.session.scene == context.scene.name:
            _draw_session(layout, context, desk.session)
        if settings.changes:
            _draw_compare(layout, context)
        grid = layout.column(align=True)
        grid.scale_y = 1.3
        row = grid.row(align=True)
        row.operator("vibe.keep", icon="CHECKMARK")
        row.operator("vibe.revert", icon="LOOP_BACK")
        row = grid.row(align=True)
        row.operator("vibe.run", text="Again", icon="FILE_REFRESH").again = True
        row.operator("vibe.preset_save", text="Save Preset", icon="PRESET_NEW")
        if reason := result_operators.why_not(context):
            paragraph(layout, context, reason, "INFO", faint=True)
        if desk.session and desk.session.scene == context.scene.name:
            for note in [*desk.session.remarks, *desk.session.notes][:4]:  # below what is always there
                paragraph(layout, context, note, "INFO", faint=True)


def _draw_compare(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """The way between the original and the vibe, in the scene itself."""
    settings = context.scene.vibe
    column = layout.column(align=True)
    row = column.row(align=True)
    row.prop(settings, "show_original", text="Before", toggle=True)
    row.prop(settings, "show_original", text="After", toggle=True, invert_checkbox=True)
    strength = column.row(align=True)
    strength.enabled = not settings.show_original
    strength.prop(settings, "strength", slider=True)
    if context.space_data and context.space_data.type == "VIEW_3D":
        shading = context.space_data.shading
        if shading.type != "RENDERED":
            column.prop_enum(shading, "type", "RENDERED", text="See It Rendered")


def _draw_session(layout: bpy.types.UILayout, context: bpy.types.Context, session: Session) -> None:
    """What is known only as long as Blender runs: pictures, variants, how good the prediction is."""
    current = context.scene.vibe.variant
    picture = session.variants[current][1] if 0 < current < len(session.variants) else session.preview
    if icon := preview.icon(session.before, picture):
        layout.template_icon(icon_value=icon, scale=10.5)
        if session.before:
            row = layout.row()
            row.active, row.alignment, row.scale_y = False, "CENTER", 0.7
            row.label(text="Above: before. Below: after, as predicted")
    if len(session.variants) > 1:
        _draw_variants(layout, session, current)
    if session.agreement is not None and not current:
        tenths = max(math.ceil(session.agreement * 10.0), 1)
        close = session.agreement < _VISIBLE
        text = f"{'Matches' if close else 'Differs from'} Cycles (ΔE {tenths / 10.0:.1f})"
        layout.label(text=text, icon="CHECKMARK" if close else "INFO")


def _draw_variants(layout: bpy.types.UILayout, session: Session, current: int) -> None:
    """The looks to choose from, each a picture with a button."""
    across = min(len(session.variants), 4)
    grid = layout.grid_flow(row_major=True, columns=across, even_columns=True, align=True)
    for number, (_, picture) in enumerate(session.variants):
        cell = grid.column(align=True)
        if icon := preview.icon(picture):
            cell.template_icon(icon_value=icon, scale=max(10.4 / across, 3.2))
        button = cell.operator("vibe.variant", text=str(number + 1), depress=number == current)
        button.number = number


class Changes:
    """Every value that changed: old, new, and why; one heading for each light, material and so on."""

    bl_label = "What Changed and Why"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only when there are changes."""
        return bool(context.scene.vibe.changes) and not desk.running

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        """How many there are."""
        row = self.layout.row(align=True)  # type: ignore[attr-defined]
        row.label(text=str(len(_visible(context))))
        row.prop(context.scene.vibe, "show_reasons", text="", icon="INFO", emboss=False)

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the list."""
        layout = self.layout  # type: ignore[attr-defined]
        for number, ((group, owner), entries) in enumerate(groupby(_visible(context), key=_owner)):
            if number:
                layout.separator(factor=0.3)
            name, icon = labels.GROUP_TITLES[group], GROUP_ICONS[group]
            column = layout.column(align=True)
            column.label(text=owner or name, icon=icon)
            for entry in entries:
                _draw_change(column, context, entry)


def _visible(context: bpy.types.Context) -> list[Any]:
    """The changes that show in the numbers."""
    return [c for c in context.scene.vibe.changes if not labels.same(c.name, *c.values())]


def _owner(change: Any) -> tuple[str, str]:
    return schema.split_key(change.name)[:2]


def _draw_change(layout: bpy.types.UILayout, context: bpy.types.Context, change: Any) -> None:
    """Name, old and new value, a lock; below, the word that caused it."""
    settings, parameter = context.scene.vibe, labels.parameter(change.name)
    row = layout.row(align=True)
    split = row.split(factor=0.44, align=True)
    split.label(text=labels.words(parameter.name))
    values = split.row(align=True)
    before, after = change.values()
    if parameter.kind == "color":
        values.enabled = False
        values.prop(change, "before", text="")
        values.prop(change, "after", text="")
    else:
        values.alignment = "RIGHT"
        values.label(text=changes.arrow(change.name, before, after))
    draw_lock(row, settings, change.name)
    if settings.show_reasons and change.reason:
        _draw_reason(layout, context, change)


def _draw_reason(layout: bpy.types.UILayout, context: bpy.types.Context, change: Any) -> None:
    """The reason in one faint line; all of it is the line's tool tip."""
    most = columns(context)
    text = change.reason if len(change.reason) <= most else f"{change.reason[: most - 1].rstrip()}…"
    row = layout.row()
    row.active, row.alignment, row.scale_y = False, "LEFT", 0.75
    row.operator("vibe.why", text=text, emboss=False).key = change.name
