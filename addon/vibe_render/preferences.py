# SPDX-License-Identifier: GPL-3.0-or-later
# mypy: disable-error-code="valid-type"
"""Where the engine is, what it runs on, and the vision-language model that it may ask."""

import time

import bpy
from bpy.props import BoolProperty, StringProperty

from .contract import messages, schema
from .engine import Engine

_PATIENCE = 20.0  # seconds that a test waits for the engine's first word


class VibePreferences(bpy.types.AddonPreferences):
    """The add-on's preferences, kept with Blender's own."""

    bl_idname = __package__

    engine: StringProperty(
        name="Engine",
        description="Folder of the Python environment that vibe-render is installed in. Empty: look for it",
        subtype="DIR_PATH",
    )
    device: StringProperty(
        name="Device",
        description="What the engine computes on: auto, cpu, cuda or mps",
        default="auto",
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
    tested: StringProperty(options={"SKIP_SAVE", "HIDDEN"})
    works: BoolProperty(options={"SKIP_SAVE", "HIDDEN"})

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the preferences."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column()
        column.prop(self, "engine", placeholder="Found by itself")
        column.operator("vibe.test_engine", icon="CHECKMARK")
        if self.tested:
            row = column.row()
            row.alert = not self.works
            row.label(text=self.tested, icon="CHECKMARK" if self.works else "ERROR")
        layout.separator()
        column = layout.column()
        column.prop(self, "device")
        column.prop(self, "encoder", placeholder="Embedded")
        layout.separator()
        column = layout.column(heading="Vision-Language Model")
        column.prop(self, "vlm_model", placeholder="None")
        column.prop(self, "vlm_url", placeholder="https://api.openai.com/v1")
        column.prop(self, "vlm_key")
        if self.vlm_model and not online():
            column.label(text="Online access is off: only a model on this computer is asked", icon="INFO")


class VIBE_OT_test_engine(bpy.types.Operator):
    """Start the engine once and see whether it answers"""

    bl_idname = "vibe.test_engine"
    bl_label = "Test Engine"

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Runs the test; what it found is shown beside the button."""
        preferences = get(context)
        choice = preferences.engine if preferences else ""
        try:
            said, works = f"Engine {_version(choice)} answers", True
        except schema.VibeError as error:
            said, works = str(error), False
        if preferences:
            preferences.tested, preferences.works = said, works
        self.report({"INFO"} if works else {"ERROR"}, said)
        return {"FINISHED"} if works else {"CANCELLED"}


def get(context: bpy.types.Context) -> VibePreferences | None:
    """The add-on's preferences; None where it is registered without being installed (tests)."""
    addon = context.preferences.addons.get(__package__)
    return addon.preferences if addon else None


def online() -> bool:
    """Whether other computers may be reached: Blender's own setting, which `--online-mode` overrides.

    Where Blender is a Python module there is no such setting to click: the command line decides.
    """
    return bpy.app.module or bpy.app.online_access


def _version(choice: str) -> str:
    """Starts an engine and returns its version; raises VibeError if it does not answer."""
    engine = Engine(choice)
    engine.start()
    try:
        end = time.monotonic() + _PATIENCE
        while time.monotonic() < end:
            for message in engine.poll():
                if isinstance(message, messages.Ready):
                    return message.version
            time.sleep(0.05)
    finally:
        engine.stop()
    raise schema.VibeError("The engine does not answer.", f"See {engine.log}.")


CLASSES = (VibePreferences, VIBE_OT_test_engine)
