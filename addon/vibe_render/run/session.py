# SPDX-License-Identifier: GPL-3.0-or-later
"""A vibe while Blender stays free: every call of `advance` does one short step and returns."""

from __future__ import annotations

import time
from collections.abc import Generator
from dataclasses import asdict, replace

import bpy

from ..core import compat, preferences
from ..core.schema_import import atomic, messages, schema, targets
from ..engine.process import Engine
from ..export import notes
from ..render import anchors, final_render, reference
from ..scene import bindings, keyframes, own_keys, snapshot
from ..scene.nodes import grade
from ..scene.prepare import EVERYTHING, described_materials, separate_materials, shared_materials
from ..scene.steps import Change, Steps
from ..scene.subject import SubjectChoice, remember_subject
from . import preview, result
from .driver import ANCHORING
from .notes import words_of
from .scene_session import READING, SceneSession

PAUSING = (READING, ANCHORING)
"""Stages during which Blender is blocked: for long where the scene is large."""
_READ_WITHIN = 20.0  # seconds; a prompt that takes longer to read may describe everything
SILENT = 30.0  # seconds without a message from the engine, after which the panel says so


class Session(SceneSession):
    """One vibe of the open scene, and then a check of its frames.

    Attributes:
        prompt: The words; "" for none.
        like: Name of the picture; "" for none.
        shared: What to do about materials that other things use too: "ASK", "ALL" or "SINGLE".
        question: Such materials with their other users, by name, while it waits for the artist's answer.
        checking: Whether frames are checked.
    """

    patience = 900.0

    def __init__(
        self, context: bpy.types.Context, engine: Engine, ask: bool = False, change: Change | None = None
    ) -> None:
        super().__init__(context, engine)
        settings = context.scene.vibe
        self.prompt, self.like = settings.prompt.strip(), reference.picture_name(settings)
        self._change = change or Change(
            Steps(), sentence=self.prompt, title=self.prompt or self.like, first=True
        )
        self.prompt, self.like = self._change.sentence, self.like if self._change.first else ""
        self.shared = settings.shared if ask or settings.shared != "ASK" else "ALL"
        self.question: dict[str, list[str]] = {}
        self.checking = False
        self._vibed = False  # whether an earlier vibe is in the scene
        saved = preferences.get(context)
        self._key = saved.vlm_key if saved else ""
        self._steps = self._run()

    @property
    def wanted(self) -> str:
        """The target look as panels show it."""
        return reference.request_title(self.prompt, self.like)

    def advance(self) -> bool:
        """Does the next step; False when the vibe is in the scene. A VibeError leaves the scene as it was."""
        try:
            return next(self._steps, None) is not None
        except OSError as error:
            if not atomic.is_full(error):
                raise
            raise schema.VibeError(
                f"There is no room left on the disk, in {bpy.app.tempdir}.",
                "Make room, or choose another folder for temporary files in Blender's preferences.",
            ) from error

    @property
    def can_stop(self) -> bool:
        """True if there is a best look so far, which `stop` would take."""
        return super().can_stop and not self.checking

    def check(self, scene: bpy.types.Scene, every: int) -> None:
        """Lets the next steps check frames of the scene, from its first to its last; `sequence` has them then."""
        frames = range(scene.frame_start, scene.frame_end + 1, every)
        seen = words_of(self.report.get("verdicts", ()), "visible")
        choice = SubjectChoice(tuple(self._subject))
        self.checking = True
        self._steps = self._check_frames(scene, frames, seen, choice, self._options.seed)

    def cancel(self) -> None:
        """Ends a vibe, or a check of its frames, that is given up or has failed; the scene is as it was."""
        self._steps.close()
        if self.checking:
            self.checking, self.sequence = False, ()
            self._engine.abandon()
            return
        self._take_look_away()
        if self.asked and self._result is None:
            if self.silence > SILENT:
                self._engine.stop(patience=0.02)
            else:
                self._engine.abandon()
        self.discard()

    def _run(self) -> Generator[str]:
        """The vibe's steps. It yields before every wait, so that the panel can show the next stage."""
        yield self.stage
        yield from self._ready_engine()
        self.stage = READING
        yield self.stage
        scene = self._find_scene()
        self._vibed, start = snapshot.exists(scene), snapshot.mark(scene)
        self._keyed |= keyframes.are_shown(scene)
        try:
            if scene.vibe.offset_keys:
                own_keys.hold(scene)
            if self._change.values:
                bindings.write(scene, self._change.values, (), self._change.steps.pivot)
            yield from self._export()
            yield from self._ask_about_shared()
            if not self._change.first:
                self._options = replace(self._options, goes_on=True, like="", target=(), variants=1)
            options = asdict(self._options)
            self._ask(
                messages.Vibe(
                    schema.schema_hash(), str(self._job), self.prompt, options, self._key, looks=True
                )
            )
            self.stage = "Warming up the engine"
            engine_result = yield from self._answer(messages.Result)
            # In other modes one undo would not take the vibe back.
            yield from self._object_mode("Done. Switch to Object Mode to apply it")
            scene = self._find_scene()
            self._take_look_away()
            subject, change = self.subject(scene), self._change
            result.apply(scene, self.prompt, engine_result, subject, self._pivot, change=change)
            scene.vibe.vibed_like = self.like or scene.vibe.vibed_like
            remember_subject(scene, self.subject(scene), self._choice)
        except BaseException:  # Esc closes this generator, which raises here
            self._take_look_away()
            self._restore(start)
            raise

    def _ask_about_shared(self) -> Generator[str]:
        """Asks about materials that other things use too, unless that is settled; may export anew."""
        scene = self._find_scene()
        shared = shared_materials(self.subject(scene))
        if not shared or not scene.vibe.change_material:
            return
        if self.shared == "ASK":
            shared = described_materials(shared, (yield from self._described()))
            self.question = {m.name: [o.name for o in users] for m, users in shared.items()}
            self.stage = "Waiting for your answer"
            while self.question:
                yield self.stage
            self.stage = READING
            yield self.stage
            scene = self._find_scene()
        if self.shared == "SINGLE":
            with self._without_look(scene):
                separate_materials(scene, self.subject(scene))
            yield from self._export()

    def _described(self) -> Generator[str, None, frozenset[str]]:
        """Names of objects and materials that the words describe, as the engine reads them; of a picture everything."""
        if self.like:
            return EVERYTHING
        job, target = str(self._job), self._options.target
        self._engine.send(messages.AskReadings(schema.schema_hash(), self.prompt, job, target=target))
        until = time.monotonic() + _READ_WITHIN
        while (readings := self._engine.poll_readings()) is None or readings.prompt != self.prompt:
            yield self.stage
            if time.monotonic() > until:
                return EVERYTHING
        described = [word.candidates[0] for word in readings.words if word.candidates]
        names = {name for target in described for name in targets.target_names(target)}
        return frozenset(names - (targets.GENERAL.keys() - EVERYTHING))

    def answer(self, choice: str) -> None:
        """Takes the artist's answer to the question: "ALL" or "SINGLE"."""
        self.shared, self.question = choice, {}

    def _check(self) -> None:
        self._find_scene()
        super()._check()

    def _show_message(self, message: messages.Message) -> None:
        if isinstance(message, messages.LookSoFar):
            self._show(message)
        elif isinstance(message, messages.Stage) and message.picture:
            picture = self._job / message.picture
            scene = self._find_scene()
            if grade.cut_off(compat.compositor(scene)) or final_render.is_black(picture):
                notes.check_shows(scene, self._filling, message.lit)
            self.before = preview.store_before(self._before_path, picture, not self._vibed)

    def _anchor(self, request: messages.Anchor) -> messages.Anchored:
        scene = self._find_scene()
        with self._without_look(scene):
            return anchors.answer_anchor(scene, self._job, request, self.subject(scene), self._pivot)
