# SPDX-License-Identifier: GPL-3.0-or-later
# mypy: disable-error-code="valid-type"
"""The buttons of the preset panel: choose, apply, save, rename, delete, import and export."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import ClassVar

import bpy
from bpy.props import CollectionProperty, StringProperty
from bpy_extras.io_utils import ExportHelper, ImportHelper

from ...core.schema_import import preset, schema
from ...looks import library, thumbnail, use
from ...run.state import addon_state
from ...scene.scene_context import GEOMETRY
from ..obstacles import untouchable
from .base import (
    ExportDialog,
    FileDialog,
    IdleOperator,
    LookOperator,
    NameDialog,
    OwnPresetOperator,
    PresetOperator,
    VibePresets,
)


class VIBE_OT_preset_choose(bpy.types.Operator):
    """Choose this preset"""

    bl_idname = "vibe.preset_choose"
    bl_label = "Choose Preset"
    bl_options: ClassVar[set[str]] = {"INTERNAL"}

    path: StringProperty()

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        """What was typed for it, as a tool tip."""
        try:
            look = library.at(properties.path)
        except schema.VibeError as error:
            return str(error)
        return look.problem or (f"“{look.prompt}”" if look.prompt else look.name)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Shows it below the grid."""
        context.window_manager.vibe_presets.chosen = self.path
        return {"FINISHED"}


class VIBE_OT_preset_apply(PresetOperator):
    """Give the scene this look. Strength, Before, Keep and Revert work as after a vibe"""

    bl_idname = "vibe.preset_apply"
    bl_label = "Apply"
    bl_options: ClassVar[set[str]] = {"UNDO"}

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        """Says that the scene has no mesh."""
        there = any(obj.type in GEOMETRY for obj in context.scene.objects)
        return untouchable(context) if there else "The scene has no mesh"

    def act(self, context: bpy.types.Context) -> str:
        """Applies it; the panel lists what did not fit.

        Raises:
            VibeError: The preset is gone or broken, or nothing in the scene takes what it holds.
        """
        look = self.look(context)
        if look.preset is None:
            raise schema.VibeError(look.problem, "Delete it, or correct the file.")
        rest = use.apply(context.scene, look.preset, context.scene.vibe.choice())
        addon_state.forget()  # its pictures and variants are not of this look
        window_state = context.window_manager.vibe_presets
        window_state.chosen, window_state.rest = str(look.path), "\n".join(rest)
        left = (
            f"; {len(rest)} things did not fit"
            if len(rest) > 1
            else "; one thing did not fit"
            if rest
            else ""
        )
        return f"{look.name} is in the scene{left}"


class VIBE_OT_preset_save(NameDialog, LookOperator):
    """Save the look that the scene has now as a preset, with a picture of it"""

    bl_idname = "vibe.preset_save"
    bl_label = "Save Preset"

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Asks for a name."""
        settings = context.scene.vibe
        first = settings.vibed_prompt.partition(",")[0]  # short, for the grid; the rest is its prompt
        self.name = settings.vibed_preset or preset.title(first[:1].upper() + first[1:])
        return context.window_manager.invoke_props_dialog(self, width=340, confirm_text="Save")

    def act(self, context: bpy.types.Context) -> str:
        """Saves it; the picture is a small render."""
        scene = context.scene
        look = use.capture(scene, scene.vibe.choice(), self.name)
        with tempfile.TemporaryDirectory(prefix="vibe-") as folder:
            picture = Path(folder) / f"picture{thumbnail.SUFFIX}"
            thumbnail.render(scene, picture)
            saved = library.save(look, picture)
        context.window_manager.vibe_presets.chosen = str(saved.path)
        return f"Saved as {saved.name}"


class VIBE_OT_preset_rename(NameDialog, OwnPresetOperator):
    """Give this preset another name"""

    bl_idname = "vibe.preset_rename"
    bl_label = "Rename Preset"

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Asks for a name."""
        try:
            self.name = self.look(context).name
        except schema.VibeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return context.window_manager.invoke_props_dialog(self, width=340, confirm_text="Rename")

    def act(self, context: bpy.types.Context) -> str:
        """Renames it."""
        renamed = library.rename(self.look(context), self.name)
        context.window_manager.vibe_presets.chosen = str(renamed.path)
        return f"Renamed to {renamed.name}"


class VIBE_OT_preset_delete(OwnPresetOperator):
    """Delete this preset and its picture"""

    bl_idname = "vibe.preset_delete"
    bl_label = "Delete Preset"

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Asks for confirmation."""
        try:
            name = self.look(context).name
        except schema.VibeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return context.window_manager.invoke_confirm(
            self, event, title="Delete Preset", message=f"{name} will be gone for good.", confirm_text="Delete",
            icon="WARNING",
        )  # fmt: skip

    def act(self, context: bpy.types.Context) -> str:
        """Deletes it."""
        look = self.look(context)
        library.delete(look)
        context.window_manager.vibe_presets.chosen = ""
        return f"{look.name} is deleted"


class VIBE_OT_preset_import(IdleOperator, FileDialog, ImportHelper):
    """Copy preset files into your presets. Nothing in them is ever run"""

    bl_idname = "vibe.preset_import"
    bl_label = "Import Presets"

    filename_ext = ".json"
    filter_glob: StringProperty(default="*.json", options={"HIDDEN"})
    directory: StringProperty(subtype="DIR_PATH", options={"HIDDEN", "SKIP_SAVE"})
    files: CollectionProperty(type=bpy.types.OperatorFileListElement, options={"HIDDEN", "SKIP_SAVE"})

    def act(self, context: bpy.types.Context) -> str:
        """Imports every file that can be; one message names the others.

        Raises:
            VibeError: No file was chosen, or none can be imported.
        """
        paths = [Path(self.directory) / file.name for file in self.files if file.name] or [
            Path(self.filepath)
        ]
        if paths[0].is_dir():
            raise schema.VibeError("No file was chosen.", "Choose preset files.")
        brought, wrong = [], []
        for path in paths:
            try:
                brought.append(library.bring(path))
            except schema.VibeError as error:
                wrong.append((path.name, error))
        bad = "Left out: " + "; ".join(f"{name} ({error.message.rstrip('.')})" for name, error in wrong)
        if not brought:
            raise wrong[0][1] if len(wrong) == 1 else schema.VibeError(f"{bad}.", "Choose preset files.")
        context.window_manager.vibe_presets.chosen = str(brought[-1].path)
        summary = f"{brought[0].name} is" if len(brought) == 1 else f"{len(brought)} presets are"
        summary += " among your presets"
        if wrong:
            self.severity = "WARNING" if bpy.app.background else "ERROR"  # a pop-up; it would stop a script
        return f"{summary}. {bad}" if wrong else summary


class VIBE_OT_preset_export(PresetOperator, ExportDialog):
    """Save this preset and its picture as files, to pass on"""

    bl_idname = "vibe.preset_export"
    bl_label = "Export Preset"

    filename_ext = ".json"
    filter_glob: StringProperty(default="*.json", options={"HIDDEN"})

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Asks where."""
        try:
            self.propose(self.look(context).name)
        except schema.VibeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return ExportHelper.invoke(self, context, event)

    def act(self, context: bpy.types.Context) -> str:
        """Writes it."""
        library.export(self.look(context), Path(self.filepath))
        return f"Written: {self.filepath}"


CLASSES = (
    VibePresets,
    VIBE_OT_preset_choose,
    VIBE_OT_preset_apply,
    VIBE_OT_preset_save,
    VIBE_OT_preset_rename,
    VIBE_OT_preset_delete,
    VIBE_OT_preset_import,
    VIBE_OT_preset_export,
)
