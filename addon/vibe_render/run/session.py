# SPDX-License-Identifier: GPL-3.0-or-later
"""A vibe that runs while Blender stays usable: each call of `Session.advance` does one short step."""

import shutil
import time
import uuid
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import bpy
from bpy.types import Context, Object, Scene

from ..core import compat, preferences
from ..core.schema_import import atomic, messages, schema, targets
from ..engine.process import Engine
from ..export import analysis, notes, reading
from ..render import anchors, final_render, reference
from ..scene import bindings, keyframes, own_keys, snapshot
from ..scene.nodes import grade
from ..scene.prepare import EVERYTHING, described_materials, separate_materials, shared_materials
from ..scene.steps import Change, Steps
from ..scene.subject import SubjectChoice, remember_subject
from . import preview, result
from .driver import ANCHORING, Driver

READING = "Reading the scene"
PAUSING = (READING, ANCHORING)  # stages that block Blender; the larger the scene, the longer
_READ_WITHIN = 20.0  # seconds to read a prompt; one that takes longer counts as describing everything
SILENT = 30.0  # seconds without a message from the engine, after which the panel says so


def scene_settings(scene: Scene) -> tuple[Any, ...]:
    """Values of the settings that a scene's export depends on, to find out whether they have changed."""
    # Blender reports their changes in the same way as a character that is typed into the prompt.
    render, view, vibe = scene.render, scene.view_settings, scene.vibe
    picture = render.resolution_x, render.resolution_y, render.resolution_percentage
    subject = vibe.subject, vibe.collection and vibe.collection.name
    camera = scene.camera and scene.camera.name
    return camera, scene.frame_current, view.view_transform, view.look, *picture, *subject


class SceneSession(Driver):
    """Work on one scene, in steps between which Blender is usable: the base of `Session` and `Live`."""

    def __init__(self, context: Context, engine: Engine) -> None:
        super().__init__(engine, Path(bpy.app.tempdir) / f"vibe-{uuid.uuid4().hex[:8]}")
        settings = context.scene.vibe
        self.scene = context.scene.name  # the name at the start
        self._uid = context.scene.session_uid  # not the scene: after an undo a reference would be dangling
        # lines for the artist on what the engine renders only approximately; `view_notes` are among them
        self.warnings: list[str] = []
        self.view_notes: list[str] = []  # lines for the artist on what spoils the image with any look
        self._filling = ""  # see `SceneJob`
        self._subject: list[str] = []  # names of the subject's objects
        self._pivot = (0.0, 0.0, 0.0)  # the center of the subject's bounding box
        self._before_path = Path()  # of the before image
        self._keyed = False  # True if this session has muted keyframes of looks
        self._shown: dict[str, list[float]] | None = None  # values of the look in the scene; None if none
        self._options = settings.engine_options(context)
        self._choice = settings.choice()

    def discard(self) -> None:
        """Deletes the job folder, with the images in it."""
        shutil.rmtree(self._job, ignore_errors=True)

    def subject(self, scene: Scene) -> list[Object]:
        """The subject's objects that are still in the scene."""
        return [scene.objects[name] for name in self._subject if name in scene.objects]

    def show_again(self) -> None:
        """Shows the newest look again, after a save or an undo has taken it out of the scene."""
        self._shown = None
        if self.look and self._result is None and self._scene_if_there():
            self._show(self.look)

    def _show(self, look: messages.LookSoFar) -> None:
        if look.values != self._shown:
            scene, self._shown = self._find_scene(), look.values
            preview.show(scene, look.values, self.subject(scene), self._pivot)

    @contextmanager
    def _without_look(self, scene: Scene) -> Iterator[None]:
        """Hides the look inside the block, which must not yield to Blender: then no redraw shows the change."""
        preview.hide(scene)
        yield
        self.show_again()

    def _object_mode(self, stage: str) -> Generator[str]:
        while bpy.context.mode != "OBJECT":
            self.stage = stage
            yield self.stage

    def _export(self) -> Generator[str]:
        """Exports the scene to the job folder; starts again if the artist deletes something between two steps."""
        job = None
        while job is None:
            yield from self._object_mode("Switch to Object Mode to go on")  # meshes are empty in Edit Mode
            self.stage = READING
            scene = self._find_scene()
            with self._without_look(scene):
                self._keyed |= keyframes.are_shown(scene)
                reading.prepare_and_snapshot(scene, self._choice)
                captured = analysis.capture(scene)
                # Now, because the camera may move before the image arrives.
                self._before_path = preview.before_path(scene)
            visible_scene = yield from self._in_background(captured.visible_scene)
            scene = self._find_scene()
            with self._without_look(scene):
                job = reading.export_captured(scene, self._job, self._choice, visible_scene)
        self._options = replace(self._options, like=reference.picture_path(self._find_scene(), self._job))
        self._subject = [obj.name_full for obj in job.analysis.objects]
        self._pivot = job.analysis.pivot
        self.warnings, self.view_notes, self._filling = job.warnings, job.view_notes, job.filling

    def _take_look_away(self) -> None:
        self._shown = None
        if scene := self._scene_if_there():
            preview.hide(scene)
            if self._keyed:
                keyframes.bring_back(scene)
        self._keyed = False

    def _find_scene(self) -> Scene:
        scene = self._scene_if_there()
        if scene is None:
            raise schema.VibeError(f'The scene "{self.scene}" is gone.', "Start again in another scene.")
        return scene

    def _scene_if_there(self) -> Scene | None:
        """The session's scene, found by its session uid (unique, also after renaming and undo); None if it is gone."""
        return next((s for s in bpy.data.scenes if s.session_uid == self._uid), None)


class Session(SceneSession):
    """One vibe of the open scene; afterwards it can check the result at other frames.

    `ask`: False if nobody can be asked about shared materials; then all their users change. `change`: the effect of a
    further sentence on the steps; None for the prompt in the panel.
    """

    patience = 900.0

    def __init__(self, context: Context, engine: Engine, ask: bool = False, change: Change | None = None) -> None:
        super().__init__(context, engine)
        settings = context.scene.vibe
        prompt, like = settings.prompt.strip(), reference.picture_name(settings)
        self._change = change or Change(Steps(), sentence=prompt, title=prompt or like, first=True)
        self.prompt = self._change.sentence  # the words; "" for none
        self.like = like if self._change.first else ""  # name of the reference image; "" for none
        # what to do about the subject's materials that other objects use too: "ASK", "ALL" or "SINGLE"
        self.shared = settings.shared if ask or settings.shared != "ASK" else "ALL"
        # while the artist is asked: name of a shared material -> names of its other users; else empty
        self.question: dict[str, list[str]] = {}
        self.checking = False  # True while frames are checked
        self._vibed = False  # True if the scene has an earlier result
        saved = preferences.get(context)
        self._key = saved.vlm_key if saved else ""
        self._steps = self._run()

    @property
    def wanted(self) -> str:
        """The request, as panels show it: the words in quotation marks, and the reference image's name."""
        return reference.request_title(self.prompt, self.like)

    def advance(self) -> bool:
        """Does the next step; returns True, or False if the vibe is done. After a VibeError the scene is as it was."""
        try:
            return next(self._steps, None) is not None
        except OSError as error:
            if not atomic.is_full(error):
                raise
            remedy = "Make room, or choose another folder for temporary files in Blender's preferences."
            raise schema.VibeError(f"There is no room left on the disk, in {bpy.app.tempdir}.", remedy) from error

    @property
    def can_stop(self) -> bool:
        """True if the search has begun and is not stopping: then `stop` gives its best look so far."""
        return self.progress is not None and not (self._stopping or self.checking)

    def check(self, scene: Scene, every: int) -> None:
        """Makes `advance` check each `every`-th frame of the scene's range; `sequence` gets the results."""
        choice, verdicts = SubjectChoice(tuple(self._subject)), self.report.get("verdicts", ())
        self.checking = True
        self._steps = self._check_frames(scene, every, verdicts, choice, self._options.seed)

    def cancel(self) -> None:
        """Ends a vibe, and restores the scene as it was; or ends a check of frames, which leaves the result there."""
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
            self._ask(messages.Vibe(schema.schema_hash(), str(self._job), self.prompt, options, self._key, looks=True))
            self.stage = "Warming up the engine"
            engine_result = yield from self._answer(messages.Result)
            # In other modes one undo would not take the vibe back.
            yield from self._object_mode("Done. Switch to Object Mode to apply it")
            scene = self._find_scene()
            self._take_look_away()
            subject = self.subject(scene)
            result.apply(scene, self.prompt, engine_result, subject, self._pivot, change=self._change)
            scene.vibe.vibed_like = self.like or scene.vibe.vibed_like
            remember_subject(scene, subject, self._choice)
        except BaseException:  # Esc closes this generator, which raises here
            self._take_look_away()
            if scene_now := self._scene_if_there():  # an undo or another file may have taken back the export already
                snapshot.rollback(scene_now, start)
            raise

    def _ask_about_shared(self) -> Generator[str]:
        """Asks about shared materials if `shared` is "ASK"; exports again if the subject gets copies of its own."""
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
        """Names of objects and materials that the prompt describes; `EVERYTHING` for an image or after a long wait."""
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
        """Takes the artist's answer to the question about shared materials: "ALL" or "SINGLE"."""
        self.shared, self.question = choice, {}

    def _check(self) -> None:
        self._find_scene()  # raises if the artist has deleted it
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
