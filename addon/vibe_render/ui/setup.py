# SPDX-License-Identifier: GPL-3.0-or-later
"""The engine and its cache in the preferences and in the panel: find it, set it up, test it, clear what it keeps."""

from __future__ import annotations

import shutil
import time
from pathlib import Path
from typing import Any

import bpy
from bpy.props import EnumProperty, StringProperty

from ..core import ADDON, preferences
from ..core.preferences import cache_folder, engine_choice
from ..core.schema_import import schema
from ..engine import setup as engine_setup
from ..run.state import addon_state
from . import drawing
from .bases import IdleOperator, Operator
from .engine_state import engine_state, setup_folder, version
from .properties import declare

_DIALOG_WIDTH, _DIALOG_LETTERS = 420, 62
_EVERY = 3.0  # seconds between two measurements of the cache: Blender draws many times a second

_measured: dict[Path, tuple[float, str]] = {}  # folder -> time of its measurement, its size in words


def _folder(name: str, description: str) -> Any:
    return StringProperty(name=name, description=description, subtype="DIR_PATH")


class VibePreferences(bpy.types.AddonPreferences):
    """The add-on's preferences, kept with Blender's own."""

    bl_idname = ADDON

    engine: _folder("Engine", "Folder of the Python environment that the engine runs in. Empty: look for it")
    cache: _folder("Cache", "Folder for what can be made again, such as a model's answers. Empty: the extension's own")
    vlm_key: StringProperty(
        name="Key",
        description="The endpoint's API key; servers on this computer need none. It is kept in Blender's "
        "preferences only. Empty: the environment variable VIBE_VLM_KEY or OPENAI_API_KEY",
        subtype="PASSWORD",
        maxlen=1024,  # long keys are cut without it
    )

    def draw(self, context: bpy.types.Context) -> None:
        engine_state.search(self.engine)
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        # The engine: where it is, buttons for it, the outcome of the last one.
        column = _section(self.layout, "Engine", "SYSTEM")
        column.prop(self, "engine", text="Folder", placeholder="Found automatically")
        split = column.split(factor=0.4)
        split.label()
        about = split.column()
        _draw_engine_line(about)
        if not engine_state.setup:
            row = about.row(align=True)
            row.operator("vibe.setup_engine", icon="IMPORT")
            row.operator("vibe.test_engine")
            row.operator("vibe.look_for_engine", text="", icon="FILE_REFRESH")
            row.operator("vibe.remove_engine", text="", icon="TRASH")
        if engine_state.outcome and not engine_state.test_work:
            icon = "CHECKMARK" if engine_state.succeeded else "ERROR"
            letters = int(drawing.columns(context) * 0.55)
            drawing.paragraph(about, context, engine_state.outcome, icon, letters=letters)
        column.separator()
        column.prop(self, "device")
        column.prop(self, "encoder", placeholder="The one that comes with it")
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
        row.label(text=cache_size(cache_folder(context)))
        row.operator("vibe.clear_cache", icon="TRASH")


VibePreferences.__annotations__ |= declare(preferences=True)


def _section(layout: bpy.types.UILayout, title: str, icon: str) -> bpy.types.UILayout:
    box = layout.box()
    box.label(text=title, icon=icon)
    return box.column()


def _draw_engine_line(layout: bpy.types.UILayout) -> None:
    """Draws a line on the engine's folder, or on the progress of its setup."""
    if setup := engine_state.setup:
        row = layout.row(align=True)
        row.progress(factor=setup.fraction or 0.0, text=setup.text)
        row.operator("vibe.cancel_setup", text="", icon="X")
    elif engine_state.test_work:
        layout.label(text="Starting the engine to see whether it answers…", icon="TIME")
    elif engine_state.search_work:
        layout.label(text="Looking for the engine…", icon="TIME")
    elif engine_state.python:
        folder, home = engine_state.python.parent.parent, Path.home()
        place = f"~/{folder.relative_to(home)}" if folder.is_relative_to(home) else str(folder)
        layout.label(text=f"Found: {place}", icon="CHECKMARK")
    else:
        layout.label(text="Not found on this computer", icon="INFO")


def cache_size(folder: Path) -> str:
    """The size of a folder in words, such as "3.4 MB in 12 files"; "Empty" also if it does not exist."""
    when, size = _measured.get(folder, (0.0, ""))
    if time.monotonic() - when > _EVERY:
        files = [f.stat().st_size for f in folder.rglob("*") if f.is_file()] if folder.is_dir() else []
        count = f"{len(files)} file{'s' if len(files) > 1 else ''}"
        size = f"{drawing.size(sum(files))} in {count}" if files else "Empty"
        _measured[folder] = time.monotonic(), size
    return size


def draw_failure(layout: bpy.types.UILayout, context: bpy.types.Context, failure: schema.VibeError) -> None:
    """Draws a vibe's failure and its remedy."""
    box = layout.box()
    row = box.row()
    row.alert = True
    row.label(text="The scene is as it was", icon="ERROR")
    row.operator("vibe.dismiss", text="", icon="X", emboss=False)
    drawing.paragraph(box, context, failure.message)
    if failure.remedy:
        drawing.paragraph(box, context, failure.remedy)
    if engine_state.problem:
        _draw_engine_buttons(box)
    else:
        box.operator("preferences.addon_show", text="Preferences", icon="PREFERENCES").module = ADDON


def draw_no_engine(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draws a line on the missing engine and the buttons that get it, or the progress of its setup."""
    box = layout.box()
    if engine_state.setup:
        _draw_engine_line(box)
        return
    drawing.paragraph(box, context, "No engine yet. Presets work without it", "INFO")
    outcome = engine_state.outcome
    if outcome and not engine_state.succeeded and outcome != str(engine_state.problem):
        drawing.paragraph(box, context, outcome, "ERROR")  # the buttons say what to do
    _draw_engine_buttons(box)


def _draw_engine_buttons(layout: bpy.types.UILayout) -> None:
    column = layout.column(align=True)
    column.scale_y = 1.2
    column.operator("vibe.setup_engine", icon="IMPORT")
    if not preferences.online():
        column.operator("extensions.userpref_show_online", text="Allow Online Access…", icon="INTERNET")
    row = column.row(align=True)
    row.operator("vibe.look_for_engine", icon="FILE_REFRESH")
    row.operator("preferences.addon_show", text="Preferences", icon="PREFERENCES").module = ADDON


class VIBE_OT_setup_engine(Operator, label="Set Up Engine"):
    """Download the engine once, into the extension's own folder: Python packages. What they are and how large is said first"""

    build: EnumProperty(
        name="Runs On",
        description="What the engine computes on",
        items=[(key, b.name, f"{b.download} GB to download") for key, b in engine_setup.choices().items()],
        default=engine_setup.suggested(),
        options={"SKIP_SAVE"},
    )

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        off = "" if preferences.online() else "Online access is off: see Preferences > System > Network"
        return off or ("It is being set up already" if engine_state.setup else "")

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        dialog = context.window_manager.invoke_props_dialog
        return dialog(self, width=_DIALOG_WIDTH, title="Set Up Engine", confirm_text="Download")

    def draw(self, context: bpy.types.Context) -> None:
        column = self.layout.column()
        if len(engine_setup.choices()) > 1:
            column.row().prop(self, "build", expand=True)
        for line in engine_setup.download_text(engine_setup.choices()[self.build], setup_folder()):
            drawing.paragraph(column, context, line, letters=_DIALOG_LETTERS)

    def perform(self, context: bpy.types.Context) -> None:
        try:
            engine_state.set_up(engine_setup.choices()[self.build])
        except schema.VibeError as error:
            engine_state.outcome, engine_state.succeeded = str(error), False
            raise


class VIBE_OT_remove_engine(IdleOperator, label="Remove Engine"):
    """Delete the engine that Set Up Engine has downloaded. Presets and settings stay"""

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        if engine_state.setup:
            return "It is being set up"
        return "" if setup_folder().is_dir() else "Set Up Engine has downloaded none"

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        confirm, message = context.window_manager.invoke_confirm, f"{cache_size(setup_folder())} in {setup_folder()}"
        return confirm(self, event, title="Remove Engine", message=message, confirm_text="Remove", icon="WARNING")

    def perform(self, context: bpy.types.Context) -> str:
        addon_state.close()
        shutil.rmtree(setup_folder())
        chosen = preferences.get(context)
        if chosen and chosen.engine == str(setup_folder()):
            chosen.engine = ""
        engine_state.search(engine_choice(context), again=True)
        return "The engine is removed"


class VIBE_OT_cancel_setup(Operator, label="Cancel"):
    """Stop setting up the engine, and remove what has been installed of it"""

    def perform(self, context: bpy.types.Context) -> None:
        if engine_state.setup:
            engine_state.setup.cancel()


class VIBE_OT_look_for_engine(Operator, label="Look Again"):
    """Look for the engine once more"""

    def perform(self, context: bpy.types.Context) -> None:
        engine_state.search(engine_choice(context), again=True)


class VIBE_OT_test_engine(Operator, label="Test Engine"):
    """Start the engine once and see whether it answers"""

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Tests in the background; the result is shown under the button."""
        engine_state.test(engine_choice(context))
        return {"FINISHED"}

    def perform(self, context: bpy.types.Context) -> str:
        """Tests at once, for scripts."""
        return f"Engine {version(engine_choice(context))} answers"


class VIBE_OT_clear_cache(Operator, label="Clear"):
    """Delete the engine's stored files; they are made again when they are needed"""

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        if addon_state.running:
            return "A vibe is running, and reads it"
        return "" if cache_folder(context).is_dir() else "The cache is empty"

    def perform(self, context: bpy.types.Context) -> None:
        """Deletes Vibe Render's folder in the cache folder, and nothing else there."""
        shutil.rmtree(cache_folder(context), ignore_errors=True)
        _measured.clear()


def warm_up_soon() -> None:
    """Starts the engine, once, as soon as it is found; a panel may call this whenever it is drawn."""
    if engine_state.python and not addon_state.has_engine:
        drawing.begin(_warm_up, 0.0, persistent=True)


def _warm_up() -> None:
    """Starts the engine; a timer function, because starting it while a panel is drawn would delay the drawing."""
    addon_state.warm_up(bpy.context)
