# SPDX-License-Identifier: GPL-3.0-or-later
"""The panels: prompt, progress, what may change. They are in the 3D viewport's sidebar, tab "Vibe", and, as
they change what is rendered, in the render properties."""

from __future__ import annotations

from typing import Any, ClassVar

import bpy

from . import drawing, history, operators, panel_result, preferences, preview
from .contract import schema
from .drawing import paragraph
from .engine_place import place
from .session import LOOKING, PAUSING, SILENT, Session, desk

_PLACES = {
    "VIBE_PT": {"bl_space_type": "VIEW_3D", "bl_region_type": "UI", "bl_category": "Vibe"},
    "VIBE_RENDER_PT": {"bl_space_type": "PROPERTIES", "bl_region_type": "WINDOW", "bl_context": "render"},
}
"""Where every panel is, and the beginning of its name there."""


class VIBE_MT_history(bpy.types.Menu):
    """The prompts that were typed."""

    bl_label = "Earlier Prompts"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the menu."""
        layout = self.layout
        earlier = history.prompts()
        for text in earlier[:20]:
            layout.operator("vibe.recall", text=text if len(text) < 70 else f"{text[:67]}…").prompt = text
        if earlier:
            layout.separator()
            layout.operator("vibe.clear_history", icon="TRASH")
        else:
            layout.label(text="Nothing yet")


class _Main:
    """Prompt and button; progress while a vibe runs; what went wrong."""

    bl_label = "Vibe Render"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        layout, settings = self.layout, context.scene.vibe  # type: ignore[attr-defined]
        column = layout.column()
        column.enabled = not desk.running
        column.label(text="Describe the mood")
        field = column.row(align=True)
        field.scale_y = 1.3
        field.prop(settings, "prompt", text="", placeholder="misty, cool blue fog, vignette")
        field.menu("VIBE_MT_history", text="", icon="RECOVER_LAST")
        if desk.running and desk.session:
            _draw_running(layout, context, desk.session)
            return
        place.look(preferences.engine_choice(context))
        row = column.row(align=True)
        for name in schema.BUDGETS:
            row.prop_enum(settings, "budget", name.upper())
        column.prop(settings, "variants")
        button = layout.row()
        button.scale_y = 1.8
        button.operator("vibe.run", icon="SHADERFX")
        if desk.failure:
            _draw_failure(layout, context, desk.failure)
        elif place.problem or place.setting_up:
            _draw_no_engine(layout, context)
        elif reason := operators.obstacle(context):
            paragraph(layout, context, reason, "INFO", faint=True)


def _draw_running(layout: bpy.types.UILayout, context: bpy.types.Context, session: Session) -> None:
    """The picture so far, the bar, and the ways out; or a question."""
    box = layout.box()
    if session.scene != context.scene.name:
        box.label(text=f"In the scene {session.scene}", icon="SCENE_DATA")
    if session.question:
        _draw_question(box, context, session.question)
    else:
        if icon := preview.icon(session.before, session.preview):
            box.template_icon(icon_value=icon, scale=11.5)
        box.progress(factor=session.fraction, text=_stage(session))
        if session.silence > SILENT:
            note = f"No word from the engine for {drawing.duration(session.silence)}. Wait, or cancel: "
            paragraph(box, context, f"{note}the next vibe starts a new one.", "ERROR")
    row = box.row(align=True)
    row.scale_y = 1.3
    if not session.question:
        row.operator("vibe.stop", text="Stop and Use Best", icon="CHECKMARK")
    row.operator("vibe.cancel", text="Cancel" if session.question else "", icon="X")
    hint = box.row()
    hint.active, hint.alignment = False, "CENTER"
    esc = "Esc stops and uses the best" if session.can_stop else "Esc cancels"
    hint.label(text="Blender pauses for a moment" if session.stage in PAUSING else esc)


def _stage(session: Session) -> str:
    progress = session.progress
    if progress and session.stage == LOOKING:
        left = drawing.duration(progress.seconds_left)
        return f"Round {progress.round} of {progress.rounds}  ·  {left} left"
    return f"{session.stage}…"


def _draw_question(
    layout: bpy.types.UILayout, context: bpy.types.Context, question: dict[str, list[str]]
) -> None:
    """Which materials other things use too, and what to do about it."""
    paragraph(layout, context, "The subject shares materials with other things:", "QUESTION")
    for name, users in list(question.items())[:4]:
        more = f" and {len(users) - 2} more" if len(users) > 2 else ""
        paragraph(layout, context, f"{name}: {', '.join(users[:2])}{more}", "MATERIAL")
    if len(question) > 4:
        layout.label(text=f"and {len(question) - 4} more materials", icon="BLANK1")
    column = layout.column(align=True)
    column.scale_y = 1.2
    column.operator("vibe.answer", text="Affect All Users", icon="LINKED").shared = "ALL"
    column.operator("vibe.answer", text="Make Single-User", icon="UNLINKED").shared = "SINGLE"


def _draw_failure(layout: bpy.types.UILayout, context: bpy.types.Context, failure: schema.VibeError) -> None:
    box = layout.box()
    row = box.row()
    row.alert = True
    row.label(text="The scene is as it was", icon="ERROR")
    row.operator("vibe.dismiss", text="", icon="X", emboss=False)
    paragraph(box, context, failure.message)
    if failure.remedy:
        paragraph(box, context, failure.remedy)
    if place.problem:
        _engine_buttons(box)
    else:
        box.operator("preferences.addon_show", text="Preferences", icon="PREFERENCES").module = __package__


def _draw_no_engine(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """How to get an engine."""
    box = layout.box()
    box.label(text="One more step: the engine", icon="INFO")
    if place.setting_up:
        preferences.draw_place(box)
        return
    paragraph(
        box,
        context,
        "It finds the looks, in a process of its own beside Blender. Presets, strength, compare and revert "
        "work without it.",
    )
    if place.said and not place.works:
        paragraph(box, context, place.said, "ERROR")
    _engine_buttons(box)


def _engine_buttons(layout: bpy.types.UILayout) -> None:
    column = layout.column(align=True)
    column.scale_y = 1.2
    column.operator("vibe.setup_engine", icon="IMPORT")
    if not preferences.online():
        column.label(text="Allow Online Access first: Preferences, System", icon="INTERNET_OFFLINE")
    row = column.row(align=True)
    row.operator("vibe.look_for_engine", icon="FILE_REFRESH")
    row.operator("preferences.addon_show", text="Preferences", icon="PREFERENCES").module = __package__


class _Idle:
    """A panel that makes way while a vibe runs."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Not while a vibe runs."""
        return not desk.running


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
        from . import value_list

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
        column = column.column()
        column.active = settings.budget == "CUSTOM"
        for name in ("rounds", "steps", "size"):
            column.prop(settings, name)


_PANELS: tuple[tuple[str, type, str], ...] = (
    ("main", _Main, ""),
    ("result", panel_result.Result, ""),
    ("changes", panel_result.Changes, "result"),
    ("scope", _Scope, ""),
    ("values", _Values, "scope"),
    ("advanced", _Advanced, ""),
)
"""Name, what it draws, and the panel that it is inside of."""


def _classes() -> list[type]:
    """Every panel in every place; in the properties editor all of them are inside the first."""
    made = []
    for prefix, where in _PLACES.items():
        for name, base, parent in _PANELS:
            names: dict[str, Any] = {"__module__": __name__, "__doc__": base.__doc__, **where}
            if not parent and name != "main" and where["bl_space_type"] == "PROPERTIES":
                parent = "main"
            if parent:
                names["bl_parent_id"] = f"{prefix}_{parent}"
            if name == "main" and where["bl_space_type"] == "PROPERTIES":
                names["bl_options"] = {"DEFAULT_CLOSED"}
            made.append(type(f"{prefix}_{name}", (base, bpy.types.Panel), names))
    return made


CLASSES = (VIBE_MT_history, *_classes())
