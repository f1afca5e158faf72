# SPDX-License-Identifier: GPL-3.0-or-later
"""What the add-on does when Blender opens another file."""

from __future__ import annotations

import bpy
from bpy.app.handlers import persistent

from ..session.state import addon_state


@persistent
def _before_load(*_: object) -> None:
    """A vibe belongs to its file: it ends before Blender opens another, and its pictures go."""
    addon_state.cancel()


def register() -> None:
    """Adds our handler to Blender's."""
    bpy.app.handlers.load_pre.append(_before_load)


def unregister() -> None:
    """Inverse of `register`."""
    bpy.app.handlers.load_pre.remove(_before_load)
