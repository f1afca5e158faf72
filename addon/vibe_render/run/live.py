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

_PAUSE = 0.3  # seconds without a key, after which the words are looked at
_SIZE = 96
"""Longer side of its pictures, pixels: half of what the search begins with."""


class Live(SceneSession):
    """Looks of words that are still being typed.

    The scene is read once, and again after it has changed. Nothing but the newest look stays in it, as a preview.
    """

    def __init__(self, context: bpy.types.Context, engine: Engine) -> None:
        super().__init__(context, engine)
        self.stage = ""
        self._words, self._due = "", 0.0  # time at which the words are looked at; 0 for not
        self._read: tuple[Any, ...] | None = None  # settings of the scene that was read; None if stale
        self._asked = self._at_work = False
        self._steps = self._run()

    @property
    def busy(self) -> bool:
        """True if there is something to do."""
        return bool(self._due or self.stage)

    @property
    def typing(self) -> bool:
        """True if words were typed that no vibe has taken over yet."""
        return bool(self._words)

    @property
    def job(self) -> Path | None:
        """The job folder of the scene as it is now; None before it is read, or after it has changed."""
        scene = self._scene_if_there()
        return self._job if scene and self._read is not None and self._read == scene_settings(scene) else None

    def typed(self, words: str) -> None:
        """Takes the words so far; work on others is given up."""
        self._words, self._due = words.strip(), time.monotonic() + _PAUSE

    def advance(self) -> None:
        """Does the next step; a VibeError says that the scene cannot be read, or the engine is gone."""
        self._at_work = True
        try:
            next(self._steps)
        finally:
            self._at_work = False

    def scene_changed(self) -> None:
        """Has the scene read anew, unless `advance` changes it."""
        if not self._at_work:
            self._read = None

    def show_again(self) -> None:
        """Shows the newest look again, which is no change of the artist's."""
        self._at_work, was = True, self._at_work
        super().show_again()
        self._at_work = was

    def hand_over(self, session: SceneSession) -> None:
        """Leaves the look to a vibe of the same scene, which starts where it is."""
        self._pause()
        session.take_over(self)
        self._forget_look()

    def clear(self) -> None:
        """Takes the look away, until something is typed again."""
        self._pause()
        self._forget_look()
        self._take_look_away()

    def close(self) -> None:
        """Ends it; the scene is as it was."""
        self.clear()
        self.discard()

    def _pause(self) -> None:
        """Gives up the present work."""
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
        """Look after look, without end."""
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
                self._read = None  # nobody reads a job that is being written
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
                    if message.values:  # nothing where no word is known yet
                        self.receive(message)
                        self.before = self._job / message.before
                        self._show(message)
