# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts that operators and panels share: reasons for grayed-out buttons, as tooltips, and base classes."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import ClassVar

import bpy

from ..core import files
from ..core.rendered import GEOMETRY
from ..core.schema_import import schema
from ..run.state import addon_state
from ..scene import snapshot
from . import drawing

RUNNING = "A vibe is running"
HELD = "Your own keyframes are set aside. Keep moves them with the look"


def untouchable(context: bpy.types.Context) -> str:
    """The reason why the scene must not be changed now; "" if it may be."""
    if not context.scene.is_editable:
        return "This scene is linked from a library"
    if context.mode != "OBJECT":  # in other modes, undo takes back only that mode's own steps
        return "Switch to Object Mode"
    return ""


def has_mesh(scene: bpy.types.Scene) -> bool:
    """True if the scene has a mesh, curve, text or other object with a surface."""
    return any(obj.type in GEOMETRY for obj in scene.objects)


class IdlePanel:
    """A panel that is closed at first, and hidden while a vibe runs."""

    bl_options: ClassVar[set[str]] = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return not addon_state.running


class Operator(bpy.types.Operator):
    """An operator whose tooltip gives the reason if it is grayed out, and which reports a failure in one line.

    Its `bl_idname` follows from the name of its class: "vibe.revert" for VIBE_OT_revert. The class arguments are its
    `bl_label` and its `bl_options`, if they are not those of its base class.
    """

    severity = "INFO"  # of the closing message
    idle = False  # grayed out while a vibe runs, with a wait cursor while it works

    def __init_subclass__(cls, label: str = "", options: set[str] | None = None) -> None:
        super().__init_subclass__()
        cls.bl_idname, cls.bl_label = cls.__name__.lower().replace("_ot_", "."), label
        if options is not None:
            cls.bl_options = options

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        reason = RUNNING if cls.idle and addon_state.running else cls.obstacle(context)
        if reason:
            cls.poll_message_set(reason)  # its tooltip
        return not reason

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        """The reason why the operator cannot run now; "" if it can."""
        return ""

    def execute(self, context: bpy.types.Context) -> set[str]:
        window = context.window if self.idle else None
        if window:
            window.cursor_modal_set("WAIT")
        try:
            message = self.perform(context)
        except (schema.VibeError, OSError) as error:
            if isinstance(error, OSError):  # from a temporary file
                error = files.unwritable(Path(tempfile.gettempdir(), "vibe"), error, "Check that folder.")
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        finally:
            if window:
                window.cursor_modal_restore()
        drawing.redraw()
        if message:
            self.report({self.severity}, message)
        return {"FINISHED"}

    def perform(self, context: bpy.types.Context) -> str | None:
        """Does the work, and returns the closing message, if any; after a VibeError nothing has changed."""
        raise NotImplementedError


class ResultOperator(Operator, options={"UNDO"}):
    """An operator on the result that the scene has."""

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        if addon_state.running:
            return RUNNING
        return untouchable(context) if snapshot.exists(context.scene) else "This scene has no result"


class IdleOperator(Operator):
    """An operator that is grayed out while a vibe runs, and shows a wait cursor while it works."""

    idle = True
