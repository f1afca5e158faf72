# SPDX-License-Identifier: GPL-3.0-or-later
"""The panels: prompt, progress, what may change.

They are in the 3D viewport's sidebar, tab "Vibe", and in the render properties.
"""

from __future__ import annotations

from typing import Any, ClassVar

import bpy

from ...core import preferences
from ...core.drawing import paragraph
from ...core.schema_import import schema
from ...run import prompt_history
from ...run.engine_state import engine_state
from ...run.state import addon_state
from .. import obstacles, value_list, warm_up, word_readings
from . import picture, presets, progress, result, trouble, words

_PLACES = {
    "VIBE_PT": {"bl_space_type": "VIEW_3D", "bl_region_type": "UI", "bl_category": "Vibe"},
    "VIBE_RENDER_PT": {"bl_space_type": "PROPERTIES", "bl_region_type": "WINDOW", "bl_context": "render"},
}
"""The prefix of the panels' names in each place, and the place."""


class VIBE_MT_history(bpy.types.Menu):
    """The prompts that were typed."""

    bl_label = "Earlier Prompts"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the menu."""
        layout = self.layout
        earlier = prompt_history.prompts()
        for text in earlier[:20]:
            layout.operator("vibe.recall", text=text if len(text) < 70 else f"{text[:67]}…").prompt = text
        if earlier:
            layout.separator()
            layout.operator("vibe.clear_history", icon="TRASH")
        else:
            layout.label(text="Nothing yet")


class _Main:
    """Prompt and button; progress while a vibe runs; its failure."""

    bl_label = "Vibe Render"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        layout, settings = self.layout, context.scene.vibe  # type: ignore[attr-defined]
        if addon_state.running and addon_state.session:  # text instead of grayed-out fields
            paragraph(layout, context, addon_state.session.wanted)
            progress.draw(layout, context, addon_state.session)
            return
        column = layout.column()
        head = column.row()
        head.label(text="Describe the mood")
        live = head.row()
        live.alignment = "RIGHT"
        live.prop(context.window_manager, "vibe_live", icon="HIDE_OFF", toggle=True)
        field = column.row(align=True)
        field.scale_y = 1.3
        field.prop(settings, "prompt", text="", placeholder="misty, cool blue fog, vignette")
        field.menu("VIBE_MT_history", text="", icon="RECOVER_LAST")
        word_readings.keep_up(context)
        words.draw(column, context, addon_state.readings.newest)
        if addon_state.live and addon_state.live.scene == context.scene.name:
            progress.draw_live(column, context, addon_state.live)
        engine_state.search(preferences.engine_choice(context))
        warm_up.begin_soon()
        row = column.row(align=True)
        for name in schema.BUDGETS:
            row.prop_enum(settings, "budget", name.upper())
        column.prop(settings, "variants")
        button = layout.row()
        button.scale_y = 1.8
        button.operator("vibe.run", icon="SHADERFX")
        if addon_state.failure:
            trouble.draw_failure(layout, context, addon_state.failure)
        elif engine_state.problem or engine_state.setting_up:
            trouble.draw_no_engine(layout, context)
        elif reason := obstacles.obstacle(context):
            paragraph(layout, context, reason, "INFO", faint=True)


class _Idle:
    """A panel that is hidden while a vibe runs."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Not while a vibe runs."""
        return not addon_state.running


class _Scope(_Idle):
    """What a vibe may change, and what the picture is about."""

    bl_label = "May Change"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        layout, settings = self.layout, context.scene.vibe  # type: ignore[attr-defined]
        grid = layout.grid_flow(columns=2, even_columns=True, align=True)
        for group in schema.GROUPS:
            free = getattr(settings, f"change_{group}")
            grid.prop(settings, f"change_{group}", toggle=True, icon="UNLOCKED" if free else "LOCKED")
        column = layout.column()
        column.use_property_split, column.use_property_decorate = True, False
        column.prop(settings, "subject")
        if settings.subject == "COLLECTION":
            column.prop(settings, "collection", text=" ")
        column.prop(settings, "shared", text="Shared Materials")
        column.prop(settings, "new_lights")


class _Values(_Idle):
    """Every single value of the scene, with a lock."""

    bl_label = "Single Values"
    bl_options: ClassVar[set[str]] = {"DEFAULT_CLOSED"}

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        """How many are locked."""
        if count := len(context.scene.vibe.locks):
            self.layout.label(text=f"{count} locked ")  # type: ignore[attr-defined]

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the list."""
        layout: Any = self.layout  # type: ignore[attr-defined]
        value_list.keep_up(context)
        values = context.window_manager.vibe_values
        layout.template_list("VIBE_UL_values", "", values, "rows", values, "active", rows=6)
        layout.operator("vibe.unlock_all", icon="UNLOCKED")


class _Advanced(_Idle):
    """Numbers that few need."""

    bl_label = "Advanced"
    bl_options: ClassVar[set[str]] = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        layout, settings = self.layout, context.scene.vibe  # type: ignore[attr-defined]
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column()
        column.prop(settings, "lock", placeholder="light/Key, */metallic")
        column.prop(settings, "top_k")
        column.prop(settings, "seed")
        column.prop(settings, "anchor")
        column = layout.column()
        column.prop(settings, "budget")
        for name in ("rounds", "steps", "size") if settings.budget == "CUSTOM" else ():
            column.prop(settings, name)


_PANELS: tuple[tuple[str, type, str], ...] = (
    ("main", _Main, ""),
    ("presets", presets.PresetsPanel, "main"),
    ("picture", picture.PicturePanel, "main"),
    ("result", result.ResultPanel, ""),
    ("changes", result.ChangesPanel, "result"),
    ("scope", _Scope, ""),
    ("values", _Values, "scope"),
    ("advanced", _Advanced, ""),
)
"""Name, class that draws it, and its parent panel."""


def _classes() -> list[type]:
    """Every panel in every place; in the properties editor all of them are inside the first."""
    panels = []
    for prefix, where in _PLACES.items():
        for name, base, parent in _PANELS:
            names: dict[str, Any] = {"__module__": __name__, "__doc__": base.__doc__, **where}
            if not parent and name != "main" and where["bl_space_type"] == "PROPERTIES":
                parent = "main"
            if parent:
                names["bl_parent_id"] = f"{prefix}_{parent}"
            if name == "main" and where["bl_space_type"] == "PROPERTIES":
                names["bl_options"] = {"DEFAULT_CLOSED"}
            panels.append(type(f"{prefix}_{name}", (base, bpy.types.Panel), names))
    return panels


CLASSES = (VIBE_MT_history, *_classes())
