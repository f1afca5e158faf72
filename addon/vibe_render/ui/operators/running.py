# SPDX-License-Identifier: GPL-3.0-or-later
# mypy: disable-error-code="valid-type"
"""The buttons while a vibe runs (stop, cancel, answer), and for its failure and earlier prompts."""

from __future__ import annotations

from typing import ClassVar

import bpy
from bpy.props import EnumProperty, StringProperty

from ...core import drawing
from ...core.schema_import import checks, schema, targets
from ...run import prompt_history
from ...run.state import addon_state


class _Running(bpy.types.Operator):
    """An operator for a vibe that runs."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only while a vibe runs."""
        cls.poll_message_set("No vibe is on its way")
        return addon_state.running


class VIBE_OT_stop(_Running):
    """Stop now, and use the best look so far"""

    bl_idname = "vibe.stop"
    bl_label = "Stop"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only while there is a best look so far."""
        cls.poll_message_set("There is no look yet to take")
        return addon_state.running and bool(addon_state.session and addon_state.session.can_stop)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Asks the engine; its result arrives as usual."""
        try:
            if addon_state.session:
                addon_state.session.stop()
        except schema.VibeError as error:
            self.report({"ERROR"}, str(error))
        return {"FINISHED"}


class VIBE_OT_cancel(_Running):
    """Stop now, and leave the scene as it was"""

    bl_idname = "vibe.cancel"
    bl_label = "Cancel"

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Cancels the vibe."""
        addon_state.cancel()
        drawing.redraw()
        return {"FINISHED"}


class VIBE_OT_answer(_Running):
    """Answer, for this scene's other vibes too"""

    bl_idname = "vibe.answer"
    bl_label = "Answer"
    bl_options: ClassVar[set[str]] = {"INTERNAL"}

    shared: EnumProperty(
        items=(
            ("ALL", "Affect All Users", "The other things change with the subject"),
            ("SINGLE", "Make Single-User", "The subject gets copies of its own; Revert takes them away"),
        )
    )

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        """What the answer means."""
        return cls.bl_rna.properties["shared"].enum_items[properties.shared].description

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Goes on with the vibe."""
        context.scene.vibe.shared = self.shared
        if addon_state.session:
            addon_state.session.answer(self.shared)
        return {"FINISHED"}


class VIBE_OT_dismiss(bpy.types.Operator):
    """Close this message"""

    bl_idname = "vibe.dismiss"
    bl_label = "Dismiss"
    bl_options: ClassVar[set[str]] = {"INTERNAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Forgets the failure."""
        addon_state.forget()
        return {"FINISHED"}


class VIBE_OT_recall(bpy.types.Operator):
    """Put these words into the prompt"""

    bl_idname = "vibe.recall"
    bl_label = "Recall"
    bl_options: ClassVar[set[str]] = {"UNDO", "INTERNAL"}

    prompt: StringProperty()

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        """All of the words."""
        return properties.prompt

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Sets the prompt, and what its words describe as far as the scene has that."""
        settings = context.scene.vibe
        settings.prompt = self.prompt
        for word, target in checks.targets(prompt_history.targets_of(self.prompt)).items():
            if _is_in(context.scene, target):
                settings.tell(word, target)
        return {"FINISHED"}


def _is_in(scene: bpy.types.Scene, target: str) -> bool:
    """Whether a scene has all of what a target names."""
    known = (targets.GENERAL, scene.objects, bpy.data.materials)
    return all(any(name in names for names in known) for name in targets.parted(target))


class VIBE_OT_clear_history(bpy.types.Operator):
    """Forget the prompts that were typed"""

    bl_idname = "vibe.clear_history"
    bl_label = "Clear History"

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Forgets."""
        prompt_history.clear()
        return {"FINISHED"}


CLASSES = (
    VIBE_OT_stop,
    VIBE_OT_cancel,
    VIBE_OT_answer,
    VIBE_OT_dismiss,
    VIBE_OT_recall,
    VIBE_OT_clear_history,
)
