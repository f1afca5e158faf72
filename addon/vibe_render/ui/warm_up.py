# SPDX-License-Identifier: GPL-3.0-or-later
"""The engine starts when a panel of ours is first seen, so that it is warm when it is needed."""

from __future__ import annotations

import bpy

from ..run.engine_state import engine_state
from ..run.state import addon_state

_SOON = 0.5  # seconds after the panel is drawn; also between two looks at whether the engine has been found
_begun = False


def begin_soon() -> None:
    """Starts the engine, once, as soon as it is found; a panel may call this whenever it is drawn."""
    global _begun
    if not _begun:
        _begun = True
        bpy.app.timers.register(_begin, first_interval=_SOON)


def _begin() -> float | None:
    """A timer: starting a process while something is drawn would hold that up."""
    if engine_state.searching:
        return _SOON
    if engine_state.python:
        addon_state.warm_up(bpy.context)
    return None


def forget() -> None:
    """Lets the next panel start an engine anew, when the add-on is switched off."""
    global _begun
    _begun = False
    if bpy.app.timers.is_registered(_begin):
        bpy.app.timers.unregister(_begin)
