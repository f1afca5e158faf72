# SPDX-License-Identifier: GPL-3.0-or-later
"""Readings: the engine's understanding of each word of the prompt that is being typed."""

from __future__ import annotations

import time
from contextlib import suppress
from pathlib import Path
from typing import Any

import bpy

from ..core import rendered
from ..core.schema_import import messages, schema
from ..engine.process import Engine
from ..export.reading import sketch_scene
from .session import scene_settings

_QUIET = 0.5  # seconds without a change of the scene, after which its words are read anew
_Words = tuple[str, tuple[str, ...]]
"""A prompt, and the artist's targets for its words, such as "copper=Cup"."""


class WordReadings:
    """The newest readings of a prompt's words.

    The engine reads words against the job folder that Live has exported, or else against a sketch of the scene, which is
    made anew after a change. For all methods, `live` is Live's job folder; None if it is missing or stale.
    """

    def __init__(self) -> None:
        self.newest = messages.Readings("")  # the engine's last answer; empty before the first
        self._asked: _Words | None = None  # the words that the engine is reading; None for none
        self._read: _Words = ("", ())
        self._folder: Path | None = None  # of the sketch; None where the scene cannot be exported
        self._sketched: tuple[Any, ...] | None = None  # settings of the scene; None if the sketch is stale
        self._job = ""  # the job folder against which the newest readings were made
        self._changed = 0.0  # time when the scene last changed

    def due(self, scene: bpy.types.Scene, live: Path | None = None) -> bool:
        """True if the prompt, with its targets, has not been read yet against the scene as it is now."""
        words = _words(scene)
        if self._asked is not None or words != self._read or not words[0]:
            return self._asked is not None or words != self._read
        # The words are read; True if the scene has changed since.
        return self._job != str(live) if live else self._sketched != _settings(scene)

    def scene_changed(self) -> None:
        """Marks the sketch as stale."""
        self._sketched, self._changed = None, time.monotonic()

    def step(self, engine: Engine, scene: bpy.types.Scene, live: Path | None = None) -> bool:
        """Takes readings that have arrived, and requests those that are due; never waits. True if some have arrived."""
        arrived = engine.poll_readings()
        if arrived:
            self.newest, self._read, self._asked = arrived, self._asked or self._read, None
        words = _words(scene)
        is_quiet = time.monotonic() - self._changed > _QUIET
        if self._asked is None and (words != self._read or (is_quiet and self.due(scene, live))):
            prompt, targets = words
            self._job = str(live or self._sketch(scene) or "") if prompt else ""
            names = ({}, {}) if self._job else _names(scene)
            engine.send(messages.AskReadings(schema.schema_hash(), prompt, self._job, *names, targets))
            self._asked = words
        return arrived is not None

    def forget(self) -> None:
        """Stops waiting for the readings that were requested last."""
        self._asked = None

    def _sketch(self, scene: bpy.types.Scene) -> Path | None:
        """The folder of the sketch of the scene as it is now; None where it cannot be exported."""
        settings = _settings(scene)
        if self._sketched != settings:
            self._folder = None
            folder = Path(bpy.app.tempdir) / "vibe-words"
            with suppress(Exception):  # a vibe reports the error; the words are read without a job folder
                sketch_scene(scene, folder, scene.vibe.choice())
                self._folder = folder
            self._sketched = settings  # last: sketching updates the scene, which counts as a change
        return self._folder


def _words(scene: bpy.types.Scene) -> _Words:
    return scene.vibe.prompt, tuple(scene.vibe.target_pairs())


def _names(scene: bpy.types.Scene) -> tuple[dict[str, list[str]], dict[str, str]]:
    """Names in a scene that cannot be exported, such as one without a camera.

    Returns:
        Object to its materials, and light to its type.
    """
    shown = sorted(rendered.shown(scene), key=lambda obj: obj.name)
    things = [o for o in shown if o.type in rendered.GEOMETRY]
    objects = {o.name: [s.material.name for s in o.material_slots if s.material] for o in things}
    return objects, {o.name: o.data.type for o in shown if o.type == "LIGHT"}


def _settings(scene: bpy.types.Scene) -> tuple[Any, ...]:
    """The scene's own settings that a sketch of it depends on."""
    chosen = scene.vibe.subject == "SELECTED"
    selected = tuple(o.name for o in scene.objects if o.select_get()) if chosen else ()
    return scene.session_uid, *scene_settings(scene), selected
