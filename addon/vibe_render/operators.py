# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panel's buttons do. Each leaves one step to undo."""

from __future__ import annotations

import traceback
from typing import ClassVar

import bpy

from . import changes, result, snapshot
from .contract import schema
from .roster import GEOMETRY
from .session import Session, desk

_TICK = 0.1  # seconds between looks at the engine


def obstacle(context: bpy.types.Context) -> str:
    """Why there can be no vibe now; "" if there can."""
    scene = context.scene
    if desk.running:
        return "A vibe is on its way"
    if not scene.vibe.prompt.strip():
        return "Describe a mood first"
    if not any(obj.type in GEOMETRY for obj in scene.objects):
        return "The scene has no mesh"
    if not scene.vibe.groups():
        return "Nothing may change: open a lock"
    if scene.vibe.subject == "COLLECTION" and not scene.vibe.collection:
        return "Choose the subject's collection"
    if scene.vibe.subject == "SELECTED" and not context.selected_objects:
        return "Select the subject"
    return ""


def redraw(context: bpy.types.Context) -> None:
    """Draws the sidebars anew, and nothing else."""
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                for region in area.regions:
                    if region.type == "UI":
                        region.tag_redraw()


class VIBE_OT_run(bpy.types.Operator):
    """Change the scene's materials, lights, fog and grading until it looks like the words"""

    bl_idname = "vibe.run"
    bl_label = "Vibe It"
    bl_options: ClassVar[set[str]] = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Greyed out, with the reason, while there is an obstacle."""
        reason = obstacle(context)
        if reason:
            cls.poll_message_set(reason)
        return not reason

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Starts the vibe in the background."""
        desk.begin(context)
        manager = context.window_manager
        self._timer = manager.event_timer_add(_TICK, window=context.window)
        manager.modal_handler_add(self)
        context.workspace.status_text_set("Vibe Render is at work     Esc: cancel")
        redraw(context)
        return {"RUNNING_MODAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Does it all at once, for scripts without a window."""
        session = desk.begin(context)
        failure = None
        while failure is None and desk.running:
            failure = _advance(session)
        return self._done(failure, "ERROR")

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Looks at the engine on every tick; everything else is Blender's, but for Esc."""
        if event.type == "ESC" and event.value == "PRESS":
            self.cancel(context)
            self.report({"INFO"}, "Vibe canceled; the scene is as it was")
            return {"CANCELLED"}
        if event.type != "TIMER" or desk.session is None:
            return {"PASS_THROUGH"}
        failure = _advance(desk.session)
        redraw(context)
        if desk.running and failure is None:
            return {"PASS_THROUGH"}
        self._clean_up(context)
        return self._done(failure, "WARNING")  # the panel explains; no need for a pop-up

    def cancel(self, context: bpy.types.Context) -> None:
        """Esc, another file, or the window is closed: nothing has been written yet."""
        desk.cancel()
        self._clean_up(context)

    def _done(self, failure: schema.VibeError | None, severity: str) -> set[str]:
        if failure is None:
            note = desk.session.note if desk.session else ""
            self.report({"WARNING" if note else "INFO"}, note or "The vibe is in the scene")
            return {"FINISHED"}
        desk.end(failure)
        self.report({severity}, str(failure))
        return {"CANCELLED"}

    def _clean_up(self, context: bpy.types.Context) -> None:
        context.window_manager.event_timer_remove(self._timer)
        context.workspace.status_text_set(None)
        redraw(context)


def _advance(session: Session) -> schema.VibeError | None:
    """Does the next bit of a vibe; returns what went wrong, if something did."""
    try:
        if not session.advance():
            desk.end()
    except schema.VibeError as error:
        return error
    except Exception as error:  # an artist must never be left with a stuck panel
        traceback.print_exc()
        return schema.VibeError(f"Something broke: {error}.", "Please report it; the console says more.")
    return None


class _Running(bpy.types.Operator):
    """For buttons that are there while a vibe runs."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only while a vibe runs."""
        return desk.running


class VIBE_OT_stop(_Running):
    """Stop looking, and take the best look so far"""

    bl_idname = "vibe.stop"
    bl_label = "Stop"

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Asks the engine; its result arrives as usual."""
        try:
            if desk.session:
                desk.session.stop()
        except schema.VibeError as error:
            self.report({"ERROR"}, str(error))
        return {"FINISHED"}


class _Vibed(bpy.types.Operator):
    """For buttons that need a vibe in the scene."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only when there is something to revert to, and nothing runs."""
        reason = "A vibe is on its way" if desk.running else "This scene has not been vibed"
        cls.poll_message_set(reason)
        return not desk.running and snapshot.exists(context.scene)


class VIBE_OT_revert(_Vibed):
    """Restore the scene exactly as it was before the first vibe"""

    bl_idname = "vibe.revert"
    bl_label = "Revert"
    bl_options: ClassVar[set[str]] = {"REGISTER", "UNDO"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Reverts, and says what could not be restored."""
        try:
            lost = result.revert(context.scene)
        except schema.VibeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        desk.forget()
        if lost:
            self.report({"WARNING"}, f"{len(lost)} values could not be restored: {lost[0]}")
        return {"FINISHED"}


class VIBE_OT_keep(_Vibed):
    """Keep the scene as it is now, and forget how it was before"""

    bl_idname = "vibe.keep"
    bl_label = "Keep"
    bl_options: ClassVar[set[str]] = {"REGISTER", "UNDO"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Keeps."""
        result.keep(context.scene)
        desk.forget()
        return {"FINISHED"}


class VIBE_OT_dismiss(bpy.types.Operator):
    """Close this message"""

    bl_idname = "vibe.dismiss"
    bl_label = "Dismiss"
    bl_options: ClassVar[set[str]] = {"INTERNAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Forgets the failure."""
        desk.forget()
        return {"FINISHED"}


class VIBE_OT_why(bpy.types.Operator):
    """Why this value changed"""

    bl_idname = "vibe.why"
    bl_label = "Why"
    bl_options: ClassVar[set[str]] = {"INTERNAL"}

    key: bpy.props.StringProperty()  # type: ignore[valid-type]

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        """The reason, as a tool tip."""
        change = context.scene.vibe.changes[properties.key]
        where = f"{changes.title(change.name)}, found at {changes.parameter(change.name).blender}"
        return f"{change.reason}.\n{where}" if change.reason else where

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Says it in the status bar too."""
        self.report({"INFO"}, context.scene.vibe.changes[self.key].reason or "The look asked for it")
        return {"CANCELLED"}


CLASSES = (VIBE_OT_run, VIBE_OT_stop, VIBE_OT_revert, VIBE_OT_keep, VIBE_OT_dismiss, VIBE_OT_why)
