# SPDX-License-Identifier: GPL-3.0-or-later
"""The prompts that were typed, with the targets of their words, the newest first: a small file of the user's, for all scenes."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Sequence
from typing import ClassVar

import bpy
from bpy.props import StringProperty

from ..core.files import whole
from ..core.preferences import own_folder
from ..core.schema_import import checks, schema, targets
from .bases import Operator

_MOST = 30  # prompts that are kept
_NAME = "prompts.json"


def prompts() -> list[str]:
    """The stored prompts, the newest first; none where the file cannot be read."""
    return [text for text, _ in _stored()]


def targets_of(prompt: str) -> list[str]:
    """The artist's targets for words of a stored prompt: "copper=Cup"."""
    return next((pairs for text, pairs in _stored() if text == prompt), [])


def remember(prompt: str, pairs: Sequence[str] = ()) -> None:
    """Puts a prompt and its targets first, and drops the oldest. Where the folder cannot be written, nothing fails."""
    kept = [(prompt, [*pairs]), *(each for each in _stored() if each[0] != prompt)][:_MOST]
    rows = [{"prompt": text, "targets": each} if each else text for text, each in kept]
    with contextlib.suppress(OSError, schema.VibeError), whole(own_folder("", create=True) / _NAME) as part:
        part.write_text(json.dumps(rows, ensure_ascii=False, indent=1), encoding="utf-8")


def _stored() -> list[tuple[str, list[str]]]:
    """The prompts with their targets, as far as the file, which anybody may have written, has the right form."""
    try:
        stored = json.loads((own_folder("") / _NAME).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return []
    found = []
    for row in stored if isinstance(stored, list) else ():
        given = {"prompt": row} if isinstance(row, str) else row
        if isinstance(given, dict) and isinstance(given.get("prompt"), str):
            pairs = given.get("targets")
            pairs = pairs if isinstance(pairs, list) else []
            usable = [pair for pair in pairs if isinstance(pair, str) and "=" in pair.strip("= ")]
            found.append((given["prompt"], usable))
    return found


def clear() -> None:
    """Deletes the history."""
    with contextlib.suppress(OSError):
        (own_folder("") / _NAME).unlink(missing_ok=True)


class VIBE_MT_history(bpy.types.Menu):
    """The prompts that were typed."""

    bl_label = "Earlier Prompts"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        earlier = prompts()
        for text in earlier[:20]:
            layout.operator("vibe.recall", text=text if len(text) < 70 else f"{text[:67]}…").prompt = text
        if earlier:
            layout.separator()
            layout.operator("vibe.clear_history", icon="TRASH")
        else:
            layout.label(text="Nothing yet")


class VIBE_OT_recall(Operator):
    """Put these words into the prompt"""

    bl_label = "Recall"
    bl_options: ClassVar[set[str]] = {"UNDO", "INTERNAL"}

    prompt: StringProperty()

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        return properties.prompt

    def perform(self, context: bpy.types.Context) -> None:
        """Sets the prompt, and the targets of its words as far as the scene has them."""
        settings = context.scene.vibe
        settings.prompt = self.prompt
        known = (targets.GENERAL, context.scene.objects, bpy.data.materials)
        for word, target in checks.targets(targets_of(self.prompt)).items():
            if all(any(name in names for names in known) for name in targets.target_names(target)):
                settings.set_target(word, target)


class VIBE_OT_clear_history(Operator):
    """Forget the prompts that were typed"""

    bl_label = "Clear History"

    def perform(self, context: bpy.types.Context) -> None:
        clear()
