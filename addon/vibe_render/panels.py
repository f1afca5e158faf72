# SPDX-License-Identifier: GPL-3.0-or-later
"""The "Vibe" tab in the 3D viewport's sidebar."""

from __future__ import annotations

import textwrap
from typing import Any, ClassVar

import bpy

from . import changes, operators, preview, snapshot
from .contract import schema
from .session import Session, desk


class _Tab:
    """Where every panel is."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Vibe"


class VIBE_PT_main(_Tab, bpy.types.Panel):
    """Prompt and button; progress while a vibe runs; what went wrong."""

    bl_label = "Vibe Render"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        layout, settings = self.layout, context.scene.vibe
        column = layout.column()
        column.enabled = not desk.running
        column.label(text="Mood")
        field = column.row()
        field.scale_y = 1.3
        field.prop(settings, "prompt", text="", placeholder="misty, cool blue fog, vignette")
        if desk.running and desk.session:
            _draw_progress(layout, desk.session)
            return
        column.prop(settings, "budget", expand=False)
        button = layout.row()
        button.scale_y = 1.8
        again = settings.changes and settings.prompt.strip() == settings.vibed_prompt
        button.operator("vibe.run", text="Vibe It Again" if again else "Vibe It", icon="SHADERFX")
        if desk.failure:
            _draw_failure(layout, context, desk.failure)
        elif reason := operators.obstacle(context):
            row = layout.row()
            row.active = False
            row.label(text=reason, icon="INFO")


def _draw_progress(layout: bpy.types.UILayout, session: Session) -> None:
    """The bar, the picture so far, and the way out."""
    box = layout.box()
    progress = session.progress
    if icon := preview.icon(session.preview):
        box.template_icon(icon_value=icon, scale=11.0)
    text = session.stage + "…"
    if progress and session.stage == "Looking for the look":
        text = f"Round {progress.round} of {progress.rounds}  ·  {_duration(progress.seconds_left)} left"
    box.progress(factor=session.fraction, text=text)
    row = box.row()
    row.scale_y = 1.3
    row.operator("vibe.stop", text="Stop & Keep Best", icon="CHECKMARK")
    hint = box.row()
    hint.active = False
    hint.alignment = "CENTER"
    hint.label(text="Esc cancels. Blender stays yours meanwhile.")


def _draw_failure(layout: bpy.types.UILayout, context: bpy.types.Context, failure: schema.VibeError) -> None:
    box = layout.box()
    row = box.row()
    row.alert = True
    row.label(text="The scene is as it was", icon="ERROR")
    row.operator("vibe.dismiss", text="", icon="X", emboss=False)
    _paragraph(box, context, failure.message)
    if failure.remedy:
        _paragraph(box, context, failure.remedy)


class VIBE_PT_result(_Tab, bpy.types.Panel):
    """What the last vibe did, and what to do with it."""

    bl_label = "Result"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only when there is one."""
        return snapshot.exists(context.scene) and not desk.running

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        layout, settings = self.layout, context.scene.vibe
        if settings.changes:
            row = layout.row(align=True)
            strength = row.row(align=True)
            strength.enabled = not settings.show_original
            strength.prop(settings, "strength", slider=True)
            row.prop(
                settings, "show_original", text="", icon="HIDE_OFF" if settings.show_original else "HIDE_ON"
            )
        row = layout.row(align=True)
        row.scale_y = 1.3
        row.operator("vibe.keep", icon="CHECKMARK")
        row.operator("vibe.revert", icon="LOOP_BACK")


class VIBE_PT_changes(_Tab, bpy.types.Panel):
    """Every value that changed: old, new, and why."""

    bl_label = "What Changed"
    bl_parent_id = "VIBE_PT_result"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only when there are changes."""
        return bool(context.scene.vibe.changes) and not desk.running

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        """How many there are."""
        self.layout.label(text=f"{len(context.scene.vibe.changes)} values")

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the list, and the chosen entry in full."""
        layout, settings = self.layout, context.scene.vibe
        layout.template_list("VIBE_UL_changes", "", settings, "changes", settings, "active_change", rows=7)
        if 0 <= settings.active_change < len(settings.changes):
            _draw_change(layout, context, settings.changes[settings.active_change])


def _draw_change(layout: bpy.types.UILayout, context: bpy.types.Context, change: Any) -> None:
    """Where the value is found in Blender, what it was, and the reason for the change."""
    row = changes.parameter(change.name)
    column = layout.box().column(align=True)
    column.label(text=changes.title(change.name), icon=changes.GROUPS[row.group][1])
    before, after = change.values()
    if row.kind != "color":
        column.label(text=f"{changes.text(change.name, before)}  →  {changes.text(change.name, after)}")
    if change.reason:
        _paragraph(column, context, change.reason)
    _paragraph(column, context, row.blender, dim=True)


class VIBE_UL_changes(bpy.types.UIList):
    """A line for each change."""

    def draw_item(self, context, layout, data, item, icon, active_data, active_property, index=0, flag=0):
        """Draws the line: icon, name, old, new."""
        parameter = changes.parameter(item.name)
        split = layout.split(factor=0.6)
        split.label(text=changes.title(item.name), icon=changes.GROUPS[parameter.group][1])
        row = split.row(align=True)
        before, after = item.values()
        if parameter.kind == "color":
            row.enabled = False
            row.prop(item, "before", text="")
            row.prop(item, "after", text="")
        else:
            row.alignment = "RIGHT"
            row.label(text=f"{changes.text(item.name, before)} → {changes.text(item.name, after)}")


class VIBE_PT_scope(_Tab, bpy.types.Panel):
    """What a vibe may change, and what the picture is about."""

    bl_label = "May Change"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        layout, settings = self.layout, context.scene.vibe
        layout.enabled = not desk.running
        grid = layout.grid_flow(columns=2, even_columns=True, align=True)
        for group in schema.GROUPS:
            free = getattr(settings, f"change_{group}")
            grid.prop(settings, f"change_{group}", toggle=True, icon="UNLOCKED" if free else "LOCKED")
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column()
        column.prop(settings, "lock", placeholder="light/Key, */metallic")
        column.prop(settings, "subject")
        if settings.subject == "COLLECTION":
            column.prop(settings, "collection", text=" ")


class VIBE_PT_effort(_Tab, bpy.types.Panel):
    """How hard to look."""

    bl_label = "Effort"
    bl_options: ClassVar[set[str]] = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        layout, settings = self.layout, context.scene.vibe
        layout.enabled = not desk.running
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column()
        column.prop(settings, "budget", text="Effort")
        if settings.budget == "CUSTOM":
            for name in ("rounds", "steps", "size"):
                column.prop(settings, name)
        column.prop(settings, "top_k")
        column.prop(settings, "seed")


def _paragraph(layout: bpy.types.UILayout, context: bpy.types.Context, text: str, dim: bool = False) -> None:
    """Text in as many lines as the sidebar is wide for."""
    scale = context.preferences.system.ui_scale
    column = layout.column(align=True)
    column.scale_y = 0.8
    column.active = not dim
    for line in textwrap.wrap(text, max(16, int(context.region.width / (7.5 * scale)) - 4)):
        column.label(text=line)


def _duration(seconds: float) -> str:
    return f"{seconds / 60:.0f} min" if seconds >= 90 else f"{max(seconds, 1):.0f} s"


CLASSES = (VIBE_PT_main, VIBE_PT_result, VIBE_UL_changes, VIBE_PT_changes, VIBE_PT_scope, VIBE_PT_effort)
