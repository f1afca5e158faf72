# SPDX-License-Identifier: GPL-3.0-or-later
# mypy: disable-error-code="valid-type"
"""The buttons that find, make and try the engine, and clear its cache, in the panel and in the preferences."""

from __future__ import annotations

import shutil

import bpy
from bpy.props import EnumProperty

from ...core import drawing
from ...core.preferences import cache_folder, engine_choice, online
from ...core.schema_import import schema
from ...engine import torch_builds
from ...run.engine_state import engine_state, setup_folder, version
from ...run.state import addon_state
from .. import cache_size

_DIALOG_WIDTH, _DIALOG_LETTERS = 420, 62


class VIBE_OT_setup_engine(bpy.types.Operator):
    """Download the engine once, into the extension's own folder: Python packages. What they are and how large is said first"""

    bl_idname = "vibe.setup_engine"
    bl_label = "Set Up Engine"

    build: EnumProperty(
        name="Runs On",
        description="What the engine computes on",
        items=[(b.key, b.name, f"{b.download} GB to download") for b in torch_builds.choices()],
        options={"SKIP_SAVE"},
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Not without leave to go online."""
        if not online():
            cls.poll_message_set("Online access is off: see Preferences > System > Network")
        elif engine_state.setting_up:
            cls.poll_message_set("It is being set up already")
        return online() and not engine_state.setting_up

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Says what will be downloaded, and lets the artist choose; nothing is before that."""
        self.build = torch_builds.suggested().key
        return context.window_manager.invoke_props_dialog(
            self, width=_DIALOG_WIDTH, title="Set Up Engine", confirm_text="Download"
        )

    def draw(self, context: bpy.types.Context) -> None:
        """What is downloaded, from where, and how large it is."""
        column = self.layout.column()
        if len(torch_builds.choices()) > 1:
            column.row().prop(self, "build", expand=True)
        for line in torch_builds.download_text(torch_builds.by_key(self.build), setup_folder()):
            drawing.paragraph(column, context, line, letters=_DIALOG_LETTERS)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Begins; panels and preferences show how it goes."""
        chosen = self.properties.is_property_set("build")
        build = torch_builds.by_key(self.build) if chosen else torch_builds.suggested()
        try:
            engine_state.set_up(build)
        except schema.VibeError as error:
            engine_state.outcome, engine_state.succeeded = str(error), False
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class VIBE_OT_cancel_setup(bpy.types.Operator):
    """Stop setting up the engine, and remove what has been installed of it"""

    bl_idname = "vibe.cancel_setup"
    bl_label = "Cancel"

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Cancels."""
        if engine_state.setup:
            engine_state.setup.cancel()
        return {"FINISHED"}


class VIBE_OT_look_for_engine(bpy.types.Operator):
    """Look for the engine once more"""

    bl_idname = "vibe.look_for_engine"
    bl_label = "Look Again"

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Looks."""
        engine_state.search(engine_choice(context), again=True)
        return {"FINISHED"}


class VIBE_OT_test_engine(bpy.types.Operator):
    """Start the engine once and see whether it answers"""

    bl_idname = "vibe.test_engine"
    bl_label = "Test Engine"

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Tests in the background; the result is shown under the button."""
        engine_state.test(engine_choice(context))
        return {"FINISHED"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Tests at once, for scripts."""
        try:
            self.report({"INFO"}, f"Engine {version(engine_choice(context))} answers")
        except schema.VibeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class VIBE_OT_clear_cache(bpy.types.Operator):
    """Delete what the engine keeps; it is made again when it is needed"""

    bl_idname = "vibe.clear_cache"
    bl_label = "Clear"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only when there is something, and nobody reads it."""
        running = addon_state.running
        cls.poll_message_set("A vibe is on its way, and reads it" if running else "The cache is empty")
        return not running and cache_folder(context).is_dir()

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Deletes our folder in the cache folder, and nothing beside it."""
        shutil.rmtree(cache_folder(context), ignore_errors=True)
        cache_size.measure_again()
        return {"FINISHED"}


CLASSES = (
    VIBE_OT_setup_engine,
    VIBE_OT_cancel_setup,
    VIBE_OT_look_for_engine,
    VIBE_OT_test_engine,
    VIBE_OT_clear_cache,
)
