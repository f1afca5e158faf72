# SPDX-License-Identifier: GPL-3.0-or-later
"""Live: the first look of the words so far, whenever an artist pauses in typing."""

from __future__ import annotations

import time
from collections.abc import Generator
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import bpy

from ..core.schema_import import messages, schema
from ..engine.process import Engine
from ..scene import snapshot
from .session import SceneSession, scene_settings

_PAUSE = 0.3  # seconds without typing, after which a look is requested
_SIZE = 96
"""Longer side of Live's images, pixels: half of the size with which a search begins."""


class Live(SceneSession):
    """Looks of words that are still being typed.

    The scene is exported once, and again after it has changed. It keeps nothing but the newest look, as a preview.
    """

    def __init__(self, context: bpy.types.Context, engine: Engine) -> None:
        super().__init__(context, engine)
        self.stage = ""
        self._words, self._due = "", 0.0  # time at which a look is requested; 0 if none is due
        self._read: tuple[Any, ...] | None = None  # settings of the exported scene; None if stale
        self._asked = self._at_work = False
        self._steps = self._run()

    @property
    def busy(self) -> bool:
        """True if `advance` has something to do."""
        return bool(self._due or self.stage)

    @property
    def typing(self) -> bool:
        """True if words were typed that no vibe has taken over yet."""
        return bool(self._words)

    @property
    def job(self) -> Path | None:
        """The job folder of the scene as it is now; None before the export, or after the scene has changed."""
        scene = self._scene_if_there()
        return self._job if scene and self._read is not None and self._read == scene_settings(scene) else None

    def typed(self, words: str) -> None:
        """Takes the words so far; the look of earlier words is given up."""
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
        """Hands the look over to a vibe of the same scene, which shows it until it has a better one."""
        self._pause()
        session.take_over(self)
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
        """Gives up the look that is in the making."""
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
        """Endless steps: waits for words, exports the scene if the export is stale, and requests a look."""
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
                finally:  # takes back what the export adds
                    if scene_now := self._scene_if_there():
                        with self._without_look(scene_now):
                            self._restore(start)
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
