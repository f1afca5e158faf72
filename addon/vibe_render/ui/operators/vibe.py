# SPDX-License-Identifier: GPL-3.0-or-later
# mypy: disable-error-code="valid-type"
"""Vibe It: a vibe from the button to its end, in the background. It leaves one undo step."""

from __future__ import annotations

import contextlib
import time
from typing import ClassVar

import bpy
from bpy.props import BoolProperty

from ...core import drawing
from ...core.schema_import import faults, schema
from ...run import prompt_history
from ...run.session import Session
from ...run.state import addon_state
from ..obstacles import obstacle

_TICK = 0.02  # seconds between two steps of the session
_REDRAW = 0.1  # seconds after which the panels are drawn again though the stage is the same


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
        """Grayed out, with the reason, while there is an obstacle."""
        reason = obstacle(context)
        if reason:
            cls.poll_message_set(reason)
        return not reason

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Starts the vibe in the background."""
        self._session = self._begin(context, ask=True)
        self._drawn = "", 0.0
        manager = context.window_manager
        self._timer = manager.event_timer_add(_TICK, window=context.window)
        manager.modal_handler_add(self)
        context.workspace.status_text_set("Vibe Render is at work     Esc: stop")
        drawing.redraw()
        return {"RUNNING_MODAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Runs the whole vibe at once, for scripts without a window."""
        session = self._begin(context)
        failure = None
        while failure is None and addon_state.running:
            failure = _advance(session)
            time.sleep(_TICK)  # the engine needs the core
        return self._done(failure, "ERROR")

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Does a step on every tick of the timer; takes Esc; passes everything else through."""
        session = self._session
        if (
            addon_state.session is not session or not addon_state.running
        ):  # canceled by its button or by another file
            self._clean_up(context)
            return {"CANCELLED"}
        if event.type == "ESC" and event.value == "PRESS" and not bpy.app.is_job_running("RENDER"):
            return self._escape(context)
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        failure = _advance(session)
        self._redraw(session)
        if addon_state.running and failure is None:
            return {"PASS_THROUGH"}
        self._clean_up(context)
        return self._done(failure, "WARNING")  # the panel explains; no need for a pop-up

    def _redraw(self, session: Session) -> None:
        """Draws the panels again: at once when a stage begins, which may block Blender in the next step."""
        now = time.monotonic()
        if session.stage != self._drawn[0] or now - self._drawn[1] > _REDRAW:
            self._drawn = session.stage, now
            drawing.redraw()

    def cancel(self, context: bpy.types.Context) -> None:
        """Blender calls this when the window closes; nothing has been written yet."""
        if addon_state.session is self._session:
            addon_state.cancel()
        self._clean_up(context)

    def _begin(self, context: bpy.types.Context, ask: bool = False) -> Session:
        settings = context.scene.vibe
        if self.again and (settings.vibed_prompt or settings.vibed_like):
            settings.prompt = settings.vibed_prompt
            settings.seed += 1
        if words := settings.prompt.strip():
            prompt_history.remember(words, settings.told())
        return addon_state.begin(context, ask)

    def _escape(self, context: bpy.types.Context) -> set[str]:
        """The first Esc takes the best look so far, if there is one; otherwise the vibe is canceled."""
        if self._session.can_stop:
            with contextlib.suppress(schema.VibeError):  # the next tick finds out and tells
                self._session.stop()
            context.workspace.status_text_set("Taking the best so far     Esc: give it up")
            return {"RUNNING_MODAL"}
        addon_state.cancel()
        self._clean_up(context)
        self.report({"INFO"}, "Vibe canceled; the scene is as it was")
        return {"CANCELLED"}

    def _done(self, failure: schema.VibeError | None, severity: str) -> set[str]:
        if failure is None:
            note = addon_state.session.model_note if addon_state.session else ""
            self.report({"WARNING" if note else "INFO"}, note or "The vibe is in the scene")
            return {"FINISHED"}
        addon_state.end(failure)
        self.report({severity}, str(failure))
        return {"CANCELLED"}

    def _clean_up(self, context: bpy.types.Context) -> None:
        context.window_manager.event_timer_remove(self._timer)
        if context.workspace:  # none while another file is opened
            context.workspace.status_text_set(None)
        drawing.redraw()


def _advance(session: Session) -> schema.VibeError | None:
    """Does the next step of a vibe; returns the error if it fails."""
    try:
        if not session.advance():
            addon_state.end()
    except schema.VibeError as error:
        return error
    except Exception as error:  # an artist must never be left with a stuck panel
        return faults.unexpected(error, session.stage.lower())
    return None


CLASSES = (VIBE_OT_run,)
