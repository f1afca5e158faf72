# SPDX-License-Identifier: GPL-3.0-or-later
"""Check Sequence in the panel: the frames of the scene where a word of the result is no longer visible."""

from __future__ import annotations

from typing import ClassVar

import bpy

from ..core.schema_import import schema
from ..run.sequence import frame_line, steady_line
from ..run.session import Session
from ..run.state import addon_state
from ..scene import own_keys
from . import bases, drawing, run

_SHOWN = 12  # frames that are listed


def draw(layout: bpy.types.UILayout, context: bpy.types.Context, session: Session) -> None:
    """The button, and below it the frames that it has found, each with its image."""
    row = layout.row(align=True)
    row.operator("vibe.check_sequence", icon="SEQUENCE")
    row.prop(context.scene.vibe, "check_every")
    lost = [each for each in session.sequence if frame_line(each)]
    if note := steady_line(session.sequence):
        drawing.paragraph(layout, context, note, "CHECKMARK")
    for each in lost[:_SHOWN]:
        if shown := drawing.icon(each.picture):
            layout.template_icon(icon_value=shown, scale=5.0)
        drawing.paragraph(layout, context, frame_line(each), "HIDE_ON")
    if len(lost) > _SHOWN:
        layout.label(text=f"and {len(lost) - _SHOWN} more frames", icon="BLANK1")


class VIBE_OT_check_sequence(run.Vibing):
    """Measure the words at frames of the scene, from its first to its last. Nothing in the scene changes"""

    bl_label = "Check Sequence"
    bl_options: ClassVar[set[str]] = set()

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        session = addon_state.session
        if reason := bases.result_obstacle(context):
            return reason
        if not (session and session.report and session.scene == context.scene.name):
            return "Run the vibe again first: its measures last only as long as Blender runs"
        return bases.HELD if own_keys.are_held(context.scene) else ""

    def _begin(self, context: bpy.types.Context, ask: bool = False) -> Session:
        session = addon_state.session
        assert session
        session.check(context.scene, context.scene.vibe.check_every)
        addon_state.running = True
        return session

    def _done(self, failure: schema.VibeError | None, severity: str) -> set[str]:
        if failure is None and addon_state.session:
            frames = addon_state.session.sequence
            lost = sum(bool(frame_line(each)) for each in frames)
            self.report({"INFO"}, f"{len(frames)} frames checked: {lost} are listed under Result")
            return {"FINISHED"}
        return super()._done(failure, severity)
