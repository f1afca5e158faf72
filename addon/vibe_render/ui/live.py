# SPDX-License-Identifier: GPL-3.0-or-later
"""Live in the panel: its switch, what a letter that is typed does, and the timer of its steps."""

from __future__ import annotations

from typing import Any

import bpy

from ..core import drawing
from ..core.schema_import import faults, schema
from ..run.state import addon_state
from . import obstacles

_TICK = 0.02  # seconds between two steps


def switched(window_manager: Any, context: bpy.types.Context) -> None:
    """Switched on, it looks at the words that are there; switched off, it leaves the scene as it was."""
    if window_manager.vibe_live:
        typed(context.scene.vibe, context)
    else:
        addon_state.end_live()


def typed(settings: Any, context: bpy.types.Context) -> None:
    """A letter was typed into the prompt, or taken away."""
    if not context.window_manager.vibe_live or addon_state.running or obstacles.untouchable(context):
        return
    addon_state.live_for(context).typed(settings.prompt)
    if not bpy.app.timers.is_registered(_tick):
        bpy.app.timers.register(_tick, first_interval=_TICK)


def _tick() -> float | None:
    live = addon_state.live
    if live is None or addon_state.running:
        return None
    before = live.stage, live.look
    failure = None
    try:
        live.advance()
    except schema.VibeError as error:
        failure = error
    except Exception as error:  # an artist must never be left with a stuck panel
        failure = faults.unexpected(error, "looking at the words")
    if failure:
        addon_state.end_live()
        addon_state.failure = failure
    if failure or before != (live.stage, live.look):
        drawing.redraw()
    return _TICK if failure is None and live.busy else None


def stop() -> None:
    """Ends the timer, when the add-on is switched off."""
    if bpy.app.timers.is_registered(_tick):
        bpy.app.timers.unregister(_tick)
