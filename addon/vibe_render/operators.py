# SPDX-License-Identifier: GPL-3.0-or-later
# mypy: disable-error-code="valid-type"
"""A vibe, from the button to its end: started, stopped, given up, asked about. It leaves one step to undo."""

from __future__ import annotations

import contextlib
import traceback
from typing import ClassVar

import bpy
from bpy.props import BoolProperty, EnumProperty, StringProperty

from . import chosen, drawing, history
from .contract import schema
from .desk import desk
from .engine_place import place
from .roster import GEOMETRY
from .session import Session

_TICK = 0.1  # seconds between looks at the engine


def obstacle(context: bpy.types.Context) -> str:
    """Why there can be no vibe now; "" if there can."""
    scene = context.scene
    if desk.running:
        return "A vibe is on its way"
    if reason := untouchable(context):
        return reason
    if not scene.vibe.prompt.strip():
        return "Describe a mood first"
    if not any(obj.type in GEOMETRY for obj in scene.objects):
        return "The scene has no mesh"
    if not scene.vibe.groups():
        return "Nothing may change: open a lock"
    if scene.vibe.subject == "COLLECTION" and not scene.vibe.collection:
        return "Choose the subject's collection"
    if scene.vibe.subject == "SELECTED" and not (context.selected_objects or chosen.recall(scene)):
        return "Select the subject"
    if place.problem:
        return "Set up the engine first"
    return ""


def untouchable(context: bpy.types.Context) -> str:
    """Why nothing in the scene may be changed just now; "" if it may."""
    if not context.scene.is_editable:
        return "This scene is linked from a library"
    if context.mode != "OBJECT":  # elsewhere undo knows the mode's own steps only
        return "Go to Object Mode first"
    return ""


class VIBE_OT_run(bpy.types.Operator):
    """Change the scene's materials, lights, fog and grading until it looks like the words"""

    bl_idname = "vibe.run"
    bl_label = "Vibe It"
    bl_options: ClassVar[set[str]] = {"UNDO"}  # no REGISTER: "Adjust Last Operation" would do it all again

    again: BoolProperty(
        name="Again", description="The same words once more, with another seed", options={"SKIP_SAVE"}
    )

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        """What a click does."""
        if properties.again:
            return "Look once more for the same words, from here, with another seed"
        return cls.__doc__ or ""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Greyed out, with the reason, while there is an obstacle."""
        reason = obstacle(context)
        if reason:
            cls.poll_message_set(reason)
        return not reason

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Starts the vibe in the background."""
        self._session = self._begin(context, ask=True)
        manager = context.window_manager
        self._timer = manager.event_timer_add(_TICK, window=context.window)
        manager.modal_handler_add(self)
        context.workspace.status_text_set("Vibe Render is at work     Esc: stop")
        drawing.redraw()
        return {"RUNNING_MODAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Does it all at once, for scripts without a window."""
        session = self._begin(context)
        failure = None
        while failure is None and desk.running:
            failure = _advance(session)
        return self._done(failure, "ERROR")

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Looks at the engine on every tick; everything else is Blender's, but for Esc."""
        session = self._session
        if desk.session is not session or not desk.running:  # given up elsewhere
            self._clean_up(context)
            return {"CANCELLED"}
        if event.type == "ESC" and event.value == "PRESS" and not bpy.app.is_job_running("RENDER"):
            return self._escape(context)
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        failure = _advance(session)
        drawing.redraw()
        if desk.running and failure is None:
            return {"PASS_THROUGH"}
        self._clean_up(context)
        return self._done(failure, "WARNING")  # the panel explains; no need for a pop-up

    def cancel(self, context: bpy.types.Context) -> None:
        """Another file is opened, or the window is closed: nothing has been written yet."""
        if desk.session is self._session:
            desk.cancel()
        self._clean_up(context)

    def _begin(self, context: bpy.types.Context, ask: bool = False) -> Session:
        settings = context.scene.vibe
        if self.again and settings.vibed_prompt:
            settings.prompt = settings.vibed_prompt
            settings.seed += 1
        history.remember(settings.prompt.strip())
        return desk.begin(context, ask)

    def _escape(self, context: bpy.types.Context) -> set[str]:
        """The best so far if there is one; nothing, if there is none yet or this is the second Esc."""
        if self._session.can_stop:
            with contextlib.suppress(schema.VibeError):  # the next tick finds out and tells
                self._session.stop()
            context.workspace.status_text_set("Taking the best so far     Esc: give it up")
            return {"RUNNING_MODAL"}
        desk.cancel()
        self._clean_up(context)
        self.report({"INFO"}, "Vibe canceled; the scene is as it was")
        return {"CANCELLED"}

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
        if context.workspace:  # none while another file is opened
            context.workspace.status_text_set(None)
        drawing.redraw()


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
        cls.poll_message_set("No vibe is on its way")
        return desk.running


class VIBE_OT_stop(_Running):
    """Stop looking, and take the best look so far"""

    bl_idname = "vibe.stop"
    bl_label = "Stop"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only while there is a best so far."""
        cls.poll_message_set("There is no look yet to take")
        return desk.running and bool(desk.session and desk.session.can_stop)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Asks the engine; its result arrives as usual."""
        try:
            if desk.session:
                desk.session.stop()
        except schema.VibeError as error:
            self.report({"ERROR"}, str(error))
        return {"FINISHED"}


class VIBE_OT_cancel(_Running):
    """Give this vibe up, and leave the scene as it was"""

    bl_idname = "vibe.cancel"
    bl_label = "Cancel"

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Gives up."""
        desk.cancel()
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
        if desk.session:
            desk.session.answer(self.shared)
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


class VIBE_OT_recall(bpy.types.Operator):
    """Put these words into the prompt"""

    bl_idname = "vibe.recall"
    bl_label = "Recall"
    bl_options: ClassVar[set[str]] = {"REGISTER", "UNDO", "INTERNAL"}

    prompt: StringProperty()

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        """All of the words."""
        return properties.prompt

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Sets the prompt."""
        context.scene.vibe.prompt = self.prompt
        return {"FINISHED"}


class VIBE_OT_clear_history(bpy.types.Operator):
    """Forget the prompts that were typed"""

    bl_idname = "vibe.clear_history"
    bl_label = "Clear History"

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Forgets."""
        history.clear()
        return {"FINISHED"}


CLASSES = (
    VIBE_OT_run,
    VIBE_OT_stop,
    VIBE_OT_cancel,
    VIBE_OT_answer,
    VIBE_OT_dismiss,
    VIBE_OT_recall,
    VIBE_OT_clear_history,
)
