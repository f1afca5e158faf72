# SPDX-License-Identifier: GPL-3.0-or-later
"""A vibe while Blender stays free: every call of `advance` does one short step and returns."""

from __future__ import annotations

import shutil
import time
import uuid
from collections.abc import Callable, Generator
from dataclasses import asdict
from pathlib import Path
from typing import TypeVar, cast

import bpy

from ..core import background
from ..core.schema_import import atomic, messages, schema
from ..engine.process import Engine
from ..export import reading
from ..render import anchors, black
from ..scene import shared_materials, snapshot, stored_subject
from . import before_image, preferences, preview, result
from .status import LOOKING, SessionStatus

READING = "Reading the scene"
ANCHORING = "Rendering an anchor"
PAUSING = (READING, ANCHORING)
"""Stages during which Blender is blocked: for long where the scene is large."""
SILENT = 30.0  # seconds without a message from the engine, after which the panel says so
_LOST = 900.0  # seconds without one, after which it is taken to hang

T = TypeVar("T")


class Session(SessionStatus):
    """One vibe.

    It remembers the scene's session uid instead of the scene: an undo meanwhile would leave a dangling reference.

    Args:
        context: Blender's; the vibe is for its scene, with the scene's settings.
        engine: Warm from the last vibe, or not started yet.
        ask: Whether an artist is there to answer questions.

    Attributes:
        scene: The scene's name at the start.
        shared: What to do about materials that other things use too: "ASK", "ALL" or "SINGLE".
        question: Such materials with their other users, by name, while we wait for the artist's answer.
        warnings: What the engine sees only approximately, in words for the artist, after `view_notes`.
        view_notes: What spoils the picture whatever its look, in words for the artist.
    """

    def __init__(self, context: bpy.types.Context, engine: Engine, ask: bool = False) -> None:
        super().__init__(Path(bpy.app.tempdir) / f"vibe-{uuid.uuid4().hex[:8]}")
        settings = context.scene.vibe
        self.scene, self._uid = context.scene.name, context.scene.session_uid
        self.prompt = settings.prompt.strip()
        self.shared = settings.shared if ask or settings.shared != "ASK" else "ALL"
        self.question: dict[str, list[str]] = {}
        self.warnings: list[str] = []
        self.view_notes: list[str] = []
        self._subject: list[str] = []
        self._pivot = (0.0, 0.0, 0.0)
        self._before_path = Path()  # of the before image
        self._vibed = False  # whether an earlier vibe is in the scene
        self._shown: dict[str, list[float]] | None = None  # values of the look that is in the scene
        self._options = settings.engine_options(context)
        saved = preferences.get(context)
        self._key = saved.vlm_key if saved else ""
        self._choice = settings.choice()
        self._engine = engine
        self._steps = self._run()

    def advance(self) -> bool:
        """Does the next step.

        Returns:
            False when the vibe is in the scene.

        Raises:
            VibeError: The vibe failed; the scene is as it was.
        """
        try:
            return next(self._steps, None) is not None
        except OSError as error:
            if not atomic.is_full(error):
                raise
            raise schema.VibeError(
                f"There is no room left on the disk, in {bpy.app.tempdir}.",
                "Make room, or choose another folder for temporary files in Blender's preferences.",
            ) from error

    def stop(self) -> None:
        """Asks for the best look so far."""
        self.stage, self._stopping = "Stopping", True
        self._engine.send(messages.Stop())

    def cancel(self) -> None:
        """Ends a vibe that is given up or has failed; the scene is as it was."""
        self._steps.close()
        if self.asked and self._result is None:
            if self.silence > SILENT:
                self._engine.stop(patience=0.02)
            else:
                self._engine.abandon()
        self.discard()

    def discard(self) -> None:
        """Deletes the temporary files, the preview among them."""
        shutil.rmtree(self._job, ignore_errors=True)

    def _run(self) -> Generator[str]:
        """The vibe's steps. It yields before every wait, so that the panel can show the next stage."""
        yield self.stage
        yield from self._start_engine()
        while not self._engine.settle():
            yield self.stage
        yield from self._start_engine()  # it may have died of the last one
        self.stage = READING
        yield self.stage
        scene = self._find_scene()
        self._vibed, start = snapshot.exists(scene), snapshot.mark(scene)
        try:
            yield from self._export()
            yield from self._ask_about_shared()
            yield from self._wait_for_result()
            # In other modes one undo would not take the vibe back.
            yield from self._object_mode("Found. Go back to Object Mode to see it")
            scene, engine_result = self._find_scene(), cast(messages.Result, self._result)
            preview.hide(scene)
            result.apply(scene, self.prompt, engine_result, self.subject(scene), self._pivot)
            if self._choice.explicit:
                stored_subject.remember(scene, self.subject(scene))
        except BaseException:  # Esc closes this generator, which raises here
            self._restore(start)
            raise

    def _start_engine(self) -> Generator[str]:
        if not self._engine.alive:
            yield from self._in_background(self._engine.start)

    def _in_background(self, act: Callable[[], T]) -> Generator[str, None, T]:
        """Runs a function that needs no Blender in a thread; returns its result."""
        work = background.begin(act)
        yield self.stage
        while not work.done():
            yield self.stage
        return work.result()

    def _object_mode(self, words: str) -> Generator[str]:
        while bpy.context.mode != "OBJECT":
            self.stage = words
            yield self.stage

    def _export(self) -> Generator[str]:
        """Reads the scene; starts again if the artist deletes something of it between two steps."""
        job = None
        while job is None:
            yield from self._object_mode("Go back to Object Mode to go on")  # meshes are empty in Edit Mode
            self.stage = READING
            scene = self._find_scene()
            captured = reading.prepare_and_capture(scene, self._choice)
            self._before_path = before_image.path_of(scene)  # the camera may move before the picture comes
            visible_scene = yield from self._in_background(captured.visible_scene)
            job = reading.export_captured(self._find_scene(), self._job, self._choice, visible_scene)
        self._subject = [obj.name_full for obj in job.analysis.objects]
        self._pivot = job.analysis.pivot
        self.warnings, self.view_notes = job.warnings, job.view_notes

    def _ask_about_shared(self) -> Generator[str]:
        """Asks about materials that other things use too, unless that is settled; may export anew."""
        scene = self._find_scene()
        shared = shared_materials.shared(self.subject(scene))
        if not shared:
            return
        if self.shared == "ASK":
            self.question = {m.name: [o.name for o in users] for m, users in shared.items()}
            self.stage = "Waiting for your answer"
            while self.question:
                yield self.stage
            self.stage = READING
            yield self.stage
            scene = self._find_scene()
        if self.shared == "SINGLE":
            shared_materials.separate(scene, self.subject(scene))
            yield from self._export()

    def answer(self, choice: str) -> None:
        """The artist's answer to the question: "ALL" or "SINGLE"."""
        self.shared, self.question = choice, {}

    def _wait_for_result(self) -> Generator[str]:
        request = messages.Vibe(
            schema.schema_hash(), str(self._job), self.prompt, asdict(self._options), self._key, looks=True
        )
        self._engine.send(request)
        self._last_word_at = time.monotonic()
        self.stage = "Warming up the engine"
        while self._result is None:
            yield self.stage
            self._check_silence()
            scene = self._find_scene()
            for message in self._engine.poll():
                self.receive(message)
                if isinstance(message, messages.Stage) and message.picture:
                    picture = self._job / message.picture
                    if (note := black.note(scene, picture)) and note not in self.view_notes:
                        self.view_notes = [*self.view_notes, note]
                        self.warnings = [note, *self.warnings]
                    self.before = before_image.store(self._before_path, picture, not self._vibed)
                if isinstance(message, messages.LookSoFar):
                    self._show(message)
                if isinstance(message, messages.Anchor):
                    yield from self._anchor(message)

    def _show(self, look: messages.LookSoFar) -> None:
        """Shows a look in the scene, unless its values are shown already."""
        if look.values != self._shown:
            scene, self._shown = self._find_scene(), look.values
            preview.show(scene, look.values, self.subject(scene), self._pivot)

    def show_again(self) -> None:
        """Shows the newest look again, which a file that was saved, or an undo, has left out."""
        self._shown = None
        if self.look and self._result is None and self._scene_if_there():
            self._show(self.look)

    def _anchor(self, request: messages.Anchor) -> Generator[str]:
        """Renders an anchor, which blocks Blender for about a second; the panel says so before."""
        if self._stopping:  # the engine does not wait for it any more
            return
        self.stage = ANCHORING
        yield self.stage
        scene = self._find_scene()
        preview.hide(scene)
        answer = anchors.answer(scene, self._job, request, self.subject(scene), self._pivot)
        self.show_again()
        self._engine.send(answer)
        self._last_word_at = time.monotonic()
        if not self._stopping:
            self.stage = LOOKING

    def _check_silence(self) -> None:
        if self.silence > _LOST:
            self._engine.stop(patience=0.02)
            raise schema.VibeError(
                f"The engine has said nothing for {_LOST / 60:.0f} minutes, and was ended.",
                f"Try again; if it happens again, see {self._engine.log}.",
            )

    def subject(self, scene: bpy.types.Scene) -> list[bpy.types.Object]:
        """The subject's objects that are still in the scene."""
        return [scene.objects[name] for name in self._subject if name in scene.objects]

    def _restore(self, start: int) -> None:
        """Takes back the preview, and what the export has added, unless an undo or another file has done so already."""
        scene = self._scene_if_there()
        if scene is not None:
            preview.hide(scene)
        if scene is None or not snapshot.exists(scene) or snapshot.mark(scene) < start:
            return
        snapshot.rollback(scene, start)
        if self._vibed:
            snapshot.take(scene)

    def _find_scene(self) -> bpy.types.Scene:
        scene = self._scene_if_there()
        if scene is None:
            raise schema.VibeError(f'The scene "{self.scene}" is gone.', "Start again in another scene.")
        return scene

    def _scene_if_there(self) -> bpy.types.Scene | None:
        """The session uid outlives renaming and undo; scenes of other files have other ones."""
        return next((s for s in bpy.data.scenes if s.session_uid == self._uid), None)
