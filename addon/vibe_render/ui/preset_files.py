# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks as files: import and export of presets, export of the scene's look as assets and of its grade as a LUT."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy
from bpy.props import BoolProperty, CollectionProperty, StringProperty
from bpy_extras.io_utils import ExportHelper, ImportHelper

from ..core.schema_import import preset, schema
from ..export import reading
from ..looks import assets, library, lut, thumbnail, transfer
from .bases import IdleOperator
from .presets import LookOperator, PresetOperator


class _FileDialog:
    """A file dialog without the column of options."""

    hide_props_region: BoolProperty(default=True, options={"HIDDEN", "SKIP_SAVE"})


class _ExportDialog(_FileDialog, ExportHelper):
    """A file dialog for saving, with a proposed name."""

    def propose(self, context: bpy.types.Context, event: bpy.types.Event, name: str, folder: str = "") -> set[str]:
        """Proposes a file for a look, in the last dialog's folder, or else in the given one."""
        if self.filepath:  # type: ignore[has-type]
            folder = str(Path(self.filepath).parent)  # type: ignore[has-type]
        self.filepath = str(library.path_for(Path(folder), name).with_suffix(self.filename_ext))
        return ExportHelper.invoke(self, context, event)


class VIBE_OT_preset_import(IdleOperator, _FileDialog, ImportHelper):
    """Copy preset files into your presets. Nothing in them is ever run"""

    bl_label = "Import Presets"

    filename_ext = ".json"
    filter_glob: StringProperty(default="*.json", options={"HIDDEN"})
    directory: StringProperty(subtype="DIR_PATH", options={"HIDDEN", "SKIP_SAVE"})
    files: CollectionProperty(type=bpy.types.OperatorFileListElement, options={"HIDDEN", "SKIP_SAVE"})

    def perform(self, context: bpy.types.Context) -> str:
        """Imports every file that is a preset; one message names the others."""
        paths = [Path(self.directory) / file.name for file in self.files if file.name]
        paths = paths or [Path(self.filepath)]
        if paths[0].is_dir():
            raise schema.VibeError("No file was chosen.", "Choose preset files.")
        brought, wrong = [], []
        for path in paths:
            try:
                brought.append(library.import_preset(path))
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


class VIBE_OT_preset_export(PresetOperator, _ExportDialog):
    """Save this preset and its picture as files, to pass on"""

    bl_label = "Export Preset"

    filename_ext = ".json"
    filter_glob: StringProperty(default="*.json", options={"HIDDEN"})

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        return self.propose(context, event, self.look(context).name)

    def perform(self, context: bpy.types.Context) -> str:
        library.export_preset(self.look(context), Path(self.filepath))
        return f"Written: {self.filepath}"


class VIBE_OT_export_assets(LookOperator, _ExportDialog):
    """Save materials, world, lights and grade of the look that the scene has now, for the Asset Browser"""

    bl_label = "Export as Assets"

    filename_ext = ".blend"
    filter_glob: StringProperty(default="*.blend", options={"HIDDEN"})

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Asks where; proposes the first asset library."""
        libraries = context.preferences.filepaths.asset_libraries
        return self.propose(context, event, _name(context), libraries[0].path if libraries else "")

    def perform(self, context: bpy.types.Context) -> str:
        scene = context.scene
        settings = scene.vibe
        settings.show_original = False
        keys = [schema.split_key(change.name) for change in settings.changes]
        names = dict.fromkeys(owner for group, owner, _ in keys if group == "material")
        materials = {material.name_full: material for material in bpy.data.materials}
        analysis = reading.read_scene(scene, settings.choice()).analysis
        with thumbnail.rendered_thumbnail(scene) as picture:
            written = assets.export_assets(
                analysis,
                _name(context),
                settings.vibed_prompt,
                [materials[name] for name in names if name in materials],
                Path(self.filepath),
                picture,
            )
        return f"{len(written)} assets are in {self.filepath}"


class VIBE_OT_export_lut(IdleOperator, _ExportDialog):
    """Save the scene's color grade as a .cube file for other programs: sRGB in, sRGB out"""

    bl_label = "Export LUT"

    filename_ext = ".cube"
    filter_glob: StringProperty(default="*.cube", options={"HIDDEN"})

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        graded, neutral = transfer.grade_values(context.scene), lut.neutral_grade()
        same = all(value == neutral[name] for name, value in graded.items() if name not in lut.LEFT_OUT)
        return "The scene's colors are not graded" if same else ""

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        return self.propose(context, event, _name(context))

    def perform(self, context: bpy.types.Context) -> str:
        """Writes the file; the message names effects of the grade that a LUT cannot store."""
        values = transfer.grade_values(context.scene)
        lut.write_cube(Path(self.filepath), _name(context), values)
        neutral = lut.neutral_grade()
        rest = [name for name in lut.LEFT_OUT if values.get(name, neutral[name]) != neutral[name]]
        return f"Written: {self.filepath}" + (f", without {' and '.join(rest)}" if rest else "")


def _name(context: bpy.types.Context) -> str:
    settings: Any = context.scene.vibe
    return settings.vibed_preset or preset.title(settings.vibed_prompt) or context.scene.name
