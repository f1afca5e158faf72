# SPDX-License-Identifier: GPL-3.0-or-later
"""The buttons that find, make and try the engine, in the panel and in the preferences."""

from __future__ import annotations

import bpy

from ...core.schema_import import schema
from ...session.engine_state import place, version
from ...session.preferences import engine_choice, online


class VIBE_OT_setup_engine(bpy.types.Operator):
    """Download the engine once, into the extension's own folder: Python packages from the Python Package Index, several GB"""

    bl_idname = "vibe.setup_engine"
    bl_label = "Set Up Engine"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Not without leave to go online."""
        if not online():
            cls.poll_message_set("Online access is off: see Preferences > System > Network")
        elif place.setting_up:
            cls.poll_message_set("It is being set up already")
        return online() and not place.setting_up

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Begins; panels and preferences show how it goes."""
        try:
            place.set_up()
        except schema.VibeError as error:
            place.said, place.works = str(error), False
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class VIBE_OT_cancel_setup(bpy.types.Operator):
    """Stop setting up the engine, and remove what has been installed of it"""

    bl_idname = "vibe.cancel_setup"
    bl_label = "Cancel"

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Cancels."""
        if place.setup:
            place.setup.cancel()
        return {"FINISHED"}


class VIBE_OT_look_for_engine(bpy.types.Operator):
    """Look for the engine once more"""

    bl_idname = "vibe.look_for_engine"
    bl_label = "Look Again"

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Looks."""
        place.look(engine_choice(context), again=True)
        return {"FINISHED"}


class VIBE_OT_test_engine(bpy.types.Operator):
    """Start the engine once and see whether it answers"""

    bl_idname = "vibe.test_engine"
    bl_label = "Test Engine"

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Tests beside Blender; what comes of it is shown under the button."""
        place.test(engine_choice(context))
        return {"FINISHED"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Tests at once, for scripts."""
        try:
            self.report({"INFO"}, f"Engine {version(engine_choice(context))} answers")
        except schema.VibeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


CLASSES = (
    VIBE_OT_setup_engine,
    VIBE_OT_cancel_setup,
    VIBE_OT_look_for_engine,
    VIBE_OT_test_engine,
)
