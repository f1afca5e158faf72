# SPDX-License-Identifier: GPL-3.0-or-later
"""The "Presets" panel: a grid of pictures to choose a look from, and what can be done with it."""

from __future__ import annotations

import textwrap

import bpy

from . import library, preset_pictures
from .session import desk

_CELL = 92.0  # pixels that a picture wants, at a scale of 1
_UNIT = 20.0  # pixels of a button's height
_SHOWN = 5  # lines of what did not fit


class VIBE_MT_preset(bpy.types.Menu):
    """What can be done with the chosen preset."""

    bl_label = "Preset"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the menu."""
        layout = self.layout
        layout.operator_context = "INVOKE_DEFAULT"
        layout.operator("vibe.preset_rename", text="Rename…", icon="GREASEPENCIL")
        layout.operator("vibe.preset_export", text="Export…", icon="EXPORT")
        layout.separator()
        layout.operator("vibe.preset_delete", text="Delete…", icon="TRASH")


class VIBE_MT_presets(bpy.types.Menu):
    """What can be done with all presets, and with the look that the scene has now."""

    bl_label = "Presets"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the menu."""
        layout = self.layout
        layout.operator_context = "INVOKE_DEFAULT"
        layout.operator("vibe.preset_import", text="Import…", icon="IMPORT")
        layout.operator("wm.path_open", text="Open Folder", icon="FILE_FOLDER").filepath = str(
            library.folder()
        )
        layout.separator()
        layout.operator("vibe.export_assets", text="Export Look as Assets…", icon="ASSET_MANAGER")
        layout.operator("vibe.export_lut", text="Export Grade as LUT…", icon="COLOR")


class VIBE_PT_presets(bpy.types.Panel):
    """The grid, and below it the chosen preset."""

    bl_label = "Presets"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Vibe"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Not while a vibe runs."""
        return not desk.running

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        """The menu."""
        self.layout.menu("VIBE_MT_presets", text="", icon="COLLAPSEMENU")

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        layout, held = self.layout, context.window_manager.vibe_presets
        row = layout.row(align=True)
        row.prop(held, "search", text="", icon="VIEWZOOM", placeholder="Search")
        row.operator_context = "INVOKE_DEFAULT"
        row.operator("vibe.preset_save", text="", icon="ADD")
        found = library.looks(held.search)
        if not found:
            row = layout.row()
            row.active, row.alignment = False, "CENTER"
            row.label(text="No preset has these words")
            return
        _draw_grid(layout, context, found, held.chosen)
        chosen = next((look for look in found if str(look.path) == held.chosen), None)
        if chosen:
            _draw_chosen(layout, context, chosen)


def _draw_grid(layout: bpy.types.UILayout, context: bpy.types.Context, found: list, chosen: str) -> None:
    """Pictures with names under them, as many beside each other as the sidebar is wide for."""
    width = context.region.width / context.preferences.system.ui_scale - 30.0
    columns = max(2, int(width / _CELL))
    grid = layout.grid_flow(row_major=True, columns=columns, even_columns=True, even_rows=True, align=False)
    for look in found:
        cell = grid.column(align=True)
        cell.template_icon(icon_value=preset_pictures.icon(look), scale=width / columns / _UNIT - 0.3)
        picked = str(look.path) == chosen
        cell.operator("vibe.preset_choose", text=look.name, depress=picked).path = str(look.path)


def _draw_chosen(layout: bpy.types.UILayout, context: bpy.types.Context, look: library.Look) -> None:
    box = layout.box()
    row = box.row()
    row.label(text=look.name, icon="ERROR" if look.problem else "NONE")
    row.menu("VIBE_MT_preset", text="", icon="DOWNARROW_HLT")
    if look.problem:
        _paragraph(box, context, look.problem)
        return
    if look.prompt:
        _paragraph(box, context, f"“{look.prompt}”")
    row = box.row()
    row.scale_y = 1.4
    applied = context.scene.vibe.vibed_preset == look.name
    row.operator("vibe.preset_apply", text="Apply Again" if applied else "Apply", icon="CHECKMARK")
    rest = context.window_manager.vibe_presets.rest.splitlines() if applied else []
    for line in rest[:_SHOWN]:
        _paragraph(box, context, f"Did not fit: {line}")
    if len(rest) > _SHOWN:
        _paragraph(box, context, f"… and {len(rest) - _SHOWN} more")


def _paragraph(layout: bpy.types.UILayout, context: bpy.types.Context, text: str) -> None:
    """Faint text in as many lines as the sidebar is wide for."""
    column = layout.column(align=True)
    column.scale_y, column.active = 0.8, False
    width = max(16, int(context.region.width / (7.5 * context.preferences.system.ui_scale)) - 6)
    for line in textwrap.wrap(text, width, break_on_hyphens=False):
        column.label(text=line)


CLASSES = (VIBE_MT_preset, VIBE_MT_presets, VIBE_PT_presets)
