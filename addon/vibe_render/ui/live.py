# SPDX-License-Identifier: GPL-3.0-or-later
"""Live in the panel: its switch, the timer of its steps, the look of the words so far, and its keys."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import bpy

from ..core.schema_import import errors
from ..run.live import Live
from ..run.state import addon_state
from . import bases, drawing

_TICK = 0.02  # seconds between two steps
_KEYS = (("vibe.entered", "RET"), ("vibe.entered", "NUMPAD_ENTER"), ("vibe.escaped", "ESC"))
_keys: list[tuple[Any, Any]] = []  # keymap and item of each key that is registered


def switched(window_manager: Any, context: bpy.types.Context) -> None:
    """Update function of the switch: starts Live with the present words, or ends it and restores the scene."""
    if window_manager.vibe_live:
        typed(context.scene.vibe, context)
    else:
        addon_state.end_live()


def typed(settings: Any, context: bpy.types.Context) -> None:
    """Update function of the prompt, at every character: hands the words to Live, if Live is on."""
    if not context.window_manager.vibe_live or addon_state.running or bases.untouchable(context):
        return
    addon_state.live_for(context).typed(settings.prompt)
    drawing.begin(_tick, _TICK)


def _tick() -> float | None:
    live = addon_state.live
    if live is None or addon_state.running:
        return None
    before = live.stage, live.look
    try:
        live.advance()
    except Exception as error:  # an artist must never be left with a stuck panel
        addon_state.end_live()
        addon_state.failure = errors.to_show(error, "looking at the words")
        drawing.redraw()
        return None
    if before != (live.stage, live.look):
        drawing.redraw()
    return _TICK if live.busy else None


def draw(layout: bpy.types.UILayout, context: bpy.types.Context, live: Live) -> None:
    """Draws the look of the words so far, and the words that are not visible in it."""
    if not live.look:
        return
    box = layout.box()
    drawing.before_after(box, live.before, live.preview, 8.5)
    draw_words(box, context, live.words)
    drawing.see_rendered(box, context)


def draw_words(layout: bpy.types.UILayout, context: bpy.types.Context, words: Mapping[str, bool]) -> None:
    """Draws the words that are not visible in the look so far; `words`: look word -> True if it is visible."""
    if missing := [word for word, shown in words.items() if not shown]:
        drawing.paragraph(layout, context, f"Not visible yet: {', '.join(missing)}", "HIDE_ON")
    elif words:
        drawing.paragraph(layout, context, "No word is missing so far", "HIDE_OFF")


class VIBE_OT_entered(bases.Operator, label="Vibe It from the Prompt", options={"INTERNAL"}):
    """Begin the search for the words that were typed"""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return _typed_here(context) and bpy.ops.vibe.run.poll()

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        bpy.ops.vibe.run("INVOKE_DEFAULT")
        return {"FINISHED"}


class VIBE_OT_escaped(bases.Operator, label="Take the Look Away", options={"INTERNAL"}):
    """Take the look of what was typed out of the scene"""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return _typed_here(context) and not addon_state.running

    def perform(self, context: bpy.types.Context) -> None:
        if addon_state.live:
            addon_state.live.clear()


def _typed_here(context: bpy.types.Context) -> bool:
    """True if the pointer is over the tab "Vibe", and words have been typed that no vibe has been started for."""
    live, region = addon_state.live, context.region
    return bool(live and live.typing and region and region.active_panel_category == "Vibe")


def register_keys() -> None:
    """Adds Enter, which begins the search from the prompt, and Esc, which takes the look away, to Blender's keymap."""
    # Blender does not report how a text field was left, and the field consumes the press of the key: so the keymap
    # listens for the release.
    config = bpy.context.window_manager.keyconfigs.addon
    if config:  # none without a window
        keymap = config.keymaps.new(name="User Interface")
        _keys.extend((keymap, keymap.keymap_items.new(operator, key, "RELEASE")) for operator, key in _KEYS)


def unregister_keys() -> None:
    """Inverse of `register_keys`."""
    for keymap, item in _keys:
        keymap.keymap_items.remove(item)
    _keys.clear()
