# SPDX-License-Identifier: GPL-3.0-or-later
# mypy: disable-error-code="valid-type"
"""A word of the prompt: what it is taken for, and another word in its place."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import ClassVar

import bpy
from bpy.props import EnumProperty, StringProperty

from ...core import drawing
from ...core.schema_import import messages, targets
from ...run.state import addon_state
from ...scene import scene_context

_ICONS = {"light": "LIGHT", "sky": "WORLD", "picture": "IMAGE_DATA", "air": "MOD_FLUID", "none": "X"}
"""Kind of target -> icon, of those that every scene has."""
_DO_NOT_USE = "Do not use it"


class VIBE_OT_reading(bpy.types.Operator):
    """Show how this word is understood, and what it could be taken for instead"""

    bl_idname = "vibe.reading"
    bl_label = "Reading of a Word"
    bl_options: ClassVar[set[str]] = {"INTERNAL"}

    key: StringProperty(description="What a target calls the word")
    state: StringProperty()
    meaning: StringProperty()

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        """What is made of the word."""
        more = ". Click to say what it describes"
        return f"{properties.state.capitalize()}: {properties.meaning}{more}"

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Opens a menu."""
        word = self._word()
        if word is None:
            return {"CANCELLED"}
        context.window_manager.popup_menu(self._draw, title=f"“{word.text}”: {word.state}")
        return {"FINISHED"}

    def _word(self) -> messages.WordReading | None:
        """The newest reading of the word; None where the prompt does not say it any more."""
        return next((word for word in addon_state.readings.newest.words if word.key == self.key), None)

    def _draw(self, menu: bpy.types.Menu, context: bpy.types.Context) -> None:
        layout, word = menu.layout, self._word()
        if word is None:
            return
        if not word.candidates or word.meaning != f"describes {targets.listed(word.candidates[0])}":
            layout.label(text=word.meaning[:1].upper() + word.meaning[1:])
        for other in word.others:
            button = layout.operator("vibe.reword", text=f"Say “{other}” instead")
            button.word, button.other = word.text, other
        self._draw_targets(layout, context.scene, word)

    def _draw_targets(
        self, layout: bpy.types.UILayout, scene: bpy.types.Scene, word: messages.WordReading
    ) -> None:
        """What the word may be said to describe: what it is taken for first, then the likeliest, then the rest of the scene."""
        told = scene.vibe.targets.get(word.key)
        if told:
            self._target(layout, "", "As it is read", "LOOP_BACK")
        for name in word.candidates:
            self._named(layout, scene, name, is_taken=name == word.candidates[0])
        if word.targets:
            layout.separator()
        for name in word.targets:
            self._named(layout, scene, name)
        names = {*word.candidates, *word.targets} & {*scene.objects.keys()}
        if names and len(names) < sum(1 for _ in _own_names(scene)):
            layout.operator_context = "INVOKE_DEFAULT"
            layout.operator("vibe.describe_another", icon="VIEWZOOM").word = self.key

    def _named(
        self, layout: bpy.types.UILayout, scene: bpy.types.Scene, name: str, is_taken: bool = False
    ) -> None:
        text = _DO_NOT_USE if name == targets.NOT_USED else f"Describes {targets.listed(name)}"
        self._target(layout, name, text, "CHECKMARK" if is_taken else _icon(scene, name))

    def _target(self, layout: bpy.types.UILayout, target: str, text: str, icon: str) -> None:
        button = layout.operator("vibe.describe", text=text, icon=icon)
        button.word, button.target = self.key, target


def _icon(scene: bpy.types.Scene, name: str) -> str:
    """The icon of a target."""
    if name in targets.GENERAL:
        return _ICONS.get(targets.GENERAL[name], "LIGHT" if "light" in name else "OBJECT_DATA")
    thing = scene.objects.get(targets.parted(name)[0])
    if thing is None:
        return "MATERIAL"
    return "LIGHT" if thing.type == "LIGHT" else "OBJECT_DATA"


def _own_names(scene: bpy.types.Scene) -> Iterator[str]:
    """The objects and lights that a render shows."""
    for obj in scene_context.shown(scene):
        if obj.type == "LIGHT" or (obj.type in scene_context.GEOMETRY and obj.material_slots):
            yield obj.name


_items: list[tuple[str, str, str]] = []
"""Of the search: Blender does not keep the texts of a list that is made when it is asked for."""


def _names(_operator: bpy.types.Operator, context: bpy.types.Context) -> list[tuple[str, str, str]]:
    _items[:] = [(name, name, "") for name in sorted(_own_names(context.scene), key=str.casefold)]
    return _items


class VIBE_OT_describe_another(bpy.types.Operator):
    """Search all objects and lights for what this word describes"""

    bl_idname = "vibe.describe_another"
    bl_label = "Describes Another…"
    bl_property = "target"
    bl_options: ClassVar[set[str]] = {"UNDO", "INTERNAL"}

    word: StringProperty(description="What a target calls the word")
    target: EnumProperty(items=_names)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Opens the search."""
        context.window_manager.invoke_search_popup(self)
        return {"FINISHED"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Keeps the choice in the scene."""
        context.scene.vibe.tell(self.word, self.target)
        drawing.redraw()
        return {"FINISHED"}


class VIBE_OT_describe(bpy.types.Operator):
    """Say what this word describes, where it is taken for something else"""

    bl_idname = "vibe.describe"
    bl_label = "Describes"
    bl_options: ClassVar[set[str]] = {"UNDO", "INTERNAL"}

    word: StringProperty(description="What a target calls the word")
    target: StringProperty(description="Empty: as the word is read")

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Keeps the choice in the scene."""
        context.scene.vibe.tell(self.word, self.target)
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


CLASSES = (VIBE_OT_reading, VIBE_OT_describe, VIBE_OT_describe_another, VIBE_OT_reword)
