# SPDX-License-Identifier: GPL-3.0-or-later
"""How the engine understands each word of the prompt that is being typed."""

from __future__ import annotations

import bpy

from ..core.schema_import import messages, schema
from ..engine.process import Engine
from ..scene.scene_context import GEOMETRY, hidden, layer


class WordReadings:
    """The newest readings of a prompt's words.

    Attributes:
        newest: What the engine last said; of no words before that.
    """

    def __init__(self) -> None:
        self.newest = messages.Readings("")
        self._asked: str | None = None  # the prompt whose readings are on their way

    def due(self, prompt: str) -> bool:
        """Whether these words have not been read yet."""
        return self._asked is not None or prompt != self.newest.prompt

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
            self.newest, self._asked = arrived, None
        prompt = scene.vibe.prompt
        if self._asked is None and prompt != self.newest.prompt:
            engine.send(messages.AskReadings(schema.schema_hash(), prompt, *_names(scene)))
            self._asked = prompt
        return arrived is not None

    def forget(self) -> None:
        """Waits for nothing any more: the engine is another one."""
        self._asked = None


def _names(scene: bpy.types.Scene) -> tuple[dict[str, list[str]], dict[str, str]]:
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
