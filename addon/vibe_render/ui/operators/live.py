# SPDX-License-Identifier: GPL-3.0-or-later
"""Keys while Live is on: Enter in the prompt begins the search, Esc takes the look away.

Blender tells no add-on how a text field was left, and the field takes the press of the key; its release is heard.
"""

from __future__ import annotations

from typing import Any, ClassVar

import bpy

from ...core import drawing
from ...run.state import addon_state

_ENTER, _ESC = ("RET", "NUMPAD_ENTER"), ("ESC",)
_keys: list[tuple[Any, Any]] = []


class VIBE_OT_entered(bpy.types.Operator):
    """Begin the search for the words that were typed"""

    bl_idname = "vibe.entered"
    bl_label = "Vibe It from the Prompt"
    bl_options: ClassVar[set[str]] = {"INTERNAL"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only over our panel, and only for words that nobody has searched for yet."""
        live = addon_state.live
        return bool(live and live.typing and _over_our_panel(context) and bpy.ops.vibe.run.poll())

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Begins."""
        bpy.ops.vibe.run("INVOKE_DEFAULT")
        return {"FINISHED"}


class VIBE_OT_escaped(bpy.types.Operator):
    """Take the look of what was typed out of the scene"""

    bl_idname = "vibe.escaped"
    bl_label = "Take the Look Away"
    bl_options: ClassVar[set[str]] = {"INTERNAL"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only over our panel, and only where there is one."""
        live = addon_state.live
        return bool(live and live.typing and not addon_state.running and _over_our_panel(context))

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Takes it away."""
        if addon_state.live:
            addon_state.live.clear()
        drawing.redraw()
        return {"FINISHED"}


def _over_our_panel(context: bpy.types.Context) -> bool:
    return context.region is not None and context.region.active_panel_category == "Vibe"


def register_keys() -> None:
    """Listens for the keys."""
    config = bpy.context.window_manager.keyconfigs.addon
    if config is None:  # without a window
        return
    keymap = config.keymaps.new(name="User Interface")
    for operator, keys in (("vibe.entered", _ENTER), ("vibe.escaped", _ESC)):
        for key in keys:
            _keys.append((keymap, keymap.keymap_items.new(operator, key, "RELEASE")))


def unregister_keys() -> None:
    """Inverse of `register_keys`."""
    for keymap, item in _keys:
        keymap.keymap_items.remove(item)
    _keys.clear()


CLASSES = (VIBE_OT_entered, VIBE_OT_escaped)
