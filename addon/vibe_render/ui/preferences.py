# SPDX-License-Identifier: GPL-3.0-or-later
# mypy: disable-error-code="valid-type"
"""The add-on's preferences: where the engine is, what it runs on, the vision-language model, the cache."""

from __future__ import annotations

import bpy
from bpy.props import StringProperty

from ..core import ADDON, drawing, preferences
from ..run.engine_state import engine_state
from . import cache_size, engine_line, option_properties

_Options = option_properties.declare("VibeEngineOptions", preferences=True)


class VibePreferences(_Options, bpy.types.AddonPreferences):  # type: ignore[misc]
    """The add-on's preferences, kept with Blender's own."""

    bl_idname = ADDON

    engine: StringProperty(
        name="Engine",
        description="Folder of the Python environment that the engine runs in. Empty: look for it",
        subtype="DIR_PATH",
        update=lambda self, _context: engine_state.search(self.engine),
    )
    vlm_key: StringProperty(
        name="Key",
        description="The endpoint's API key; servers on this computer need none. It is kept in Blender's "
        "preferences only. Empty: the environment variable VIBE_VLM_KEY or OPENAI_API_KEY",
        subtype="PASSWORD",
        maxlen=1024,  # long keys are cut without it
    )
    cache: StringProperty(
        name="Cache",
        description="Folder for what can be made again, such as a model's answers. Empty: the extension's own",
        subtype="DIR_PATH",
    )

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the preferences."""
        engine_state.search(self.engine)
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        self._draw_engine(_section(self.layout, "Engine", "SHADERFX"), context)
        column = _section(self.layout, "Vision-Language Model (optional)", "OUTLINER_OB_IMAGE")
        column.prop(self, "vlm_model", placeholder="None: the offline planner reads the words")
        column.prop(self, "vlm_url", placeholder="https://api.openai.com/v1")
        column.prop(self, "vlm_key", placeholder="Kept in Blender's preferences only")
        if self.vlm_model and not preferences.online():
            column.label(text="Online access is off: only a model on this computer is asked", icon="INFO")
        column = _section(self.layout, "Cache", "FILE_CACHE")
        column.prop(self, "cache", text="Folder", placeholder="The extension's own")
        row = column.split(factor=0.4)
        row.label()
        row = row.row()
        row.label(text=cache_size.text(preferences.cache_folder(context)))
        row.operator("vibe.clear_cache", icon="TRASH")

    def _draw_engine(self, column: bpy.types.UILayout, context: bpy.types.Context) -> None:
        column.prop(self, "engine", text="Folder", placeholder="Found by itself")
        split = column.split(factor=0.4)
        split.label()
        about = split.column()
        engine_line.draw(about)
        if not engine_state.setting_up:
            row = about.row(align=True)
            row.operator("vibe.setup_engine", icon="IMPORT")
            row.operator("vibe.test_engine", icon="CHECKMARK")
            row.operator("vibe.look_for_engine", text="", icon="FILE_REFRESH")
        if engine_state.outcome and not engine_state.testing:
            icon, letters = (
                "CHECKMARK" if engine_state.succeeded else "ERROR",
                int(drawing.columns(context) * 0.55),
            )
            drawing.paragraph(about, context, engine_state.outcome, icon, letters=letters)
        column.separator()
        column.prop(self, "device")
        column.prop(self, "encoder", placeholder="The one that comes with it")


def _section(layout: bpy.types.UILayout, title: str, icon: str) -> bpy.types.UILayout:
    box = layout.box()
    box.label(text=title, icon=icon)
    return box.column()


CLASSES = (VibePreferences,)
