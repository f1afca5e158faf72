# SPDX-License-Identifier: GPL-3.0-or-later
# mypy: disable-error-code="valid-type"
"""What the preset panel's buttons have in common: when they are greyed out, and how a failure is said."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import bpy
from bpy.props import BoolProperty, StringProperty
from bpy_extras.io_utils import ExportHelper

from ...core import files
from ...core.schema_import import preset, schema
from ...looks import library
from ...session.state import addon_state


class VibePresets(bpy.types.PropertyGroup):
    """What the preset panel holds, kept with the window."""

    search: StringProperty(
        name="Search",
        description="Words of a preset's name or prompt",
        options={"TEXTEDIT_UPDATE", "SKIP_SAVE"},
    )
    chosen: StringProperty(description="The file of the chosen preset")
    rest: StringProperty(description="What did not fit of the last one, in lines")


class IdleOperator(bpy.types.Operator):
    """For what must wait until a vibe is over; a failure is one line, and leaves everything as it was."""

    severity = "INFO"  # of what is said in the end

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Greyed out, with the reason, while there is an obstacle."""
        reason = "A vibe is on its way" if addon_state.running else cls.obstacle(context)
        if reason:
            cls.poll_message_set(reason)
        return not reason

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        """What else is in the way; "" if nothing is."""
        return ""

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Does it."""
        try:
            with _waiting(context):
                message = self.act(context)
        except (schema.VibeError, OSError) as error:
            if isinstance(error, OSError):  # what we write for a moment only
                error = files.unwritable(Path(tempfile.gettempdir(), "vibe"), error, "Check that folder.")
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for area in context.screen.areas if context.screen else ():
            area.tag_redraw()
        self.report({self.severity}, message)
        return {"FINISHED"}

    def act(self, context: bpy.types.Context) -> str:
        """The work; returns what to say of it."""
        raise NotImplementedError


@contextmanager
def _waiting(context: bpy.types.Context) -> Iterator[None]:
    """The mouse pointer says that Blender is busy."""
    if context.window is None:
        yield
        return
    context.window.cursor_modal_set("WAIT")
    try:
        yield
    finally:
        context.window.cursor_modal_restore()


class PresetOperator(IdleOperator):
    """For what is done with the chosen preset."""

    path: StringProperty(
        options={"HIDDEN", "SKIP_SAVE"}, description="The preset's file; empty: the chosen one"
    )

    def look(self, context: bpy.types.Context) -> library.Look:
        """The preset; raises VibeError where it is gone."""
        return library.at(self.path or context.window_manager.vibe_presets.chosen)


class OwnPresetOperator(PresetOperator):
    """For what cannot be done with the presets that come with Vibe Render."""

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        """Says whose preset it is."""
        chosen = context.window_manager.vibe_presets.chosen
        if not chosen:
            return "Choose a preset first"
        return "It comes with Vibe Render" if Path(chosen).parent == library.SHIPPED else ""


class LookOperator(IdleOperator):
    """For what is done with the look that the scene has now."""

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        """Says that there is none."""
        return "" if context.scene.vibe.changes else "Vibe the scene first, or apply a preset"


class NameDialog:
    """A dialog for a name, which can be typed at once."""

    name: StringProperty(
        name="Name", description="What the preset is called in lists", maxlen=preset.LONGEST_NAME
    )

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the dialog."""
        layout: bpy.types.UILayout = self.layout  # type: ignore[attr-defined]
        layout.activate_init = True  # lost where labels are split off
        layout.prop(self, "name")


class FileDialog:
    """A file dialog without the column for options: there are none."""

    hide_props_region: BoolProperty(default=True, options={"HIDDEN", "SKIP_SAVE"})


class ExportDialog(FileDialog, ExportHelper):
    """A file dialog that proposes a name."""

    def propose(self, name: str, folder: str = "") -> None:
        """Proposes a file for a look of this name, in the folder of the last one."""
        if self.filepath:  # type: ignore[has-type]
            folder = str(Path(self.filepath).parent)  # type: ignore[has-type]
        self.filepath = str(library.path_for(Path(folder), name).with_suffix(self.filename_ext))
