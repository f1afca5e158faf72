# SPDX-License-Identifier: GPL-3.0-or-later
# mypy: disable-error-code="valid-type"
"""The buttons below a result: keep it, revert it, choose another variant. Each is one undo step."""

from __future__ import annotations

from typing import ClassVar

import bpy
from bpy.props import IntProperty, StringProperty

from ...core.schema_import import labels, schema
from ...run import result
from ...run.state import addon_state
from ..obstacles import result_obstacle


class _Vibed(bpy.types.Operator):
    """An operator that needs a vibe in the scene."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Grayed out, with the reason, unless there is a result and nothing runs."""
        reason = result_obstacle(context)
        if reason:
            cls.poll_message_set(reason)
        return not reason


class VIBE_OT_revert(_Vibed):
    """Restore the scene exactly as it was before the first vibe"""

    bl_idname = "vibe.revert"
    bl_label = "Revert"
    bl_options: ClassVar[set[str]] = {"UNDO"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Reverts, and says what could not be restored."""
        try:
            lost = result.revert(context.scene)
        except schema.VibeError as error:
            addon_state.end(error)  # it stays in the panel, not in a passing report alone
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        addon_state.forget()
        if lost:
            self.report({"WARNING"}, f"{len(lost)} values could not be restored: {lost[0]}")
        return {"FINISHED"}


class VIBE_OT_keep(_Vibed):
    """Keep the scene as it is now, and forget how it was before"""

    bl_idname = "vibe.keep"
    bl_label = "Keep"
    bl_options: ClassVar[set[str]] = {"UNDO"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Keeps."""
        result.keep(context.scene)
        addon_state.forget()
        return {"FINISHED"}


class VIBE_OT_variant(_Vibed):
    """Put this look into the scene in place of the other"""

    bl_idname = "vibe.variant"
    bl_label = "Variant"
    bl_options: ClassVar[set[str]] = {"UNDO", "INTERNAL"}

    number: IntProperty(min=0)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Writes its values."""
        session, scene = addon_state.session, context.scene
        if session is None or not 0 <= self.number < len(session.variants):
            self.report({"ERROR"}, "That look is not there any more")
            return {"CANCELLED"}
        variants = [variant for variant, _ in session.variants]
        try:
            result.choose(scene, self.number, variants, session.subject(scene))
        except schema.VibeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class VIBE_OT_why(bpy.types.Operator):
    """Why this value changed"""

    bl_idname = "vibe.why"
    bl_label = "Why"
    bl_options: ClassVar[set[str]] = {"INTERNAL"}

    key: StringProperty()

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        """The reason, as a tool tip."""
        change = context.scene.vibe.changes[properties.key]
        where = f"{labels.title(change.name)}, found at {labels.parameter(change.name).blender}"
        return f"{change.reason}.\n{where}" if change.reason else where

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Reports the reason in the status bar too."""
        self.report({"INFO"}, context.scene.vibe.changes[self.key].reason or "The look asked for it")
        return {"CANCELLED"}


CLASSES = (VIBE_OT_revert, VIBE_OT_keep, VIBE_OT_variant, VIBE_OT_why)
