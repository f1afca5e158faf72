# SPDX-License-Identifier: GPL-3.0-or-later
# mypy: disable-error-code="valid-type"
"""The buttons that export the scene's present look: as assets, and its grade as a LUT."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import bpy
from bpy.props import StringProperty
from bpy_extras.io_utils import ExportHelper

from ...core.schema_import import preset, schema
from ...export import reading
from ...looks import assets, lut, thumbnail, use
from .base import ExportDialog, IdleOperator, LookOperator


class VIBE_OT_export_assets(LookOperator, ExportDialog):
    """Save materials, world, lights and grade of the look that the scene has now, for the Asset Browser"""

    bl_idname = "vibe.export_assets"
    bl_label = "Export as Assets"

    filename_ext = ".blend"
    filter_glob: StringProperty(default="*.blend", options={"HIDDEN"})

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Asks where; proposes the first asset library."""
        libraries = context.preferences.filepaths.asset_libraries
        self.propose(_name(context), libraries[0].path if libraries else "")
        return ExportHelper.invoke(self, context, event)

    def act(self, context: bpy.types.Context) -> str:
        """Writes them."""
        scene = context.scene
        settings = scene.vibe
        settings.show_original = False
        keys = [schema.split_key(change.name) for change in settings.changes]
        names = dict.fromkeys(owner for group, owner, _ in keys if group == "material")
        materials = {material.name_full: material for material in bpy.data.materials}
        analysis = reading.read_scene(scene, settings.choice()).analysis
        with tempfile.TemporaryDirectory(prefix="vibe-") as folder:
            picture = Path(folder) / f"picture{thumbnail.SUFFIX}"
            thumbnail.render_thumbnail(scene, picture)
            written = assets.export_assets(
                analysis,
                _name(context),
                settings.vibed_prompt,
                [materials[name] for name in names if name in materials],
                Path(self.filepath),
                picture,
            )
        return f"{len(written)} assets are in {self.filepath}"


class VIBE_OT_export_lut(IdleOperator, ExportDialog):
    """Save the scene's color grade as a .cube file for other programs: sRGB in, sRGB out"""

    bl_idname = "vibe.export_lut"
    bl_label = "Export LUT"

    filename_ext = ".cube"
    filter_glob: StringProperty(default="*.cube", options={"HIDDEN"})

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        """Says that nothing is graded."""
        graded = use.grade_values(context.scene)
        colors = {name: value for name, value in graded.items() if name not in lut.LEFT_OUT}
        neutral = lut.neutral_grade()
        same = all(value == neutral[name] for name, value in colors.items())
        return "The scene's colors are not graded" if same else ""

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Asks where."""
        self.propose(_name(context))
        return ExportHelper.invoke(self, context, event)

    def act(self, context: bpy.types.Context) -> str:
        """Writes it; the message names what a LUT cannot hold."""
        values = use.grade_values(context.scene)
        lut.write_cube(Path(self.filepath), _name(context), values)
        neutral = lut.neutral_grade()
        rest = [name for name in lut.LEFT_OUT if values.get(name, neutral[name]) != neutral[name]]
        return f"Written: {self.filepath}" + (f", without {' and '.join(rest)}" if rest else "")


def _name(context: bpy.types.Context) -> str:
    settings: Any = context.scene.vibe
    return settings.vibed_preset or preset.title(settings.vibed_prompt) or context.scene.name


CLASSES = (VIBE_OT_export_assets, VIBE_OT_export_lut)
