# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets in the "Vibe" tab: a grid of pictures to choose from, and the chosen preset."""

from __future__ import annotations

from typing import ClassVar

import bpy

from ...core.drawing import paragraph
from ...looks import library
from ...run.state import addon_state
from .. import look_icons

_WIDTH, _COLUMNS = 26, 4  # of the grid; the width in Blender's units (the height of a button)
_LETTERS = 70  # in a line of text below the grid
_SHOWN = 5  # lines about what did not fit


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
        if (folder := library.folder()).is_dir():
            layout.operator("wm.path_open", text="Open Folder", icon="FILE_FOLDER").filepath = str(folder)
        layout.separator()
        layout.operator("vibe.export_assets", text="Export Look as Assets…", icon="ASSET_MANAGER")
        layout.operator("vibe.export_lut", text="Export Grade as LUT…", icon="COLOR")


class PresetsPanel:
    """The chosen preset, and the button that shows all of them."""

    bl_label = "Presets"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Not while a vibe runs."""
        return not addon_state.running

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        """The menu."""
        self.layout.menu("VIBE_MT_presets", text="", icon="COLLAPSEMENU")  # type: ignore[attr-defined]

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        layout: bpy.types.UILayout = self.layout  # type: ignore[attr-defined]
        layout.popover("VIBE_PT_preset_grid", text="Browse", icon="ASSET_MANAGER")
        if look := _chosen(context):
            layout.template_icon(icon_value=look_icons.icon(look), scale=6.0)
            _draw_chosen(layout, context, look)


class VIBE_PT_preset_grid(bpy.types.Panel):
    """All presets as pictures, with search; below them the chosen one."""

    bl_label = "Browse Presets"
    bl_space_type = "VIEW_3D"
    bl_region_type = "HEADER"
    bl_options: ClassVar[set[str]] = {"INSTANCED"}
    bl_ui_units_x = _WIDTH

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        layout, window_state = self.layout, context.window_manager.vibe_presets
        layout.prop(window_state, "search", text="", icon="VIEWZOOM", placeholder="Search names and prompts")
        shown = library.looks(window_state.search)
        grid = layout.grid_flow(row_major=True, columns=_COLUMNS, even_columns=True, even_rows=True)
        for look in shown:
            cell = grid.column(align=True)
            cell.template_icon(icon_value=look_icons.icon(look), scale=_WIDTH / _COLUMNS - 1.0)
            picked = str(look.path) == window_state.chosen
            row = cell.row(align=True)
            row.operator("vibe.preset_choose", text=look.name, depress=picked).path = str(look.path)
            row.operator("vibe.preset_apply", text="", icon="CHECKMARK").path = str(look.path)
        for _ in range(-len(shown) % _COLUMNS if len(shown) < _COLUMNS else 0):  # pictures keep their size
            grid.label(text="")
        if not shown:
            _draw_faint(layout, "No preset has these words")
        elif chosen := _chosen(context):
            _draw_chosen(layout, context, chosen, _LETTERS)
        else:
            _draw_faint(layout, "Click a name to read more, or ✓ to apply the look")


def _draw_faint(layout: bpy.types.UILayout, text: str) -> None:
    row = layout.row()
    row.active, row.alignment = False, "CENTER"
    row.label(text=text)


def _chosen(context: bpy.types.Context) -> library.Look | None:
    path = context.window_manager.vibe_presets.chosen
    return next((look for look in library.looks() if str(look.path) == path), None) if path else None


def _draw_chosen(
    layout: bpy.types.UILayout, context: bpy.types.Context, look: library.Look, letters: int = 0
) -> None:
    """Name, prompt and Apply in a box; lines have so many letters, or the region's width if 0."""
    box = layout.box()
    row = box.row()
    row.label(text=look.name, icon="ERROR" if look.problem else "NONE")
    row.menu("VIBE_MT_preset", text="", icon="DOWNARROW_HLT")
    if look.problem:
        paragraph(box, context, look.problem, letters=letters)
        return
    if look.prompt:
        paragraph(box, context, f"“{look.prompt}”", faint=True, letters=letters)
    row = box.row()
    row.scale_y = 1.4
    applied = context.scene.vibe.vibed_preset == look.name
    row.operator("vibe.preset_apply", text="Apply Again" if applied else "Apply", icon="CHECKMARK")
    rest = context.window_manager.vibe_presets.rest.splitlines() if applied else []
    for line in rest[:_SHOWN]:
        paragraph(box, context, f"Did not fit: {line}", faint=True, letters=letters)
    if len(rest) > _SHOWN:
        paragraph(box, context, f"… and {len(rest) - _SHOWN} more", faint=True, letters=letters)


CLASSES = (VIBE_MT_preset, VIBE_MT_presets, VIBE_PT_preset_grid)
