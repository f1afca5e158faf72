# SPDX-License-Identifier: GPL-3.0-or-later
"""The driver of a vibe: generators that talk to the engine; whenever they wait, they yield the stage, in words.

The panel advances them by a timer, so that Blender stays usable between two steps; without a window, a loop does so.
"""

import math
import time
from collections.abc import Callable, Generator, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

from bpy.types import Scene

from ..core import background
from ..core.schema_import import messages, schema
from ..engine.process import Engine
from ..export import reading
from ..export.analysis import SceneAnalysis
from ..render import final_render
from ..scene import bindings, keyframes, own_keys
from ..scene.steps import Steps
from ..scene.subject import SubjectChoice
from .notes import CheckedFrame, words_of

LOOKING = "Optimizing"
ANCHORING = "Comparing with Cycles"
_SIZE, _SAMPLES = 256, 16  # longer side in pixels, and samples, of the images of checked frames

T = TypeVar("T")
_Answer = TypeVar("_Answer", messages.Result, messages.Finished, messages.Checked)


class Driver:
    """One vibe: sends requests to the engine, takes its answers, keeps what it has reported. `job`: the job folder."""

    patience = math.inf  # seconds without a message after which the engine is ended

    def __init__(self, engine: Engine, job: Path) -> None:
        self._engine, self._job = engine, job
        self.stage = "Starting the engine"  # the present stage, in words
        self.progress: messages.Progress | None = None  # the newest progress message
        self.before: Path | None = None  # the engine's image of the scene before the vibe
        self.look: messages.LookSoFar | None = None  # the search's newest look, which the scene shows until the result
        self.words: dict[str, bool] = {}  # look word -> True if it is visible on the image of `look`
        self.preview: Path | None = None  # the engine's newest image of the search's look
        # the variants, the best first, each with its image; empty unless several were requested
        self.variants: list[tuple[messages.Variant, Path]] = []
        self.sequence: tuple[CheckedFrame, ...] = ()  # the frames at which the result was checked
        self._result: messages.Result | None = None
        self._last_word_at = 0.0  # time of the engine's last message; 0 before the first request
        self._stopping = False

    @property
    def fraction(self) -> float:
        """The part of the search that is done, 0 to 1."""
        p = self.progress
        return ((p.round - 1) * p.steps + p.step) / (p.rounds * p.steps) if p else 0.0

    @property
    def asked(self) -> bool:
        """True if a request has been sent to the engine."""
        return self._last_word_at > 0.0

    @property
    def silence(self) -> float:
        """Seconds since the engine's last message; 0.0 before the first request and after the result."""
        return time.monotonic() - self._last_word_at if self.asked and not self._result else 0.0

    @property
    def report(self) -> Mapping[str, Any]:
        """The fields of report.json that the engine knows; empty before the result."""
        return self._result.report if self._result else {}

    @property
    def prediction_error(self) -> float | None:
        """Mean CIEDE2000 between the last anchor (a small Cycles render) and its prediction; None without anchors."""
        return self.report.get("anchored", {}).get("predicted")

    def receive(self, message: messages.Message) -> None:
        """Updates this object's attributes from a message of the engine."""
        self._last_word_at = time.monotonic()
        if isinstance(message, messages.Stage):
            self.stage = message.name.capitalize()
            if message.picture:
                self.before = self._job / message.picture
        elif isinstance(message, messages.LookSoFar):
            self.look, self.words = message, message.words or self.words
            if message.picture:
                self.preview = self._job / message.picture
        elif isinstance(message, messages.Progress):
            self.progress = message
            self.stage = LOOKING
            if message.preview:
                self.preview = self._job / message.preview
        elif isinstance(message, messages.Result):
            self._result = message
            self.preview = self._job / message.prediction
            self.variants = [(v, self._job / v.picture) for v in message.variants]

    def stop(self) -> None:
        """Asks the engine to end the search with the best look so far; any thread may call this."""
        self.stage, self._stopping = "Stopping", True
        if self.asked:  # else `_ask` sends it after the first request
            self._engine.send(messages.Stop())

    def _ready_engine(self) -> Generator[str]:
        """Starts the engine if it does not run, and waits until it has ended an abandoned vibe."""
        for _ in range(2):  # if that vibe does not end, the engine is ended, and starts again
            if not self._engine.alive:
                yield from self._in_background(self._engine.start)
            while not self._engine.settle():
                yield self.stage

    def _in_background(self, act: Callable[[], T]) -> Generator[str, None, T]:
        """Runs `act` in a thread, yields until it ends, and returns its result; `act` must not touch Blender's data."""
        work = background.begin(act)
        yield self.stage
        while not work.done():
            yield self.stage
        return work.result()

    def _ask(self, request: messages.Vibe | messages.Finish | messages.Check) -> None:
        self._engine.send(request)
        self._last_word_at = time.monotonic()
        if self._stopping:
            self._engine.send(messages.Stop())

    def _answer(self, kind: type[_Answer]) -> Generator[str, None, _Answer]:
        """Takes messages, and renders requested anchors, until a message of class `kind` arrives; returns that message.

        Raises VibeError if the engine fails, is silent for longer than `patience`, or has ended.
        """
        answer = None
        while answer is None:
            yield self.stage
            self._check()
            for message in self._engine.poll():
                self.receive(message)
                # A search that is stopping waits for no anchor.
                if isinstance(message, messages.Anchor) and not self._stopping:
                    # The render blocks Blender for about a second, so the stage is shown first.
                    self.stage = ANCHORING
                    yield self.stage
                    self._engine.send(self._anchor(message))
                    self._last_word_at = time.monotonic()
                    if not self._stopping:
                        self.stage = LOOKING
                elif isinstance(message, kind):
                    answer = message
                else:
                    self._show_message(message)
        return answer

    def _check(self) -> None:
        if self.silence > self.patience:
            self._engine.stop(patience=0.02)
            problem = f"The engine has said nothing for {self.patience / 60:.0f} minutes, and was ended."
            raise schema.VibeError(problem, f"Try again; if it happens again, see {self._engine.log}.")

    def _anchor(self, request: messages.Anchor) -> messages.Anchored:
        raise NotImplementedError

    def _show_message(self, message: messages.Message) -> None:
        """Hook for subclasses: shows a message that comes before the answer."""

    def _check_frames(
        self,
        scene: Scene,
        every: int,
        verdicts: Sequence[Mapping[str, str]],
        choice: SubjectChoice,
        seed: int,
        first: SceneAnalysis | None = None,
    ) -> Generator[str]:
        """Renders each `every`-th frame with and without the look; fills `sequence` with the engine's measurements.

        `verdicts` and `first` are the verdicts and the scene's analysis at the frame where the look was found. `choice`
        is that of the subject. The scene stays as it is.
        """
        self.sequence, start, shown = (), scene.frame_current, keyframes.are_shown(scene)
        seen = words_of(verdicts, "visible")
        try:
            for frame in range(scene.frame_start, scene.frame_end + 1, every):
                self._show_frame(frame)
                yield self.stage
                scene.frame_set(frame)
                folder = self._job / f"frame-{frame}"
                before, after = folder / "before.png", folder / "after.png"
                try:
                    reading.export_scene(scene, folder, choice, first)
                except schema.VibeError as error:  # the subject is hidden
                    self.sequence += (CheckedFrame(frame, note=error.message),)
                    continue
                steps = Steps.of(scene)
                with own_keys.as_before(scene), bindings.trial(scene, steps.base, (), steps.pivot):
                    final_render.render_picture(scene, before, _SIZE, _SAMPLES, seed)
                final_render.render_picture(scene, after, _SIZE, _SAMPLES, seed)
                if shown:
                    keyframes.bring_back(scene)
                self._ask(messages.Check(str(folder), str(before), str(after)))
                checked = yield from self._answer(messages.Checked)
                lost = [word for word in words_of(checked.verdicts, "missed") if word in seen]
                self.sequence += (CheckedFrame(frame, lost, checked.verdicts, picture=after),)
        finally:
            if shown:
                keyframes.bring_back(scene)
            scene.frame_set(start)

    def _show_frame(self, frame: int) -> None:
        self.stage = f"Checking frame {frame}"
