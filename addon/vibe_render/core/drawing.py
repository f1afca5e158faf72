# SPDX-License-Identifier: GPL-3.0-or-later
"""What panels share: wrapped text, durations and sizes in words, redrawing."""

from __future__ import annotations

import textwrap

import bpy

GROUP_ICONS = {
    "camera": "OUTLINER_OB_CAMERA",
    "light": "OUTLINER_OB_LIGHT",
    "world": "WORLD",
    "material": "MATERIAL",
    "volume": "OUTLINER_OB_VOLUME",
    "film": "COLOR",
}
_PLACES = {"VIEW_3D": "UI", "PROPERTIES": "WINDOW", "PREFERENCES": "WINDOW"}
"""Where our panels are: the kind of area, and the region in it."""


def paragraph(
    layout: bpy.types.UILayout,
    context: bpy.types.Context,
    text: str,
    icon: str = "NONE",
    faint: bool = False,
    letters: int = 0,
) -> None:
    """Draws wrapped text.

    Args:
        icon: Before the first line; the other lines are indented.
        faint: Draw it as disabled things are.
        letters: In a line; 0 for as many as the region is wide.
    """
    column = layout.column(align=True)
    column.scale_y, column.active = 0.8, not faint
    width = (letters or columns(context)) - (3 if icon != "NONE" else 0)
    lines = textwrap.wrap(text, width, break_on_hyphens=False)
    for number, line in enumerate(lines):
        column.label(text=line, icon="BLANK1" if number and icon != "NONE" else icon)


def see_rendered(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """A button that shows the viewport rendered, where it is not yet."""
    if context.space_data and context.space_data.type == "VIEW_3D":
        shading = context.space_data.shading
        if shading.type != "RENDERED":
            layout.prop_enum(shading, "type", "RENDERED", text="See It Rendered")


def columns(context: bpy.types.Context) -> int:
    """About how many letters go into a line of the region."""
    return max(16, int(context.region.width / (7.0 * context.preferences.system.ui_scale)) - 5)


def duration(seconds: float) -> str:
    """Seconds in words: "40 s", "12 min", "3 h"."""
    for size, unit in ((3600, "h"), (60, "min")):
        if seconds >= 1.5 * size:
            return f"{seconds / size:.0f} {unit}"
    return f"{max(seconds, 1):.0f} s"


def size(count: float) -> str:
    """Bytes in words: "12 bytes", "3.4 MB"."""
    for unit in ("bytes", "kB", "MB"):
        if count < 1000:
            return f"{count:.0f} {unit}" if unit == "bytes" else f"{count:.1f} {unit}"
        count /= 1000
    return f"{count:.1f} GB"


def redraw() -> None:
    """Redraws the regions that our panels are in, and no others."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            for region in area.regions:
                if region.type == _PLACES.get(area.type):
                    region.tag_redraw()
