# SPDX-License-Identifier: GPL-3.0-or-later
"""The result in the panel: images, Keep, Revert, strength, variants, words, changes. Each action is one undo step."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

import bpy
from bpy.props import IntProperty, StringProperty

from ..core.schema_import import labels, messages, schema
from ..export.notes import shortened_notes
from ..render import reference
from ..run import result
from ..run.notes import frame_line, shortfall, steady_line, word_notes, words_of
from ..run.session import Session
from ..run.state import addon_state
from ..scene import keyframes, moments, own_keys, snapshot
from . import run, steps
from .bases import HELD, Operator, ResultOperator
from .drawing import GROUP_ICONS, HEX_COLOR, before_after, colored, columns, icon, paragraph, see_rendered
from .scope import draw_lock

_STATES = {  # state of a word's verdict -> title and icon of the state
    "visible": ("Visible", "HIDE_OFF"),
    "already": ("Was so already", "DOT"),
    "unmeasured": ("Set, not measured", "DOT"),
}
_FRAMES = 12  # most checked frames that are listed


class ResultPanel:
    """The last vibe: its images, and at once below them Keep and Revert; then what refines and explains it."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return snapshot.exists(context.scene) and not addon_state.running

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, context.scene.vibe  # type: ignore[attr-defined]
        session = addon_state.session
        if session and session.scene != context.scene.name:
            session = None
        if not (wanted := reference.request_title(settings.vibed_prompt, settings.vibed_like)):
            text = "This scene has changes of Light Mix, or of an earlier vibe. Revert removes them."
            paragraph(layout, context, text)
        elif settings.vibed_like or settings.vibed_prompt != settings.prompt:
            paragraph(layout, context, wanted, faint=True)
        variants = session.variants if session else []
        if session:
            shown = variants[settings.variant][1] if 0 < settings.variant < len(variants) else session.preview
            before_after(layout, session.before, shown, 10.5)
        row = layout.row(align=True)
        row.scale_y = 1.3
        row.operator("vibe.keep", icon="FILE_TICK")
        row.operator("vibe.keyframe", icon="KEYFRAME")
        row.operator("vibe.revert", icon="LOOP_BACK")
        if reason := ResultOperator.obstacle(context):
            paragraph(layout, context, reason, "INFO", faint=True)
        if own_keys.are_held(context.scene):
            paragraph(layout, context, HELD, "KEYFRAME", faint=True)
        if keyframes.exist(context.scene):
            paragraph(layout, context, _keyframes_note(context.scene), "KEYFRAME", faint=True)
        if settings.changes:  # Before, After and Strength change the scene itself
            column = layout.column(align=True)
            row = column.row(align=True)
            row.prop(settings, "show_original", text="Before", toggle=True)
            row.prop(settings, "show_original", text="After", toggle=True, invert_checkbox=True)
            column.prop(settings, "strength", slider=True)
            see_rendered(column, context)
        if len(variants) > 1:
            _draw_variants(layout, variants, settings.variant)
        if session and not settings.variant:  # what is visible was measured on the first variant
            _draw_verdicts(layout, context, session)
            _draw_sequence(layout, context, session)
        steps.draw(layout, context)
        if settings.changes:
            draw_changes(layout, context)
        row = layout.row(align=True)
        row.operator("vibe.run", text="Retry (New Seed)", icon="FILE_REFRESH").again = True
        row.operator("vibe.preset_save", text="Save Preset", icon="PRESET_NEW")
        if session:
            failed_anchors = session.report.get("anchored", {}).get("notes", [])
            notes = shortened_notes([*failed_anchors, *session.warnings])
            for note in [*word_notes(session.report)[:4], *notes]:  # below what is always there
                paragraph(layout, context, note, "INFO", faint=True)


def _keyframes_note(scene: bpy.types.Scene) -> str:
    """A line on the frames that have keyframes of looks, and, if these are muted, on how to bring them back."""
    try:
        numbers = [str(moment.frame) for moment in moments.of(scene)]
    except schema.VibeError as error:
        return str(error)
    frames = f"frame{'s' if len(numbers) > 1 else ''} {', '.join(numbers)}"
    if keyframes.are_shown(scene):
        return f"Keyframes at {frames}. Go to another frame for another look"
    return f"Keyframes at {frames} are set aside. Keyframe adds {scene.frame_current} and brings them back"


def _draw_verdicts(layout: bpy.types.UILayout, context: bpy.types.Context, session: Session) -> None:
    """Draws the words that are visible and not visible, and the prediction's error; none of it outlives the session."""
    verdicts = session.report.get("verdicts", ())
    for state, (name, icon_name) in _STATES.items():
        if words := words_of(verdicts, state):
            paragraph(layout, context, f"{name}: {', '.join(words)}", icon_name)
    for row in verdicts:
        if row["state"] == "missed" and row["word"]:
            colors = HEX_COLOR.search(row["missing"])
            missing = row["why"] if colors else shortfall(row)
            text = ". ".join(filter(None, (row["word"], missing[:1].upper() + missing[1:])))
            paragraph(layout, context, f"Not visible: {text}", "HIDE_ON")
            if colors:
                colored(layout, row["missing"])
            if row["unlock"] in context.scene.vibe.locks:
                layout.operator("vibe.lock", text="Unlock", icon="UNLOCKED").key = row["unlock"]
    if session.prediction_error is not None:
        text, good = agreement(session.prediction_error, context.scene.render.engine)
        paragraph(layout, context, text, "CHECKMARK" if good else "INFO")


def agreement(difference: float, engine: str) -> tuple[str, bool]:
    """The agreement of preview and render in words, and True if it is good; `difference`: their mean CIEDE2000."""
    if engine != "CYCLES":
        return "Preview is Cycles. EEVEE may look different", False
    # 1 is the least difference that people see side by side.
    words = "matches" if difference < 1.0 else "is close to" if difference < 3.0 else "differs from"
    tenths = max(math.ceil(difference * 10.0), 1)
    return f"The preview {words} Cycles (ΔE {tenths / 10.0:.1f}; 1 is just visible)", difference < 3.0


def _draw_sequence(layout: bpy.types.UILayout, context: bpy.types.Context, session: Session) -> None:
    """Draws the button Check Sequence, and each frame that lost a word or could not be checked, with its image."""
    row = layout.row(align=True)
    row.operator("vibe.check_sequence", icon="SEQUENCE")
    row.prop(context.scene.vibe, "check_every")
    if note := steady_line(session.sequence):
        paragraph(layout, context, note, "CHECKMARK")
    lost = [each for each in session.sequence if frame_line(each)]
    for each in lost[:_FRAMES]:
        if shown := icon(each.picture):
            layout.template_icon(icon_value=shown, scale=5.0)
        paragraph(layout, context, frame_line(each), "HIDE_ON")
    if len(lost) > _FRAMES:
        layout.label(text=f"and {len(lost) - _FRAMES} more frames", icon="BLANK1")


def _draw_variants(layout: bpy.types.UILayout, variants: Sequence[tuple[messages.Variant, Path]], current: int) -> None:
    """Draws each variant as a square image with a button below; `current`: number of the one in the scene, from 0."""
    across = min(len(variants), 4)
    grid = layout.grid_flow(row_major=True, columns=across, even_columns=True, align=True)
    for number, (_, picture) in enumerate(variants):
        cell = grid.column(align=True)
        if shown := icon(picture, square=True):
            cell.template_icon(icon_value=shown, scale=max(10.4 / across, 3.2))
        used = number == current
        text = str(number + 1) if used else f"Use {number + 1}"
        cell.operator("vibe.variant", text=text, depress=used).number = number


def draw_changes(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draws each changed value with its old value and its reason, grouped by light, material …; closed at first."""
    changes = [c for c in context.scene.vibe.changes if not labels.same(c.name, *c.values())]
    header, body = layout.panel("vibe_changes", default_closed=True)
    header.label(text=f"Changes ({len(changes)})")
    if body is None:
        return
    owned = groupby(changes, key=lambda change: schema.split_key(change.name)[:2])
    for number, ((group, owner), entries) in enumerate(owned):
        if number:
            body.separator(factor=0.3)
        column = body.column(align=True)
        column.label(text=owner or labels.GROUP_TITLES[group], icon=GROUP_ICONS[group])
        for why, same in groupby(entries, key=lambda change: result.cause(change.reason)):
            _draw_changes(column, context, list(same), why)


def _draw_changes(layout: bpy.types.UILayout, context: bpy.types.Context, same: Sequence[Any], why: str) -> None:
    """Draws changes with the same cause, and below them `why`, the cause, with the whole reason as its tooltip."""
    for change in same:
        parameter = labels.parameter(change.name)
        row = layout.row(align=True)
        split = row.split(factor=0.44, align=True)
        split.label(text=labels.words(parameter.name))
        values = split.row(align=True)
        if parameter.kind == "color":
            values.enabled = False
            values.prop(change, "before", text="")
            values.prop(change, "after", text="")
        else:
            values.alignment = "RIGHT"
            before, after = change.values()  # the unit stands there once
            values.label(text=f"{labels.bare(change.name, before)} → {labels.text(change.name, after)}")
        if not schema.light_links.link_of(change.name):  # no search changes a link
            draw_lock(row, context.scene.vibe, change.name)
    if why:
        most = columns(context)
        text = why if len(why) <= most else f"{why[: most - 1].rstrip()}…"
        row = layout.row()
        row.active, row.alignment, row.scale_y = False, "LEFT", 0.75
        row.operator("vibe.why", text=text, emboss=False).key = same[-1].name


class VIBE_OT_revert(ResultOperator, label="Revert"):
    """Restore the scene exactly as it was before the first vibe"""

    severity = "WARNING"

    def perform(self, context: bpy.types.Context) -> str:
        try:
            lost = result.revert(context.scene)
        except schema.VibeError as error:
            addon_state.end(error)  # it stays in the panel, not in a passing report alone
            raise
        addon_state.forget()
        addon_state.forget_mix()
        return f"{len(lost)} values could not be restored: {lost[0]}" if lost else ""


class VIBE_OT_keep(ResultOperator, label="Keep"):
    """Make the result final. Revert and Save Preset are no longer possible"""

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        aside = keyframes.exist(context.scene) and not keyframes.are_shown(context.scene)
        reason = "Keyframe this look first: the keyframes of the others are set aside" if aside else ""
        return super().obstacle(context) or reason

    def perform(self, context: bpy.types.Context) -> str:
        result.keep(context.scene)
        addon_state.forget()
        return "The values are yours now. Undo takes that back"


class VIBE_OT_keyframe(ResultOperator, label="Keyframe"):
    """Keyframe all values of the result at the current frame. Values go from one keyframed look to the next in even steps"""

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        unchanged = "" if context.scene.vibe.changes else "The result has changed nothing"
        held = HELD if own_keys.are_held(context.scene) else ""
        return super().obstacle(context) or unchanged or held

    def perform(self, context: bpy.types.Context) -> str:
        if left := result.keyframe(context.scene):
            self.severity = "WARNING"
            return f"{len(left)} values were left alone. {left[0]}"
        return f"The look is keyframed at frame {context.scene.frame_current}"


class VIBE_OT_variant(ResultOperator, label="Variant", options={"UNDO", "INTERNAL"}):
    """Use this variant in place of the other"""

    number: IntProperty(min=0)

    def perform(self, context: bpy.types.Context) -> None:
        session, scene = addon_state.session, context.scene
        if session is None or not 0 <= self.number < len(session.variants):
            raise schema.VibeError("That variant is gone")
        result.choose(scene, self.number, session.variants[self.number][0], session.subject(scene))


class VIBE_OT_why(Operator, label="Why", options={"INTERNAL"}):
    """Why this value changed"""

    key: StringProperty()

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        change = context.scene.vibe.changes[properties.key]
        where = f"{labels.title(change.name)}, found at {labels.parameter(change.name).blender}"
        return f"{change.reason}.\n{where}" if change.reason else where

    def execute(self, context: bpy.types.Context) -> set[str]:
        self.report({"INFO"}, context.scene.vibe.changes[self.key].reason or "The look needs it")
        return {"CANCELLED"}


class VIBE_OT_check_sequence(run.Vibing, label="Check Sequence", options=set()):
    """Measure the words at frames of the scene, from its first to its last. Nothing in the scene changes"""

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        session = addon_state.session
        reason = HELD if own_keys.are_held(context.scene) else ""
        if not (session and session.report and session.scene == context.scene.name):
            reason = "Run the vibe again first: its measures last only as long as Blender runs"
        return ResultOperator.obstacle(context) or reason

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
