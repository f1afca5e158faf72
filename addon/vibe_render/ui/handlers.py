# SPDX-License-Identifier: GPL-3.0-or-later
"""What the add-on does when Blender opens another file."""

from __future__ import annotations

import bpy
from bpy.app.handlers import persistent

from ..run import preview
from ..run.state import addon_state


@persistent
def _before_load(*_: object) -> None:
    """A vibe belongs to its file: it ends before Blender opens another, and its pictures go."""
    addon_state.cancel()
    addon_state.end_live()


@persistent
def _before_save(*_: object) -> None:
    """A file holds the artist's values, not a preview."""
    preview.hide_all()


@persistent
def _show_again(*_: object) -> None:
    """After a save or an undo the scene shows the look of the vibe that runs, or of what is typed, and no other."""
    preview.hide_all()
    if addon_state.running and addon_state.session:
        addon_state.session.show_again()
    elif addon_state.live:
        addon_state.live.show_again()


@persistent
def _after_change(_scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    changed = [update.id.original for update in depsgraph.updates]
    addon_state.readings.scene_changed(changed)
    if addon_state.live:
        addon_state.live.scene_changed(changed)


_HANDLERS = {
    "load_pre": _before_load,
    "load_post": _show_again,
    "save_pre": _before_save,
    "save_post": _show_again,
    "save_post_fail": _show_again,
    "undo_post": _show_again,
    "redo_post": _show_again,
    "depsgraph_update_post": _after_change,
}


def register() -> None:
    """Adds our handlers to Blender's."""
    for name, handler in _HANDLERS.items():
        getattr(bpy.app.handlers, name).append(handler)


def unregister() -> None:
    """Inverse of `register`."""
    for name, handler in _HANDLERS.items():
        getattr(bpy.app.handlers, name).remove(handler)
