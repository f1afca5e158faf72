# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps the readings of the prompt's words up with what is typed, by a timer: a panel that draws must not change anything."""

from __future__ import annotations

import contextlib

import bpy

from ..core import drawing
from ..core.schema_import import schema
from ..run.state import addon_state

_TICK = 0.02  # seconds between two looks at what the engine says


def keep_up(context: bpy.types.Context) -> None:
    """Has new words read, where an engine runs already; a panel may call this whenever it is drawn."""
    due = addon_state.readings.due(context.scene, addon_state.live_job(context.scene))
    if due and addon_state.engine_runs and not bpy.app.timers.is_registered(_tick):
        bpy.app.timers.register(_tick, first_interval=0.0)


def _tick() -> float | None:
    context, readings = bpy.context, addon_state.readings
    if addon_state.running or not addon_state.engine_runs:
        readings.forget()
        return None
    with contextlib.suppress(schema.VibeError):  # the next vibe says why the engine is gone
        if readings.step(addon_state.engine(context), context.scene, addon_state.live_job(context.scene)):
            drawing.redraw()
    return _TICK if readings.due(context.scene, addon_state.live_job(context.scene)) else None


def stop() -> None:
    """Ends the timer, when the add-on is switched off."""
    if bpy.app.timers.is_registered(_tick):
        bpy.app.timers.unregister(_tick)
