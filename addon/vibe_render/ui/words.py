# SPDX-License-Identifier: GPL-3.0-or-later
"""The words of the prompt, marked as understood, guessed or left out, with menus of targets; the history of prompts."""

from __future__ import annotations

import contextlib
import json
import re
from collections.abc import Sequence

import bpy
from bpy.props import StringProperty

from ..core import rendered
from ..core.files import whole
from ..core.preferences import own_folder
from ..core.schema_import import checks, messages, schema, targets
from ..run.state import addon_state
from . import drawing
from .bases import Operator

_TICK = 0.02  # seconds between two checks for readings from the engine
_STATE_ICONS = {"understood": "NONE", "guessed": "QUESTION", "left out": "CANCEL"}
_FEW = 3  # most selected objects that are named one by one
_MARGIN, _ICON = 2, 3  # width of a word's margins, and of its icon, in characters
_ICONS = {"light": "LIGHT", "sky": "WORLD", "picture": "IMAGE_DATA", "air": "MOD_FLUID", "none": "CANCEL"}
"""Kind of target -> icon, for targets that every scene has."""
_MOST = 30  # most prompts that are stored
_NAME = "prompts.json"


def _tick() -> float | None:
    scene, readings = bpy.context.scene, addon_state.readings
    if addon_state.running or not addon_state.engine_runs:
        readings.forget()
        return None
    with contextlib.suppress(schema.VibeError):  # the next vibe says why the engine is gone
        if readings.step(addon_state.engine(bpy.context), scene, addon_state.live_job(scene)):
            drawing.redraw()
    return _TICK if readings.due(scene, addon_state.live_job(scene)) else None


def draw(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draws each word of the prompt as a button that opens its menu, and a note if no word is understood."""
    if addon_state.engine_runs and addon_state.readings.due(context.scene, addon_state.live_job(context.scene)):
        drawing.begin(_tick, 0.0)  # has new words read
    readings = addon_state.readings.newest
    if readings.note:
        drawing.paragraph(layout, context, readings.note, "INFO", faint=True)
    column = layout.column(align=True)
    column.scale_y = 0.9
    left = 0  # characters that still fit into the line
    for word in readings.words:
        needed = len(word.text) + _MARGIN + (0 if word.state == "understood" else _ICON)
        if needed > left:
            row, left = column.row(align=True), drawing.columns(context)
            row.alignment = "LEFT"
        left -= needed
        place = row.row(align=True)
        place.alignment, place.active = "LEFT", word.state != "left out"
        button = place.operator("vibe.reading", text=word.text, icon=_STATE_ICONS[word.state], emboss=False)
        button.key, button.state, button.meaning = word.key, word.state, word.meaning


class VIBE_OT_reading(Operator, label="Reading of a Word", options={"INTERNAL"}):
    """Show how this word is understood, and what it could be taken for instead"""

    key: StringProperty(description="What a target calls the word")
    state: StringProperty()
    meaning: StringProperty()

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        return f"{properties.state.capitalize()}: {properties.meaning}. Click to say what it describes"

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if word := self._word():
            context.window_manager.popup_menu(self._draw, title=f"“{word.text}”: {word.state}")
        return {"FINISHED"} if word else {"CANCELLED"}

    def _word(self) -> messages.WordReading | None:
        return next((word for word in addon_state.readings.newest.words if word.key == self.key), None)

    def _draw(self, menu: bpy.types.Menu, context: bpy.types.Context) -> None:
        """Draws the menu: other words, then targets: the present one, the other likely ones, the rest of the scene."""
        layout, scene, word = menu.layout, context.scene, self._word()
        if word is None:
            return
        if not word.candidates or word.meaning != f"describes {targets.listed(word.candidates[0])}":
            layout.label(text=word.meaning[:1].upper() + word.meaning[1:])
        for other in word.others:
            button = layout.operator("vibe.reword", text=f"Say “{other}” instead")
            button.word, button.other = word.text, other
        if scene.vibe.targets.get(word.key):
            self._draw_target(layout, "", "LOOP_BACK", "As it is read")
        for name in word.candidates:
            icon = "RADIOBUT_ON" if name == word.candidates[0] else _icon(scene, name)
            self._draw_target(layout, name, icon)
        self._draw_selection(layout, scene, word)
        if word.targets:
            layout.separator()
        for name in word.targets:
            self._draw_target(layout, name, _icon(scene, name))

    def _draw_selection(self, layout: bpy.types.UILayout, scene: bpy.types.Scene, word: messages.WordReading) -> None:
        """Offers all selected objects, or all selected lights, as one target, if the word can describe that kind."""
        offered = (*word.candidates, *word.targets)
        selected = [obj for obj in rendered.shown(scene) if obj.select_get()]
        things = [obj.name for obj in selected if obj.type in rendered.GEOMETRY and obj.material_slots]
        lights = [obj.name for obj in selected if obj.type == "LIGHT"]
        chosen = things or lights
        target = targets.joined(chosen)
        kinds = {_icon(scene, name) for name in offered}
        if (things and lights) or not chosen or target in offered or _icon(scene, target) not in kinds:
            return
        listed = targets.listed(target) if len(chosen) <= _FEW else f"{len(chosen)} objects"
        self._draw_target(layout, target, "RESTRICT_SELECT_OFF", f"Describes the selected: {listed}")

    def _draw_target(self, layout: bpy.types.UILayout, target: str, icon: str, text: str = "") -> None:
        text = text or ("Do not use it" if target == targets.NOT_USED else f"Describes {targets.listed(target)}")
        button = layout.operator("vibe.describe", text=text, icon=icon)
        button.word, button.target = self.key, target


def _icon(scene: bpy.types.Scene, name: str) -> str:
    if name in targets.GENERAL:
        return _ICONS.get(targets.GENERAL[name], "LIGHT" if "light" in name else "OBJECT_DATA")
    obj = scene.objects.get(targets.target_names(name)[0])
    if obj is None:
        return "MATERIAL"
    return "LIGHT" if obj.type == "LIGHT" else "OBJECT_DATA"


class VIBE_OT_describe(Operator, label="Describes", options={"UNDO", "INTERNAL"}):
    """Say what this word describes, where it is taken for something else"""

    word: StringProperty(description="What a target calls the word")
    target: StringProperty(description="Empty: as the word is read")

    def perform(self, context: bpy.types.Context) -> None:
        context.scene.vibe.set_target(self.word, self.target)


class VIBE_OT_reword(Operator, label="Another Word", options={"UNDO", "INTERNAL"}):
    """Put another word in the place of this one"""

    word: StringProperty()
    other: StringProperty()

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Puts `other` into the prompt in place of `word`; an intensity before it, such as "very", stays."""
        settings, unknown = context.scene.vibe, self.word.rpartition(" ")[2]
        pattern = re.compile(rf"(?<!\w){re.escape(unknown)}(?!\w)", re.IGNORECASE)
        if not pattern.search(settings.prompt):
            self.report({"WARNING"}, f"The prompt does not say “{unknown}” any more")
            return {"CANCELLED"}
        settings.prompt = pattern.sub(lambda _: self.other, settings.prompt, count=1)
        return {"FINISHED"}


def history() -> dict[str, list[str]]:
    """Stored prompt -> the targets chosen for its words ("copper=Cup"), the newest first; empty if none can be read."""
    try:
        rows = json.loads((own_folder("") / _NAME).read_text(encoding="utf-8"))
        return dict((row, []) if isinstance(row, str) else (row["prompt"], row["targets"]) for row in rows)
    except (OSError, ValueError, TypeError, KeyError):  # unreadable, or not of the expected form
        return {}


def remember(prompt: str, pairs: Sequence[str] = ()) -> None:
    """Stores a prompt, with its targets `pairs`, as the newest; drops the oldest. Ignores an unwritable file."""
    kept = {prompt: [*pairs]} | {text: each for text, each in history().items() if text != prompt}
    rows = [{"prompt": text, "targets": each} for text, each in kept.items()][:_MOST]
    with contextlib.suppress(OSError, schema.VibeError):
        own_folder("").mkdir(parents=True, exist_ok=True)
        with whole(own_folder("") / _NAME) as part:
            part.write_text(json.dumps(rows, ensure_ascii=False, indent=1), encoding="utf-8")


class VIBE_MT_history(bpy.types.Menu):
    """The prompts that were typed."""

    bl_label = "Earlier Prompts"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        earlier = history()
        for text in list(earlier)[:20]:
            layout.operator("vibe.recall", text=text if len(text) < 70 else f"{text[:67]}…").prompt = text
        if earlier:
            layout.separator()
            layout.operator("vibe.clear_history", icon="TRASH")
        else:
            layout.label(text="Nothing yet")


class VIBE_OT_recall(Operator, label="Recall", options={"UNDO", "INTERNAL"}):
    """Put these words into the prompt"""

    prompt: StringProperty()

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        return properties.prompt

    def perform(self, context: bpy.types.Context) -> None:
        """Sets the prompt, and those targets of its words whose names are in the scene."""
        settings = context.scene.vibe
        settings.prompt = self.prompt
        known = (targets.GENERAL, context.scene.objects, bpy.data.materials)
        for word, target in checks.targets(history().get(self.prompt, ())).items():
            if all(any(name in names for names in known) for name in targets.target_names(target)):
                settings.set_target(word, target)


class VIBE_OT_clear_history(Operator, label="Clear History"):
    """Forget the prompts that were typed"""

    def perform(self, context: bpy.types.Context) -> None:
        with contextlib.suppress(OSError):
            (own_folder("") / _NAME).unlink(missing_ok=True)
