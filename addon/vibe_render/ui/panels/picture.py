# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel for a picture whose look is wanted."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

import bpy

from ...core import compat
from ...core.drawing import paragraph
from ...core.schema_import import options
from ...render import reference
from ...run.state import addon_state
from .. import picture_icons

_SCALE = 6.0
"""Of the thumbnail, in buttons."""


class PicturePanel:
    """A picture, and what is taken over from it."""

    bl_label = "Like a Picture"
    bl_options: ClassVar[set[str]] = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Not while a vibe runs."""
        return not addon_state.running

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        """What is given."""
        if given := reference.name(context.scene.vibe):
            self.layout.label(text=f"{given} " if len(given) < 24 else f"{given[:22]}… ")  # type: ignore[attr-defined]

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        layout: Any = self.layout  # type: ignore[attr-defined]
        settings = context.scene.vibe
        row = layout.row(align=True)
        row.prop_enum(settings, "like_from", "NONE", text="")
        for place in ("FILE", "IMAGE", "SLOT"):
            row.prop_enum(settings, "like_from", place)
        column = layout.column()
        if settings.like_from == "FILE":
            column.prop(settings, "like", text="")
        elif settings.like_from == "IMAGE":
            column.template_ID(settings, "like_image", open="image.open")
        elif settings.like_from == "SLOT":
            column.prop(settings, "like_slot")
        if settings.like_from == "IMAGE" and compat.HAS_CLIPBOARD_PICTURES:
            column.operator("vibe.paste_picture", icon="PASTEDOWN")
        if not reference.name(settings):
            return
        if reason := reference.obstacle(settings):
            paragraph(layout, context, reason, "ERROR", faint=True)
            return
        if shown := _icon(settings, layout):
            layout.template_icon(icon_value=shown, scale=_SCALE)
        grid = layout.grid_flow(columns=2, even_columns=True, align=True)
        for name in options.TRAITS:
            grid.prop(settings, f"like_{name}", toggle=True)
        grid.prop(settings, "like_same", toggle=True)
        paragraph(layout, context, "Its look, not its content. Words count more.", faint=True)


def _icon(settings: Any, layout: Any) -> int:
    """The number of an icon that shows the picture; 0 for none."""
    if settings.like_from == "FILE":
        return picture_icons.icon(Path(bpy.path.abspath(settings.like)))
    return layout.icon(settings.like_image) if settings.like_from == "IMAGE" else 0
