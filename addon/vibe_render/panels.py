# SPDX-License-Identifier: GPL-3.0-or-later
"""The "Vibe" tab in the 3D viewport's sidebar."""

from __future__ import annotations

import math
import textwrap
from itertools import groupby
from typing import Any, ClassVar

import bpy

from . import changes, operators, preview, snapshot
from .contract import schema
from .session import LOOKING, Session, desk


class _Tab(bpy.types.Panel):
    """Where every panel is."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Vibe"


class _IdleTab(_Tab):
    """A panel that makes way while a vibe runs."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Not while a vibe runs."""
        return not desk.running


class VIBE_PT_main(_Tab):
    """Prompt and button; progress while a vibe runs; what went wrong."""

    bl_label = "Vibe Render"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        layout, settings = self.layout, context.scene.vibe
        column = layout.column()
        column.enabled = not desk.running
        column.label(text="Describe the mood")
        field = column.row()
        field.scale_y = 1.3
        field.prop(settings, "prompt", text="", placeholder="misty, cool blue fog, vignette")
        if desk.running and desk.session:
            _draw_progress(layout, desk.session)
            return
        column.prop(settings, "budget")
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
    if icon := preview.icon(session.preview):
        box.template_icon(icon_value=icon, scale=9.0)
    text, progress = session.stage + "…", session.progress
    if progress and session.stage == LOOKING:
        text = f"Round {progress.round} of {progress.rounds}  ·  {_duration(progress.seconds_left)} left"
    box.progress(factor=session.fraction, text=text)
    row = box.row()
    row.scale_y = 1.3
    row.operator("vibe.stop", text="Stop and Use Best", icon="CHECKMARK")
    hint = box.row()
    hint.active = False
    hint.alignment = "CENTER"
    hint.label(text="Esc cancels")


def _draw_failure(layout: bpy.types.UILayout, context: bpy.types.Context, failure: schema.VibeError) -> None:
    box = layout.box()
    row = box.row()
    row.alert = True
    row.label(text="The scene is as it was", icon="ERROR")
    row.operator("vibe.dismiss", text="", icon="X", emboss=False)
    _paragraph(box, context, failure.message)
    if failure.remedy:
        _paragraph(box, context, failure.remedy)
    box.operator("preferences.addon_show", text="Preferences", icon="PREFERENCES").module = __package__


class VIBE_PT_result(_IdleTab):
    """What the last vibe did, and what to do with it."""

    bl_label = "Result"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only when there is one."""
        return snapshot.exists(context.scene) and not desk.running

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        layout, settings = self.layout, context.scene.vibe
        if settings.vibed_prompt:
            _paragraph(layout, context, f"“{settings.vibed_prompt}”")
        if desk.session and (icon := preview.icon(desk.session.preview)):
            layout.template_icon(icon_value=icon, scale=7.0)
        if desk.session:
            _draw_agreement(layout, context, desk.session)
        if settings.changes:
            column = layout.column()
            strength = column.row()
            strength.enabled = not settings.show_original
            strength.prop(settings, "strength", slider=True)
            row = column.row(align=True)
            row.prop(settings, "show_original", text="Original", toggle=True, icon="LOOP_BACK")
            row.prop_enum(context.space_data.shading, "type", "RENDERED", text="Rendered")
        row = layout.row(align=True)
        row.scale_y = 1.3
        row.operator("vibe.keep", icon="CHECKMARK")
        row.operator("vibe.revert", icon="X")


def _draw_agreement(layout: bpy.types.UILayout, context: bpy.types.Context, session: Session) -> None:
    """How near the prediction came to the last small picture of Cycles; 1 is about the least that people see."""
    if session.agreement is not None:
        tenths = max(math.ceil(session.agreement * 10.0), 1)
        layout.label(text=f"Small Cycles picture: within {tenths / 10.0:.1f} ΔE", icon="CHECKMARK")
    for note in session.notes[:2]:
        _paragraph(layout, context, note)


class VIBE_PT_changes(_IdleTab):
    """Every value that changed: old, new, and why; one heading for each light, material and so on."""

    bl_label = "What Changed"
    bl_parent_id = "VIBE_PT_result"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only when there are changes."""
        return bool(context.scene.vibe.changes)

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        """How many there are."""
        self.layout.label(text=f"{len(_visible(context))} values ")

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the list."""
        layout = self.layout
        for (group, owner), entries in groupby(_visible(context), key=_owner):
            name, icon = changes.GROUPS[group]
            column = layout.column(align=True)
            column.label(text=owner or name, icon=icon)
            for entry in entries:
                _draw_change(column, entry)


def _visible(context: bpy.types.Context) -> list[Any]:
    """The changes that show in the numbers."""
    return [c for c in context.scene.vibe.changes if not changes.same(c.name, *c.values())]


def _owner(change: Any) -> tuple[str, str]:
    return schema.split_key(change.name)[:2]


def _draw_change(layout: bpy.types.UILayout, change: Any) -> None:
    """A line: name, old, new, and an icon that tells why."""
    parameter = changes.parameter(change.name)
    row = layout.row(align=True)
    split = row.split(factor=0.44, align=True)
    split.label(text=changes.words(parameter.name))
    values = split.row(align=True)
    before, after = change.values()
    if parameter.kind == "color":
        values.enabled = False
        values.prop(change, "before", text="")
        values.prop(change, "after", text="")
    else:
        values.alignment = "RIGHT"
        values.label(text=changes.arrow(change.name, before, after))
    row.operator("vibe.why", text="", icon="INFO", emboss=False).key = change.name


class VIBE_PT_scope(_IdleTab):
    """What a vibe may change, and what the picture is about."""

    bl_label = "May Change"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        layout, settings = self.layout, context.scene.vibe
        grid = layout.grid_flow(columns=2, even_columns=True, align=True)
        for group in schema.GROUPS:
            free = getattr(settings, f"change_{group}")
            grid.prop(settings, f"change_{group}", toggle=True, icon="UNLOCKED" if free else "LOCKED")
        column = layout.column()
        column.prop(settings, "subject")
        if settings.subject == "COLLECTION":
            column.prop(settings, "collection", text="")


class VIBE_PT_advanced(_IdleTab):
    """Numbers that few need."""

    bl_label = "Advanced"
    bl_options: ClassVar[set[str]] = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        layout, settings = self.layout, context.scene.vibe
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column()
        column.prop(settings, "lock", placeholder="light/Key, */metallic")
        column.prop(settings, "top_k")
        column.prop(settings, "seed")
        column.prop(settings, "anchor")
        column = layout.column()
        column.active = settings.budget == "CUSTOM"
        column.prop(settings, "budget")
        for name in ("rounds", "steps", "size"):
            column.prop(settings, name)


def _paragraph(layout: bpy.types.UILayout, context: bpy.types.Context, text: str) -> None:
    """Text in as many lines as the sidebar is wide for."""
    scale = context.preferences.system.ui_scale
    column = layout.column(align=True)
    column.scale_y = 0.8
    width = max(16, int(context.region.width / (7.5 * scale)) - 4)
    for line in textwrap.wrap(text, width, break_on_hyphens=False):
        column.label(text=line)


def _duration(seconds: float) -> str:
    for size, unit in ((3600, "h"), (60, "min")):
        if seconds >= 1.5 * size:
            return f"{seconds / size:.0f} {unit}"
    return f"{max(seconds, 1):.0f} s"


CLASSES = (VIBE_PT_main, VIBE_PT_result, VIBE_PT_changes, VIBE_PT_scope, VIBE_PT_advanced)
