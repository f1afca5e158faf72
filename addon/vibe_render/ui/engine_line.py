# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the engine is, in one line of the panel and of the preferences."""

from __future__ import annotations

from pathlib import Path

import bpy

from ..run.engine_state import engine_state


def draw(layout: bpy.types.UILayout) -> None:
    """One line about where the engine is, or how its setup goes."""
    setup = engine_state.setup
    if setup and setup.running:
        row = layout.row(align=True)
        row.progress(factor=setup.fraction or 0.0, text=setup.text)
        row.operator("vibe.cancel_setup", text="", icon="X")
    elif engine_state.testing:
        layout.label(text="Starting the engine to see whether it answers…", icon="TIME")
    elif engine_state.searching:
        layout.label(text="Looking for the engine…", icon="TIME")
    elif engine_state.python:
        layout.label(text=f"Found: {_short(engine_state.python)}", icon="CHECKMARK")
    else:
        layout.label(text="Not found on this computer", icon="INFO")


def _short(python: Path) -> str:
    """The environment that a Python is in, from the user's home."""
    folder = python.parent.parent
    home = Path.home()
    return f"~/{folder.relative_to(home)}" if folder.is_relative_to(home) else str(folder)
