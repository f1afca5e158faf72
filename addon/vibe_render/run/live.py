# SPDX-License-Identifier: GPL-3.0-or-later
"""The prompt while it is typed: Live shows its first look at each pause; readings say how each word is understood."""

import time
from collections.abc import Generator
from contextlib import suppress
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import bpy

from ..core import rendered
from ..core.schema_import import messages, schema
from ..engine.process import Engine
from ..export.reading import sketch_scene
from ..scene import snapshot
from .session import SceneSession, scene_settings

_PAUSE = 0.3  # seconds without typing, after which a look is requested
_SIZE = 96  # longer side of Live's images, pixels: half of the size with which a search begins
_QUIET = 0.5  # seconds without a change of the scene, after which its words are read anew
_Words = tuple[str, tuple[str, ...]]  # a prompt, and the artist's targets for its words, such as "copper=Cup"


class Live(SceneSession):
    """Shows the first look of the words so far whenever typing pauses, as a preview; the scene keeps nothing else."""

    def __init__(self, context: bpy.types.Context, engine: Engine) -> None:
        super().__init__(context, engine)
        self.stage = ""
        self._words, self._due = "", 0.0  # the words so far; when to request their look, 0 for never
        self._read: tuple[Any, ...] | None = None  # `scene_settings` at the export; None if it is stale or missing
        self._asked = self._at_work = False
        self._steps = self._run()

    @property
    def busy(self) -> bool:
        """True if `advance` has something to do."""
        return bool(self._due or self.stage)

    @property
    def typing(self) -> bool:
        """True if words have been typed that no vibe has been started for yet."""
        return bool(self._words)

    @property
    def job(self) -> Path | None:
        """The job folder with the scene as it is now; None before its export, or if the scene has changed since."""
        scene = self._scene_if_there()
        return self._job if scene and self._read is not None and self._read == scene_settings(scene) else None

    def typed(self, words: str) -> None:
        """Takes the words so far; their look is requested after a pause, and a look of earlier words is given up."""
        self._words, self._due = words.strip(), time.monotonic() + _PAUSE

    def advance(self) -> None:
        """Does the next step; raises VibeError if the scene cannot be read, or the engine has ended."""
        self._at_work = True
        try:
            next(self._steps)
        finally:
            self._at_work = False

    def scene_changed(self) -> None:
        """Marks the export as stale, unless the change comes from Live."""
        if not self._at_work:
            self._read = None

    def show_again(self) -> None:
        """Shows the newest look again, which does not count as a change of the scene."""
        self._at_work, was = True, self._at_work
        super().show_again()
        self._at_work = was

    def hand_over(self, session: SceneSession) -> None:
        """Hands the look over to `session`, a vibe of the same scene, which shows it until there is a better one."""
        self._pause()
        session.look, session.words, session.preview, session.before = self.look, self.words, self.preview, self.before
        session._subject, session._pivot, session._shown = self._subject, self._pivot, self._shown
        session._keyed, self._keyed = self._keyed, False
        self._forget_look()

    def clear(self) -> None:
        """Takes the look out of the scene, until something is typed again."""
        self._pause()
        self._forget_look()
        self._take_look_away()

    def close(self) -> None:
        """Ends Live; the scene is as it was."""
        self.clear()
        self.discard()

    def _pause(self) -> None:
        self._steps.close()
        self._steps, self.stage, self._due = self._run(), "", 0.0
        self._give_up()

    def _forget_look(self) -> None:
        self.look, self.words, self.preview, self._shown, self._words = None, {}, None, None, ""

    def _give_up(self) -> None:
        if self._asked:
            self._asked = False
            self._engine.abandon()

    def _run(self) -> Generator[str]:
        """Waits for words, exports the scene if the export is stale, requests a look, and so on; yields the stage."""
        while True:
            self.stage = ""
            while not self._due or time.monotonic() < self._due:
                yield self.stage
            self._due, self.stage = 0.0, "Looking at the words"
            if not self._words:
                self._forget_look()
                self._take_look_away()
                continue
            yield from self._ready_engine()
            if self.job is None:
                self._read = None  # so that `job` is None while the folder is written
                start = snapshot.mark(self._find_scene())
                try:
                    yield from self._export()
                finally:  # takes back what the export adds, unless an undo or another file has done so already
                    if scene_now := self._scene_if_there():
                        with self._without_look(scene_now):
                            snapshot.rollback(scene_now, start)
                self._read = scene_settings(self._find_scene())
            if not self._due:
                yield from self._glance()

    def _glance(self) -> Generator[str]:
        options = replace(self._find_scene().vibe.engine_options(bpy.context), size=_SIZE)
        self._engine.send(messages.Glance(schema.schema_hash(), str(self._job), self._words, asdict(options)))
        self._asked = True
        while self._asked:
            yield self.stage
            if self._due:
                self._give_up()
                return
            for message in self._engine.poll():
                if isinstance(message, messages.Glanced):
                    self._asked = False
                    if message.values:  # empty if no word is known yet
                        self.receive(message)
                        self.before = self._job / message.before
                        self._show(message)


class WordReadings:
    """The newest readings of the prompt: how the engine understands each of its words in this scene.

    The engine reads the scene from `live`, the job folder that Live has exported. If that is None (missing or stale),
    the engine reads a sketch: an export with bounding boxes in place of meshes, made anew after a change of the scene.
    """

    def __init__(self) -> None:
        self.newest = messages.Readings("")  # the engine's last answer; empty before the first
        self._asked: _Words | None = None  # the words that the engine is reading; None for none
        self._read: _Words = ("", ())  # the words that `newest` is about
        self._folder: Path | None = None  # of the sketch; None where the scene cannot be exported
        self._sketched: tuple[Any, ...] | None = None  # `_settings` of the scene in the sketch; None if that is stale
        self._job = ""  # the job folder against which the newest readings were made
        self._changed = 0.0  # time when the scene last changed

    def due(self, scene: bpy.types.Scene, live: Path | None = None) -> bool:
        """True if the engine has not yet read the prompt, with its targets, for the scene as it is now."""
        words = scene.vibe.prompt, tuple(scene.vibe.target_pairs())
        if self._asked is not None or words != self._read:
            return True
        # The words are read; they are due again if the scene has changed.
        return bool(words[0]) and (self._job != str(live) if live else self._sketched != _settings(scene))

    def scene_changed(self) -> None:
        """Marks the sketch as stale."""
        self._sketched, self._changed = None, time.monotonic()

    def step(self, engine: Engine, scene: bpy.types.Scene, live: Path | None = None) -> bool:
        """Takes readings that have arrived, and requests those that are due; never waits. True if some arrived."""
        arrived = engine.poll_readings()
        if arrived:
            self.newest, self._read, self._asked = arrived, self._asked or self._read, None
        words = scene.vibe.prompt, tuple(scene.vibe.target_pairs())
        is_quiet = time.monotonic() - self._changed > _QUIET
        if self._asked is None and (words != self._read or (is_quiet and self.due(scene, live))):
            prompt, targets = words
            self._job = str(live or self._sketch(scene) or "") if prompt else ""
            objects, lights = {}, {}
            if not self._job:  # a scene that cannot be exported, such as one without a camera
                for obj in sorted(rendered.shown(scene), key=lambda obj: obj.name):
                    if obj.type in rendered.GEOMETRY:
                        objects[obj.name] = [s.material.name for s in obj.material_slots if s.material]
                    elif obj.type == "LIGHT":
                        lights[obj.name] = obj.data.type
            engine.send(messages.AskReadings(schema.schema_hash(), prompt, self._job, objects, lights, targets))
            self._asked = words
        return arrived is not None

    def forget(self) -> None:
        """Stops waiting for the readings that were requested last."""
        self._asked = None

    def _sketch(self, scene: bpy.types.Scene) -> Path | None:
        """The folder of a sketch of the scene as it is now, made if necessary; None if it cannot be exported."""
        settings = _settings(scene)
        if self._sketched != settings:
            self._folder = None
            folder = Path(bpy.app.tempdir) / "vibe-words"
            with suppress(Exception):  # a vibe reports the error; the words are read without a job folder
                sketch_scene(scene, folder, scene.vibe.choice())
                self._folder = folder
            self._sketched = settings  # last: sketching updates the scene, which counts as a change
        return self._folder


def _settings(scene: bpy.types.Scene) -> tuple[Any, ...]:
    """Values of the settings that a sketch of the scene depends on, to find out whether they have changed."""
    selected = tuple(o.name for o in scene.objects if o.select_get()) if scene.vibe.subject == "SELECTED" else ()
    return scene.session_uid, *scene_settings(scene), selected
