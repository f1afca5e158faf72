# SPDX-License-Identifier: GPL-3.0-or-later
"""Vibe It: runs a vibe in the background, draws its progress in the panel, and has the buttons that end it."""

from __future__ import annotations

import contextlib
import time

import bpy
from bpy.props import BoolProperty, EnumProperty

from ..core.schema_import import errors, schema
from ..render import reference
from ..run.driver import LOOKING
from ..run.notes import failure_note
from ..run.session import PAUSING, SILENT, Session
from ..run.state import addon_state
from ..scene import subject
from . import bases, drawing, light_mix, live, words
from .engine_state import engine_state
from .properties import SHARED

_TICK = 0.02  # seconds between two steps of the session
_REDRAW = 0.1  # seconds after which the panels are drawn again though the stage is the same


# A vibe leaves one undo step. No REGISTER: "Adjust Last Operation" would do it all again.
class Vibing(bases.Operator, options={"UNDO"}):
    """An operator that runs a vibe: in the background from its button, in one call from a script."""

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if done := self._start(context, ask=True):
            return done
        self._drawn = "", 0.0
        manager = context.window_manager
        self._timer = manager.event_timer_add(_TICK, window=context.window)
        manager.modal_handler_add(self)
        context.workspace.status_text_set("Vibe Render is running · Esc to stop")
        drawing.redraw()
        return {"RUNNING_MODAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Runs the whole vibe in one call, for scripts without a window."""
        if done := self._start(context):
            return done
        failure = None
        while failure is None and addon_state.running:
            failure = _advance(self._session)
            time.sleep(_TICK)  # the engine needs the core
        return self._done(failure, "ERROR")

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Does a step at every tick of the timer, handles Esc, and passes all other events through."""
        session = self._session
        # Canceled by its button, or by another file that was opened.
        if addon_state.session is not session or not addon_state.running:
            self._clean_up(context)
            return {"CANCELLED"}
        if event.type == "ESC" and event.value == "PRESS" and not bpy.app.is_job_running("RENDER"):
            # The first Esc takes the best look so far, if there is one; otherwise the vibe is canceled.
            if session.can_stop:
                with contextlib.suppress(schema.VibeError):  # the next tick reports the error
                    session.stop()
                context.workspace.status_text_set("Taking the best so far · Esc to cancel")
                return {"RUNNING_MODAL"}
            addon_state.cancel()
            self._clean_up(context)
            self.report({"INFO"}, "Vibe canceled; the scene is as it was")
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        failure = _advance(session)
        # Redraw at once when a stage begins, because its next step may block Blender.
        now = time.monotonic()
        if session.stage != self._drawn[0] or now - self._drawn[1] > _REDRAW:
            self._drawn = session.stage, now
            drawing.redraw()
        if addon_state.running and failure is None:
            return {"PASS_THROUGH"}
        self._clean_up(context)
        return self._done(failure, "WARNING")  # the panel explains; no need for a pop-up

    def cancel(self, context: bpy.types.Context) -> None:
        """Cancels the vibe, of which nothing is written yet; Blender calls this when the window closes."""
        if addon_state.session is self._session:
            addon_state.cancel()
        self._clean_up(context)

    def _start(self, context: bpy.types.Context, ask: bool = False) -> set[str]:
        """Begins a session; returns an empty set, or Blender's result if the work is done already or has failed."""
        try:
            session = self._begin(context, ask)
        except schema.VibeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if session is None:
            return self._done(None, "INFO")
        self._session = session
        return set()

    def _begin(self, context: bpy.types.Context, ask: bool = False) -> Session | None:
        """Begins and returns a session, which may ask about shared materials if `ask`; None if all is done already."""
        raise NotImplementedError

    def _done(self, failure: schema.VibeError | None, severity: str) -> set[str]:
        if failure is None:
            note = failure_note(addon_state.session.report) if addon_state.session else ""
            light_mix.render_soon()
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


class VIBE_OT_run(Vibing, label="Vibe It"):
    """Change the scene's materials, lights, fog and grading until it looks like the words"""

    again: BoolProperty(name="Retry", description="The same words once more, with another seed", options={"SKIP_SAVE"})

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        if properties.again:
            return "Search once more for the same words, from here, with another seed"
        return cls.__doc__ or ""

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        scene = context.scene
        if addon_state.running:
            return bases.RUNNING
        if reason := bases.untouchable(context) or reference.picture_obstacle(scene.vibe):
            return reason
        if not scene.vibe.prompt.strip() and not reference.picture_name(scene.vibe):
            return "Describe a mood first"
        if not bases.has_mesh(scene):
            return "The scene has no mesh"
        if not scene.vibe.groups():
            return "All groups are locked. Unlock at least one under Affect"
        if scene.vibe.subject == "COLLECTION" and not scene.vibe.collection:
            return "Choose the subject's collection"
        if scene.vibe.subject == "SELECTED" and not (context.selected_objects or subject.recall_subject(scene)):
            return "Select the subject"
        if engine_state.problem:
            return "Set up the engine first"
        return ""

    def _begin(self, context: bpy.types.Context, ask: bool = False) -> Session:
        settings = context.scene.vibe
        if self.again and (settings.vibed_prompt or settings.vibed_like):
            settings.prompt = settings.vibed_prompt
            settings.seed += 1
        if prompt := settings.prompt.strip():
            words.remember(prompt, settings.target_pairs())
        return addon_state.begin(context, ask)


def _advance(session: Session) -> schema.VibeError | None:
    """Does the next step of a vibe; returns the error if it fails."""
    try:
        if not session.advance():
            addon_state.end()
    except Exception as error:  # an artist must never be left with a stuck panel
        return errors.to_show(error, session.stage.lower())
    return None


class _Running(bases.Operator):
    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        return "" if addon_state.running else "No vibe is running"


class VIBE_OT_stop(bases.Operator, label="Stop"):
    """Stop now, and use the best look so far"""

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        session = addon_state.session
        stoppable = addon_state.running and session and session.can_stop
        return "" if stoppable else "There is no look yet to take"

    def perform(self, context: bpy.types.Context) -> None:
        if addon_state.session:
            addon_state.session.stop()


class VIBE_OT_cancel(_Running, label="Cancel"):
    """Stop now, and leave the scene as it was"""

    def perform(self, context: bpy.types.Context) -> None:
        addon_state.cancel()


class VIBE_OT_answer(_Running, label="Answer", options={"INTERNAL"}):
    """Answer, for this scene's other vibes too"""

    shared: EnumProperty(items=SHARED)

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        return cls.bl_rna.properties["shared"].enum_items[properties.shared].description

    def perform(self, context: bpy.types.Context) -> None:
        context.scene.vibe.shared = self.shared
        if addon_state.session:
            addon_state.session.answer(self.shared)


class VIBE_OT_dismiss(bases.Operator, label="Dismiss", options={"INTERNAL"}):
    """Close this message"""

    def perform(self, context: bpy.types.Context) -> None:
        addon_state.forget()


def draw(layout: bpy.types.UILayout, context: bpy.types.Context, session: Session) -> None:
    """Draws a running vibe: images, progress bar, Stop and Cancel; or its question and Cancel."""
    box = layout.box()
    if session.scene != context.scene.name:
        box.label(text=f"In the scene {session.scene}", icon="SCENE_DATA")
    if session.question:
        _draw_question(box, context, session.question)
    else:
        drawing.before_after(box, session.before, session.preview, 11.5)
        stage, progress = f"{session.stage}…", session.progress
        if progress and session.stage == LOOKING:
            left = drawing.duration(progress.seconds_left)
            stage = f"Round {progress.round} of {progress.rounds}  ·  {left} left"
        box.progress(factor=session.fraction, text=stage)
        live.draw_words(box, context, session.words)
        warnings = [*session.view_notes]
        if session.silence > SILENT and session.stage not in PAUSING:
            silence = drawing.duration(session.silence)
            warnings.append(f"No response from the engine for {silence}. Wait, or cancel and try again.")
        for warning in warnings:
            drawing.paragraph(box, context, warning, "ERROR")
    if session.look:
        drawing.see_rendered(box, context)
    buttons = box.column(align=True)
    buttons.scale_y = 1.3
    if not (session.question or session.checking):
        buttons.operator("vibe.stop", text="Stop and Use Best")
    buttons.operator("vibe.cancel", icon="X")
    esc = "Esc stops and uses the best" if session.can_stop else "Esc cancels"
    drawing.caption(box, "Blender pauses for a moment" if session.stage in PAUSING else esc)


def _draw_question(layout: bpy.types.UILayout, context: bpy.types.Context, question: dict[str, list[str]]) -> None:
    """Draws the shared materials and the two answers. `question`: material -> names of its other users."""
    text = "The subject shares materials with other objects. May these change, too?"
    drawing.paragraph(layout, context, text, "INFO")
    for name, users in list(question.items())[:4]:
        more = f" and {len(users) - 2} more" if len(users) > 2 else ""
        drawing.paragraph(layout, context, f"{name}, also on {', '.join(users[:2])}{more}", "MATERIAL")
    if len(question) > 4:
        layout.label(text=f"and {len(question) - 4} more materials", icon="BLANK1")
    column = layout.column(align=True)
    column.scale_y = 1.2
    for (answer, title, _), icon in zip(SHARED, ("LINKED", "UNLINKED"), strict=True):
        column.operator("vibe.answer", text=title, icon=icon).shared = answer
