# SPDX-License-Identifier: GPL-3.0-or-later
# mypy: disable-error-code="valid-type"
"""A word of the prompt: what it is taken for, and another word in its place."""

from __future__ import annotations

import re
from typing import ClassVar

import bpy
from bpy.props import StringProperty


class VIBE_OT_reading(bpy.types.Operator):
    """Show how this word is understood, and what it could be taken for instead"""

    bl_idname = "vibe.reading"
    bl_label = "Reading of a Word"
    bl_options: ClassVar[set[str]] = {"INTERNAL"}

    word: StringProperty()
    state: StringProperty()
    meaning: StringProperty()
    others: StringProperty(description="Known words, in lines")

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        """What is made of the word."""
        more = ". Click for other readings" if properties.others else ""
        return f"{properties.state.capitalize()}: {properties.meaning}{more}"

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Opens a menu."""
        context.window_manager.popup_menu(self._draw, title=f"“{self.word}”: {self.state}")
        return {"FINISHED"}

    def _draw(self, menu: bpy.types.Menu, context: bpy.types.Context) -> None:
        layout = menu.layout
        layout.label(text=self.meaning)
        for other in self.others.splitlines():
            button = layout.operator("vibe.reword", text=f"Say “{other}” instead")
            button.word, button.other = self.word, other


class VIBE_OT_reword(bpy.types.Operator):
    """Put another word in the place of this one"""

    bl_idname = "vibe.reword"
    bl_label = "Another Word"
    bl_options: ClassVar[set[str]] = {"UNDO", "INTERNAL"}

    word: StringProperty()
    other: StringProperty()

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Changes the prompt; its intensity stays with a word."""
        settings = context.scene.vibe
        unknown = self.word.rpartition(" ")[2]
        changed, count = re.subn(
            rf"(?<!\w){re.escape(unknown)}(?!\w)",
            lambda _: self.other,
            settings.prompt,
            count=1,
            flags=re.IGNORECASE,
        )
        if not count:
            self.report({"WARNING"}, f"The prompt does not say “{unknown}” any more")
            return {"CANCELLED"}
        settings.prompt = changed
        return {"FINISHED"}


CLASSES = (VIBE_OT_reading, VIBE_OT_reword)
