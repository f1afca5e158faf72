# SPDX-License-Identifier: GPL-3.0-or-later
# mypy: disable-error-code="valid-type"
"""A word of the prompt: what it is taken for, and another word in its place."""

from __future__ import annotations

import re
from typing import ClassVar

import bpy
from bpy.props import StringProperty

from ...core import drawing
from ...session import word_readings

GENERAL = {"lights": "LIGHT", "key light": "LIGHT", "world": "WORLD", "image": "IMAGE_DATA", "not used": "X"}
"""What every word can be told to describe, as the engine knows it, and the icon."""
_SAYS = {"not used": "Do not use it"}
_MOST = 16  # things of a kind that a menu shows


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
        more = ". Click to say what it describes"
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
        self._draw_targets(layout, context.scene)

    def _draw_targets(self, layout: bpy.types.UILayout, scene: bpy.types.Scene) -> None:
        """What the word may be said to describe: things of the scene, and what every scene has."""
        told = scene.vibe.targets.get(self.word)
        objects, lights = word_readings.names(scene)
        layout.separator()
        if told:
            self._target(layout, "", "As it is read", "LOOP_BACK")
        own = dict.fromkeys([*objects][:_MOST], "OBJECT_DATA") | dict.fromkeys([*lights][:_MOST], "LIGHT")
        for name, icon in (*own.items(), *GENERAL.items()):
            chosen = told is not None and told.target == name
            self._target(layout, name, _SAYS.get(name, f"Describes {name}"), "CHECKMARK" if chosen else icon)

    def _target(self, layout: bpy.types.UILayout, target: str, text: str, icon: str) -> None:
        button = layout.operator("vibe.describe", text=text, icon=icon)
        button.word, button.target = self.word, target


class VIBE_OT_describe(bpy.types.Operator):
    """Say what this word describes, where it is taken for something else"""

    bl_idname = "vibe.describe"
    bl_label = "Describes"
    bl_options: ClassVar[set[str]] = {"UNDO", "INTERNAL"}

    word: StringProperty()
    target: StringProperty(description="Empty: as the word is read")

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Keeps the choice in the scene."""
        targets = context.scene.vibe.targets
        place = targets.find(self.word)
        if place >= 0:
            targets.remove(place)
        if self.target:
            told = targets.add()
            told.name, told.target = self.word, self.target
        drawing.redraw()
        return {"FINISHED"}


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


CLASSES = (VIBE_OT_reading, VIBE_OT_describe, VIBE_OT_reword)
