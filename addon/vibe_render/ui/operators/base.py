# SPDX-License-Identifier: GPL-3.0-or-later
# mypy: disable-error-code="valid-type"
"""Base classes of the preset panel's buttons: when they are grayed out, how failures are reported, dialogs."""

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
from ...run.state import addon_state


class VibePresets(bpy.types.PropertyGroup):
    """The fields of the preset panel; they belong to the window."""

    search: StringProperty(
        name="Search",
        description="Words of a preset's name or prompt",
        options={"TEXTEDIT_UPDATE", "SKIP_SAVE"},
    )
    chosen: StringProperty(description="The file of the chosen preset")
    rest: StringProperty(description="What did not fit of the last one, in lines")


class IdleOperator(bpy.types.Operator):
    """An operator that waits until no vibe runs. A failure is one line, and leaves everything as it was."""

    severity = "INFO"  # of the closing message

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Grayed out, with the reason, while there is an obstacle."""
        reason = "A vibe is on its way" if addon_state.running else cls.obstacle(context)
        if reason:
            cls.poll_message_set(reason)
        return not reason

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        """Why it cannot run now, apart from a vibe that runs; "" if it can."""
        return ""

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Does it."""
        try:
            with _waiting(context):
                message = self.act(context)
        except (schema.VibeError, OSError) as error:
            if isinstance(error, OSError):  # from a temporary file
                error = files.unwritable(Path(tempfile.gettempdir(), "vibe"), error, "Check that folder.")
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for area in context.screen.areas if context.screen else ():
            area.tag_redraw()
        self.report({self.severity}, message)
        return {"FINISHED"}

    def act(self, context: bpy.types.Context) -> str:
        """Does the work.

        Returns:
            The closing message.

        Raises:
            VibeError: It cannot be done; nothing has changed.
        """
        raise NotImplementedError


@contextmanager
def _waiting(context: bpy.types.Context) -> Iterator[None]:
    """Shows the mouse pointer of a busy Blender."""
    if context.window is None:
        yield
        return
    context.window.cursor_modal_set("WAIT")
    try:
        yield
    finally:
        context.window.cursor_modal_restore()


class PresetOperator(IdleOperator):
    """An operator on a preset: a given one, or the chosen one."""

    path: StringProperty(
        options={"HIDDEN", "SKIP_SAVE"}, description="The preset's file; empty: the chosen one"
    )

    def look(self, context: bpy.types.Context) -> library.Look:
        """The preset; raises a VibeError if it is gone."""
        return library.at(self.path or context.window_manager.vibe_presets.chosen)


class OwnPresetOperator(PresetOperator):
    """An operator on one of the artist's own presets, not on a shipped one."""

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        """Says that none is chosen, or that it is a shipped one."""
        chosen = context.window_manager.vibe_presets.chosen
        if not chosen:
            return "Choose a preset first"
        return "It comes with Vibe Render" if Path(chosen).parent == library.SHIPPED else ""


class LookOperator(IdleOperator):
    """An operator on the look that the scene has now."""

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        """Says that the scene has none."""
        return "" if context.scene.vibe.changes else "Vibe the scene first, or apply a preset"


class NameDialog:
    """A dialog for a name; its field is active at once."""

    name: StringProperty(
        name="Name", description="What the preset is called in lists", maxlen=preset.LONGEST_NAME
    )

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the dialog."""
        layout: bpy.types.UILayout = self.layout  # type: ignore[attr-defined]
        layout.activate_init = True  # lost where labels are split off
        layout.prop(self, "name")


class FileDialog:
    """A file dialog without the column of options."""

    hide_props_region: BoolProperty(default=True, options={"HIDDEN", "SKIP_SAVE"})


class ExportDialog(FileDialog, ExportHelper):
    """A file dialog for saving, with a proposed name."""

    def propose(self, name: str, folder: str = "") -> None:
        """Proposes a file for a look.

        Args:
            folder: Where, if there was no dialog before; then it is the last one's folder.
        """
        if self.filepath:  # type: ignore[has-type]
            folder = str(Path(self.filepath).parent)  # type: ignore[has-type]
        self.filepath = str(library.path_for(Path(folder), name).with_suffix(self.filename_ext))
