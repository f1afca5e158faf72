# SPDX-License-Identifier: GPL-3.0-or-later
"""Further sentences in the panel: the list of steps, and the field for the next one. Each action is one undo step."""

from __future__ import annotations

from typing import Any

import bpy
from bpy.props import EnumProperty, IntProperty

from ..core.schema_import import schema
from ..run import result
from ..run.session import Session
from ..run.state import addon_state
from ..scene import bindings
from ..scene.steps import WORDLESS, Steps
from . import bases, run
from .drawing import columns, paragraph
from .engine_state import engine_state

_ACTS = {
    "SHOW": "Show the scene as it was after this step",
    "SWITCH": "Switch this step off or on; the others stay",
    "EDIT": "Take the sentence into the field: the next search replaces this step, and the later ones follow",
    "REMOVE": "Remove this step; the others stay",
}


def draw(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draws the steps, with the last shown one pressed, and below them the field for a further sentence."""
    settings = context.scene.vibe
    try:
        steps = Steps.of(context.scene)
    except schema.VibeError as error:
        paragraph(layout, context, str(error), "ERROR")
        return
    column = layout.column(align=True)
    most = columns(context) - 14
    for number, step in enumerate(steps.steps, start=1):
        row = column.row(align=True)
        shown = row.row(align=True)
        shown.active = step.on and number <= steps.shown
        text = f"{number}. {step.sentence}"
        text = text if len(text) <= most else f"{text[: most - 1].rstrip()}…"
        _button(shown, number, "SHOW", text=text, depress=number == steps.shown)
        _button(row, number, "SWITCH", icon="CHECKBOX_HLT" if step.on else "CHECKBOX_DEHLT")
        if step.sentence not in WORDLESS:
            _button(row, number, "EDIT", icon="GREASEPENCIL", depress=number == settings.edited)
        _button(row, number, "REMOVE", icon="X")
    field = column.row(align=True)
    field.scale_y = 1.3
    field.prop(settings, "further", text="", placeholder="And now … a bit warmer")
    field.operator("vibe.further", text="", icon="SHADERFX")


def _button(row: bpy.types.UILayout, number: int, act: str, **looks: Any) -> None:
    button = row.operator("vibe.step", **({"text": ""} | looks))
    button.number, button.act = number, act


def _current(scene: bpy.types.Scene) -> Steps:
    """The steps of a scene, with a new one for values that the artist has changed by hand; switches Before off."""
    if scene.vibe.show_original:
        scene.vibe.show_original = False
    steps = Steps.of(scene)
    steps.take_hand_made(bindings.read(scene, (), steps.pivot))
    return steps


class VIBE_OT_further(run.Vibing, label="Go On"):
    """Go on from the result by this sentence: what it does not mention stays"""

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        reason = bases.ResultOperator.obstacle(context)
        if not reason and not context.scene.vibe.further.strip():
            reason = "Say what is to change first"
        return reason or ("Set up the engine first" if engine_state.problem else "")

    def _begin(self, context: bpy.types.Context, ask: bool = False) -> Session | None:
        """Begins and returns a session for the sentence; None if its change needs no search and is made at once."""
        scene = context.scene
        settings = scene.vibe
        steps = _current(scene)
        place = settings.edited - 1
        edits = 0 <= place < len(steps.steps)
        change = steps.again(place, settings.further) if edits else steps.change(settings.further)
        if change.sentence:
            return addon_state.begin(context, ask, change)
        steps.add(change, bindings.read(scene, (), steps.pivot), {})
        result.show(scene, steps)
        return None

    def _done(self, failure: schema.VibeError | None, severity: str) -> set[str]:
        if failure is None:
            settings = bpy.context.scene.vibe
            settings.further, settings.edited = "", 0
        return super()._done(failure, severity)


class VIBE_OT_step(bases.ResultOperator, label="Step", options={"UNDO", "INTERNAL"}):
    """Change the list of steps"""

    number: IntProperty(min=1)
    act: EnumProperty(items=[(act, act.title(), text) for act, text in _ACTS.items()])

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        return _ACTS[properties.act]

    def perform(self, context: bpy.types.Context) -> None:
        scene, place = context.scene, self.number - 1
        steps = _current(scene)
        if place >= len(steps.steps):
            raise schema.VibeError(f"There is no step {self.number}.", "Choose one of the list.")
        step = steps.steps[place]
        if self.act == "EDIT":
            leaves = scene.vibe.edited == self.number
            scene.vibe.further, scene.vibe.edited = ("", 0) if leaves else (step.sentence, self.number)
            return
        if self.act == "SHOW":
            steps.shown = self.number
        elif self.act == "SWITCH":
            step.on = not step.on
        else:
            steps.steps.remove(step)
            steps.shown -= place < steps.shown
            scene.vibe.edited = 0
        result.show(scene, steps)
