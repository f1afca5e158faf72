# SPDX-License-Identifier: GPL-3.0-or-later
# mypy: disable-error-code="valid-type"
"""Where the engine is, what it runs on, the vision-language model that it may ask, and what it keeps."""

from __future__ import annotations

import time
from pathlib import Path

import bpy
from bpy.props import StringProperty

from ..core import ADDON, compat, drawing
from ..core.user_folder import own_folder
from .engine_state import place

_DEVICES = ("Auto", "CPU", "CUDA", "MPS")
_FOLDER = "vibe-render"  # inside a chosen cache folder: what Clear deletes is ours


class VibePreferences(bpy.types.AddonPreferences):
    """The add-on's preferences, kept with Blender's own."""

    bl_idname = ADDON

    engine: StringProperty(
        name="Engine",
        description="Folder of the Python environment that the engine runs in. Empty: look for it",
        subtype="DIR_PATH",
        update=lambda self, _context: place.look(self.engine),
    )
    device: StringProperty(
        name="Device",
        description="What the engine computes on: Auto (a graphics card if there is one), CPU, CUDA, CUDA:1, MPS",
        default="Auto",
        search=lambda _self, _context, _text: _DEVICES,
        search_options={"SUGGESTION"},
    )
    encoder: StringProperty(
        name="Encoder",
        description="An open_clip model's tag or a checkpoint that guides the look. Empty: the one that comes with it",
    )
    vlm_model: StringProperty(
        name="Model",
        description="A vision-language model that reads the prompt and the picture, and plans. Empty: none "
        "(or the one that the environment variable VIBE_VLM_MODEL names)",
        maxlen=200,
    )
    vlm_url: StringProperty(
        name="Endpoint",
        description="Base URL of the model's OpenAI-compatible server. Empty: OPENAI_BASE_URL, or OpenAI's",
        maxlen=500,
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
        place.look(self.engine)
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        self._draw_engine(_section(self.layout, "Engine", "SHADERFX"), context)
        column = _section(self.layout, "Vision-Language Model (optional)", "OUTLINER_OB_IMAGE")
        column.prop(self, "vlm_model", placeholder="None: the offline planner reads the words")
        column.prop(self, "vlm_url", placeholder="https://api.openai.com/v1")
        column.prop(self, "vlm_key", placeholder="Kept in Blender's preferences only")
        if self.vlm_model and not online():
            column.label(text="Online access is off: only a model on this computer is asked", icon="INFO")
        column = _section(self.layout, "Cache", "FILE_CACHE")
        column.prop(self, "cache", text="Folder", placeholder="The extension's own")
        row = column.split(factor=0.4)
        row.label()
        row = row.row()
        row.label(text=_usage(cache_folder(context)))
        row.operator("vibe.clear_cache", icon="TRASH")

    def _draw_engine(self, column: bpy.types.UILayout, context: bpy.types.Context) -> None:
        column.prop(self, "engine", text="Folder", placeholder="Found by itself")
        split = column.split(factor=0.4)
        split.label()
        about = split.column()
        draw_place(about)
        if not place.setting_up:
            row = about.row(align=True)
            row.operator("vibe.setup_engine", icon="IMPORT")
            row.operator("vibe.test_engine", icon="CHECKMARK")
            row.operator("vibe.look_for_engine", text="", icon="FILE_REFRESH")
        if place.said and not place.testing:
            icon, letters = "CHECKMARK" if place.works else "ERROR", int(drawing.columns(context) * 0.55)
            drawing.paragraph(about, context, place.said, icon, letters=letters)
        column.separator()
        column.prop(self, "device")
        column.prop(self, "encoder", placeholder="The one that comes with it")


def _section(layout: bpy.types.UILayout, title: str, icon: str) -> bpy.types.UILayout:
    box = layout.box()
    box.label(text=title, icon=icon)
    return box.column()


def draw_place(layout: bpy.types.UILayout) -> None:
    """One line about where the engine is, or how its setup goes."""
    if place.setting_up and place.setup:
        row = layout.row(align=True)
        row.progress(factor=place.setup.fraction or 0.0, text=place.setup.text)
        row.operator("vibe.cancel_setup", text="", icon="X")
    elif place.testing:
        layout.label(text="Starting the engine to see whether it answers…", icon="TIME")
    elif place.searching:
        layout.label(text="Looking for the engine…", icon="TIME")
    elif place.python:
        layout.label(text=f"Found: {_short(place.python)}", icon="CHECKMARK")
    else:
        layout.label(text="Not found on this computer", icon="INFO")


def _short(python: Path) -> str:
    """The environment that a Python is in, from the user's home."""
    folder = python.parent.parent
    home = Path.home()
    return f"~/{folder.relative_to(home)}" if folder.is_relative_to(home) else str(folder)


class VIBE_OT_clear_cache(bpy.types.Operator):
    """Delete what the engine keeps; it is made again when it is needed"""

    bl_idname = "vibe.clear_cache"
    bl_label = "Clear"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only when there is something, and nobody reads it."""
        from .state import desk  # it reads these preferences

        running = desk.running
        cls.poll_message_set("A vibe is on its way, and reads it" if running else "The cache is empty")
        return not running and cache_folder(context).is_dir()

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Deletes our folder in the cache folder, and nothing beside it."""
        import shutil

        shutil.rmtree(cache_folder(context), ignore_errors=True)
        _known.clear()
        return {"FINISHED"}


def get(context: bpy.types.Context) -> VibePreferences | None:
    """The add-on's preferences; None where it is registered without being installed (tests)."""
    addon = context.preferences.addons.get(ADDON)
    return addon.preferences if addon else None


def engine_choice(context: bpy.types.Context) -> str:
    """The folder that the artist has chosen for the engine; "" to look for it."""
    chosen = get(context)
    return chosen.engine if chosen else ""


def cache_folder(context: bpy.types.Context) -> Path:
    """Where the engine keeps what can be made again."""
    chosen = get(context)
    if chosen and chosen.cache:
        return Path(bpy.path.abspath(chosen.cache)).expanduser() / _FOLDER
    return own_folder("cache") / _FOLDER


def online() -> bool:
    """Whether other computers may be reached: Blender's own setting, which `--online-mode` overrides.

    Where Blender is a Python module there is no such setting to click: the command line decides.
    """
    return compat.IS_MODULE or bpy.app.online_access


_known: dict[Path, tuple[float, str]] = {}  # when a folder was measured, and what was found


def _usage(folder: Path) -> str:
    """How much a folder holds, in words; measured every few seconds at most."""
    when, text = _known.get(folder, (0.0, ""))
    if time.monotonic() - when > 3.0:
        files = [f.stat().st_size for f in folder.rglob("*") if f.is_file()] if folder.is_dir() else []
        count = f"{len(files)} file{'s' if len(files) > 1 else ''}"
        text = f"{drawing.size(sum(files))} in {count}" if files else "Empty"
        _known[folder] = time.monotonic(), text
    return text


CLASSES = (VibePreferences, VIBE_OT_clear_cache)
