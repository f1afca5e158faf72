# SPDX-License-Identifier: GPL-3.0-or-later
"""State of the engine's environment: found, tested and set up in the background, while panels show the progress."""

from __future__ import annotations

import time
from concurrent.futures import Future
from pathlib import Path

import bpy

from ..core import background, preferences
from ..core.preferences import own_folder
from ..core.schema_import import errors, messages, schema
from ..engine.process import Engine
from ..engine.setup import EngineSetup, TorchBuild, find_python, requirements
from . import drawing

_TICK = 0.25  # seconds between two checks of the background work
_PATIENCE = 60.0  # seconds that a test waits for the engine's "ready"


class EngineState:
    """The engine of this computer; `choice` is its folder from the preferences, or "" for the usual places."""

    def __init__(self) -> None:
        self._timer = self.tick  # one object, by which Blender knows the timer
        self._forget()

    def _forget(self) -> None:
        self.python: Path | None = None  # of the engine; None while it is looked for, or if there is none
        self.problem: schema.VibeError | None = None  # if no engine was found; else None
        self.setup: EngineSetup | None = None  # that is running; None if none is
        self.outcome, self.succeeded = "", True  # of the last test or setup, in words for the preferences
        self._choice: str | None = None  # of the last search
        self.search_work: Future[Path] | None = None  # while the engine is looked for
        self.test_work: Future[str] | None = None  # while the engine is tested

    def search(self, choice: str, again: bool = False) -> None:
        """Sets `python` or `problem` in the background; looks only once for the same choice, unless `again`."""
        if self.search_work or (choice == self._choice and not again):
            return
        self._choice, self.python, self.problem = choice, None, None
        self.search_work = background.begin(lambda: find_python(choice))
        drawing.begin(self._timer, _TICK, persistent=True)

    def test(self, choice: str) -> None:
        """Starts an engine in the background to see whether it answers; sets `outcome` and `succeeded`."""
        if not self.test_work:
            self.test_work = background.begin(lambda: version(choice))
            drawing.begin(self._timer, _TICK, persistent=True)

    def set_up(self, build: TorchBuild) -> None:
        """Makes the engine's environment, with this build of torch, in the background; raises as `requirements`."""
        if not self.setup:
            self.setup = EngineSetup(setup_folder(), requirements(), build)
            drawing.begin(self._timer, _TICK, persistent=True)

    def close(self) -> None:
        """Cancels a setup and forgets everything."""
        if self.setup:
            self.setup.cancel()
        self._forget()

    def tick(self) -> float | None:
        """Timer function: takes results of background work; returns the seconds to the next call; None without work."""
        if self.search_work and self.search_work.done():
            self.python, self.problem = _answer_of(self.search_work)
            self.search_work = None
        if self.test_work and self.test_work.done():
            answer, problem = _answer_of(self.test_work)
            self.test_work = None
            self.outcome, self.succeeded = str(problem or f"Engine {answer} answers"), problem is None
        if self.setup and self.setup.work.done():
            setup, self.setup = self.setup, None
            try:
                setup.work.result()
                self.outcome, self.succeeded = "The engine is set up", True
                if chosen := preferences.get(bpy.context):
                    chosen.engine = str(setup.folder)
                    self.search(chosen.engine, again=True)
            except schema.VibeError as error:
                self.outcome, self.succeeded = str(error), False
        drawing.redraw()
        return _TICK if self.search_work or self.test_work or self.setup else None


def setup_folder() -> Path:
    """The folder of the environment that Set Up Engine makes."""
    return own_folder("engine")


def version(choice: str) -> str:
    """Starts an engine and returns its version, or raises a VibeError; `choice` as for `EngineState`."""
    engine = Engine(choice)
    engine.start()
    try:
        end = time.monotonic() + _PATIENCE
        while time.monotonic() < end:
            for message in engine.poll():
                if isinstance(message, messages.Ready):
                    return message.version
            time.sleep(0.05)
    finally:
        engine.stop()
    raise schema.VibeError("The engine does not answer.", f"See {engine.log}.")


def _answer_of(future: Future) -> tuple:
    try:
        return future.result(), None
    except Exception as error:  # a panel shows errors of any kind
        return None, errors.to_show(error, "looking for the engine")


engine_state = EngineState()
