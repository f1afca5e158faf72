# SPDX-License-Identifier: GPL-3.0-or-later
"""How the engine understands each word of the prompt that is being typed."""

from __future__ import annotations

import bpy

from ..core.schema_import import messages, schema
from ..engine.process import Engine
from ..scene.scene_context import GEOMETRY, hidden, layer

_Words = tuple[str, tuple[str, ...]]
"""A prompt and its targets: "copper=Cup"."""


class WordReadings:
    """The newest readings of a prompt's words.

    Attributes:
        newest: What the engine last said; of no words before that.
    """

    def __init__(self) -> None:
        self.newest = messages.Readings("")
        self._asked: _Words | None = None  # those whose readings are on their way
        self._read: _Words = ("", ())

    def due(self, scene: bpy.types.Scene) -> bool:
        """Whether the words of a scene have not been read yet, as its artist wants them read."""
        return self._asked is not None or _words(scene) != self._read

    def step(self, engine: Engine, scene: bpy.types.Scene) -> bool:
        """Takes what has arrived, and asks about the words of now; never waits.

        Args:
            engine: Runs already; it may be at work on something else.
            scene: Has the prompt, and the names that it may mean.

        Returns:
            Whether there is something new to show.

        Raises:
            VibeError: The engine is gone.
        """
        arrived = engine.poll_readings()
        if arrived:
            self.newest, self._read, self._asked = arrived, self._asked or self._read, None
        words = _words(scene)
        if self._asked is None and words != self._read:
            prompt, targets = words
            engine.send(messages.AskReadings(schema.schema_hash(), prompt, *names(scene), targets))
            self._asked = words
        return arrived is not None

    def forget(self) -> None:
        """Waits for nothing any more: the engine is another one."""
        self._asked = None


def _words(scene: bpy.types.Scene) -> _Words:
    """The prompt, and what its artist says that words describe."""
    return scene.vibe.prompt, tuple(scene.vibe.told())


def names(scene: bpy.types.Scene) -> tuple[dict[str, list[str]], dict[str, str]]:
    """What a prompt may call by name: objects with their materials, and lights with their types."""
    objects: dict[str, list[str]] = {}
    lights: dict[str, str] = {}
    for obj in layer(scene).objects:
        if hidden(obj):
            continue
        if obj.type in GEOMETRY:
            slots = (slot.material for slot in obj.material_slots)
            objects[obj.name] = [material.name for material in slots if material]
        elif obj.type == "LIGHT":
            lights[obj.name] = obj.data.type
    return objects, lights
