# SPDX-License-Identifier: GPL-3.0-or-later
"""A vibe on its way, while Blender stays free: every call of `advance` does a little and returns."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Generator
from dataclasses import asdict
from pathlib import Path
from typing import cast

import bpy

from . import anchoring, preferences, result, scene_io, snapshot
from .contract import messages, schema
from .engine import Engine
from .model_notes import failure_note
from .subject import Choice

LOOKING = "Looking for the look"
ANCHORING = "Rendering an anchor"


class Session:
    """One vibe.

    It names the scene instead of holding it: an undo meanwhile would leave a dangling reference.

    Attributes:
        scene: The scene's name.
        stage: What is going on, in words.
        progress: The engine's last word on it.
        preview: The newest picture.
    """

    def __init__(self, context: bpy.types.Context, engine: Engine) -> None:
        settings = context.scene.vibe
        self.scene = context.scene.name
        self.prompt = settings.prompt.strip()
        self.stage = "Starting the engine"
        self.progress: messages.Progress | None = None
        self.preview: Path | None = None
        self._subject: list[str] = []
        self._pivot = (0.0, 0.0, 0.0)
        self._options = settings.engine_options(context)
        chosen = preferences.get(context)
        self._key = chosen.vlm_key if chosen else ""
        self._choice = choice(settings)
        self._engine = engine
        self._job = Path(tempfile.mkdtemp(prefix="vibe-", dir=bpy.app.tempdir))
        self._asked = False
        self._stopping = False
        self._found: messages.Result | None = None
        self._steps = self._run()

    @property
    def fraction(self) -> float:
        """How much of the loop is done, 0 to 1."""
        p = self.progress
        return ((p.round - 1) * p.steps + p.step) / (p.rounds * p.steps) if p else 0.0

    @property
    def note(self) -> str:
        """What the artist should know of a vibe that has succeeded; "" if there is nothing."""
        return failure_note(self._found.report) if self._found else ""

    @property
    def agreement(self) -> float | None:
        """Mean CIEDE2000 between the last prediction and the picture of Cycles that came next; None without."""
        return self._found.report.get("anchored", {}).get("predicted") if self._found else None

    @property
    def notes(self) -> list[str]:
        """What went wrong with such pictures, in words for the artist."""
        return self._found.report.get("anchored", {}).get("notes", []) if self._found else []

    def advance(self) -> bool:
        """Does the next bit; False when the vibe is in the scene.

        Raises:
            VibeError: If it fails; the scene is as it was.
        """
        return next(self._steps, None) is not None

    def stop(self) -> None:
        """Asks for the best so far."""
        self.stage, self._stopping = "Stopping", True
        self._engine.send(messages.Stop())

    def cancel(self) -> None:
        """Gives up; the scene is as it was."""
        self._steps.close()
        if self._asked and self._found is None:
            self._engine.abandon()
        self.discard()

    def discard(self) -> None:
        """Deletes the temporary files, the preview among them."""
        shutil.rmtree(self._job, ignore_errors=True)

    def _run(self) -> Generator[str]:
        """Yields before every wait, so that the panel can show what comes."""
        yield self.stage
        self._engine.start()
        while not self._engine.settle():
            yield self.stage
        self._engine.start()  # it may have died of the last one
        self.stage = "Reading the scene"
        yield self.stage
        scene = self._find_scene()
        vibed, start = snapshot.exists(scene), snapshot.mark(scene)
        try:
            subject, pivot = scene_io.export(scene, self._job, self._choice)
            self._subject, self._pivot = [obj.name_full for obj in subject], pivot
            yield from self._wait_for_result()
            scene, found = self._find_scene(), cast(messages.Result, self._found)
            result.apply(scene, self.prompt, found, self._there(scene), pivot)
        except BaseException:  # Esc closes this generator, which raises here
            self._restore(vibed, start)
            raise

    def _wait_for_result(self) -> Generator[str]:
        request = messages.Vibe(
            schema.schema_hash(), str(self._job), self.prompt, asdict(self._options), self._key
        )
        self._engine.send(request)
        self._asked = True
        self.stage = "Warming up the engine"
        while self._found is None:
            yield self.stage
            for message in self._engine.poll():
                if isinstance(message, messages.Anchor):
                    yield from self._anchor(message)
                else:
                    self._hear(message)

    def _anchor(self, request: messages.Anchor) -> Generator[str]:
        """Renders what the engine asks for: Blender is not free for about a second, which the panel says first."""
        if self._stopping:  # the engine does not wait for it any more
            return
        self.stage = ANCHORING
        yield self.stage
        scene = self._find_scene()
        self._engine.send(anchoring.answer(scene, self._job, request, self._there(scene), self._pivot))
        if not self._stopping:
            self.stage = LOOKING

    def _there(self, scene: bpy.types.Scene) -> list[bpy.types.Object]:
        """What is left of the subject."""
        return [scene.objects[name] for name in self._subject if name in scene.objects]

    def _restore(self, vibed: bool, start: int) -> None:
        """Takes back what the export has added, unless an undo or another file has done so already."""
        scene = bpy.data.scenes.get(self.scene)
        if scene is None or not snapshot.exists(scene) or snapshot.mark(scene) < start:
            return
        snapshot.rollback(scene, start)
        if vibed:
            snapshot.take(scene)

    def _hear(self, message: messages.Message) -> None:
        if isinstance(message, messages.Stage):
            self.stage = message.name.capitalize()
        elif isinstance(message, messages.Progress):
            self.progress = message
            self.stage = LOOKING
            if message.preview:
                self.preview = self._job / message.preview
        elif isinstance(message, messages.Result):
            self._found = message
            self.preview = self._job / message.prediction

    def _find_scene(self) -> bpy.types.Scene:
        scene = bpy.data.scenes.get(self.scene)
        if scene is None:
            raise schema.VibeError(f'The scene "{self.scene}" is gone.', "Start again in another scene.")
        return scene


def choice(settings: bpy.types.PropertyGroup) -> Choice:
    """What the panel says the subject is."""
    if settings.subject == "COLLECTION" and settings.collection:
        return Choice(objects=(settings.collection.name,))
    return Choice(selected=settings.subject == "SELECTED")


class Desk:
    """What the add-on holds while Blender runs: a warm engine, and the vibe that runs or ran last.

    Attributes:
        session: The newest vibe; its preview outlives it.
        running: Whether it is on its way.
        failure: Why it failed, until that has been dismissed.
    """

    def __init__(self) -> None:
        self.session: Session | None = None
        self.running = False
        self.failure: schema.VibeError | None = None
        self._engine: Engine | None = None
        self._engine_choice = ""

    def begin(self, context: bpy.types.Context) -> Session:
        """Starts a vibe; the engine is the one of the last, unless the preferences have changed since."""
        self.forget()
        chosen = preferences.get(context)
        place = chosen.engine if chosen else ""
        if self._engine is None or place != self._engine_choice:
            self.close_engine()
            self._engine, self._engine_choice = Engine(place), place
        self.session, self.running = Session(context, self._engine), True
        return self.session

    def end(self, failure: schema.VibeError | None = None) -> None:
        """The vibe is over."""
        self.running, self.failure = False, failure

    def cancel(self) -> None:
        """Gives the vibe up; the scene is as it was."""
        if self.session and self.running:
            self.session.cancel()
        self.end()
        self.forget()

    def forget(self) -> None:
        """Drops what is left of the last vibe."""
        if self.session:
            self.session.discard()
        self.session, self.failure = None, None

    def close_engine(self) -> None:
        """Ends the engine."""
        if self._engine:
            self._engine.stop(patience=0.5)
        self._engine = None

    def close(self) -> None:
        """Gives everything back, when the add-on is switched off or Blender ends."""
        self.cancel()
        self.close_engine()


desk = Desk()
