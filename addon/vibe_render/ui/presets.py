# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets in the "Vibe" tab: a grid of images to choose from, the chosen preset, actions on it; looks as files."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

import bpy
from bpy.props import BoolProperty, CollectionProperty, StringProperty
from bpy_extras.io_utils import ExportHelper, ImportHelper

from ..core.schema_import import preset, schema
from ..export import reading
from ..looks import assets, library, lut, thumbnail, transfer
from ..run.state import addon_state
from .bases import IdleOperator, IdlePanel, Operator, has_mesh, untouchable
from .drawing import caption, look_icon, paragraph

_WIDTH, _COLUMNS = 36, 6  # of the grid; the width in Blender's units (the height of a button)
_LETTERS = 98  # characters in a line of text below the grid
_SHOWN = 5  # most lines that are shown on values that did not fit


class VibePresets(bpy.types.PropertyGroup):
    """The fields of the preset panel, kept in the window manager, not in the scene."""

    search: StringProperty(
        name="Search", description="Words of a preset's name or prompt", options={"TEXTEDIT_UPDATE", "SKIP_SAVE"}
    )
    chosen: StringProperty(description="The file of the chosen preset")
    rest: StringProperty(description="What did not fit of the last one, in lines")


class VIBE_MT_preset(bpy.types.Menu):
    """Actions on the chosen preset."""

    bl_label = "Preset"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.operator_context = "INVOKE_DEFAULT"
        layout.operator("vibe.preset_rename", text="Rename…", icon="GREASEPENCIL")
        layout.operator("vibe.preset_export", text="Export…", icon="EXPORT")
        layout.separator()
        layout.operator("vibe.preset_delete", text="Delete…", icon="TRASH")


class VIBE_MT_presets(bpy.types.Menu):
    """Actions on all presets, and on the look that the scene has now."""

    bl_label = "Presets"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.operator_context = "INVOKE_DEFAULT"
        layout.operator("vibe.preset_import", text="Import…", icon="IMPORT")
        if (folder := library.preset_folder()).is_dir():
            layout.operator("wm.path_open", text="Open Folder", icon="FILE_FOLDER").filepath = str(folder)
        layout.separator()
        layout.operator("vibe.export_assets", text="Export Look as Assets…", icon="ASSET_MANAGER")
        layout.operator("vibe.export_lut", text="Export Grade as LUT…", icon="COLOR")


class PresetsPanel(IdlePanel):
    """The chosen preset, and the button that shows all of them."""

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        self.layout.menu("VIBE_MT_presets", text="", icon="COLLAPSEMENU")  # type: ignore[attr-defined]

    def draw(self, context: bpy.types.Context) -> None:
        layout: bpy.types.UILayout = self.layout  # type: ignore[attr-defined]
        layout.popover("VIBE_PT_preset_grid", text="Browse Presets…", icon="ASSET_MANAGER")
        if look := _chosen(context):
            layout.template_icon(icon_value=look_icon(look), scale=6.0)
            _draw_chosen(layout, context, look)


class VIBE_PT_preset_grid(bpy.types.Panel):
    """All presets as pictures, with search; below them the chosen one."""

    bl_label = "Browse Presets"
    bl_space_type = "VIEW_3D"
    bl_region_type = "HEADER"
    bl_options: ClassVar[set[str]] = {"INSTANCED"}
    bl_ui_units_x = _WIDTH

    def draw(self, context: bpy.types.Context) -> None:
        layout, window_state = self.layout, context.window_manager.vibe_presets
        layout.prop(window_state, "search", text="", icon="VIEWZOOM", placeholder="Search names and prompts")
        shown = library.all_looks(window_state.search)
        grid = layout.grid_flow(row_major=True, columns=_COLUMNS, even_columns=True, even_rows=True)
        for look in shown:
            cell = grid.column(align=True)
            cell.template_icon(icon_value=look_icon(look), scale=_WIDTH / _COLUMNS - 1.0)
            picked = str(look.path) == window_state.chosen
            row = cell.row(align=True)
            row.operator("vibe.preset_choose", text=look.name, depress=picked).path = str(look.path)
            row.operator("vibe.preset_apply", text="", icon="SHADERFX").path = str(look.path)
        for _ in range(-len(shown) % _COLUMNS if len(shown) < _COLUMNS else 0):  # images keep their size
            grid.label(text="")
        if not shown:
            caption(layout, "No preset has these words")
        elif chosen := _chosen(context):
            _draw_chosen(layout, context, chosen, _LETTERS)
        else:
            caption(layout, "Click a name to read more, or the button next to it to apply the look")


def _chosen(context: bpy.types.Context) -> library.Look | None:
    path = context.window_manager.vibe_presets.chosen
    return next((look for look in library.all_looks() if str(look.path) == path), None) if path else None


def _draw_chosen(layout: bpy.types.UILayout, context: bpy.types.Context, look: library.Look, letters: int = 0) -> None:
    """Draws a preset's name, prompt and Apply button in a box; `letters` as for `paragraph`."""
    box = layout.box()
    row = box.row()
    row.label(text=look.name, icon="ERROR" if look.problem else "NONE")
    row.menu("VIBE_MT_preset", text="", icon="DOWNARROW_HLT")
    if look.problem:
        paragraph(box, context, look.problem, letters=letters)
        return
    if look.prompt:
        paragraph(box, context, f"“{look.prompt}”", faint=True, letters=letters)
    row = box.row()
    row.scale_y = 1.4
    applied = context.scene.vibe.vibed_preset == look.name
    row.operator("vibe.preset_apply", text="Apply Again" if applied else "Apply", icon="SHADERFX")
    rest = context.window_manager.vibe_presets.rest.splitlines() if applied else []
    lines = [f"Did not fit: {line}" for line in rest[:_SHOWN]]
    lines += [f"… and {len(rest) - _SHOWN} more"] if len(rest) > _SHOWN else []
    for line in lines:
        paragraph(box, context, line, faint=True, letters=letters)


class _PresetOperator(IdleOperator):
    """An operator on the preset at `path`, or on the chosen preset if `path` is empty."""

    path: StringProperty(options={"HIDDEN", "SKIP_SAVE"}, description="The preset's file; empty: the chosen one")

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        return "" if _chosen(context) else "Choose a preset first"

    def look(self, context: bpy.types.Context) -> library.Look:
        return library.preset_at(self.path or context.window_manager.vibe_presets.chosen)


class _LookOperator(IdleOperator):
    """An operator on the look that the scene has now."""

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        return "" if context.scene.vibe.changes else "Vibe the scene first, or apply a preset"


class _OwnPresetOperator(_PresetOperator):
    """An operator on one of the artist's own presets, not on a shipped one."""

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        look = _chosen(context)
        return "It comes with Vibe Render" if look and look.shipped else super().obstacle(context)


class _NameDialog:
    """A dialog that asks for a preset's name; the text field is active at once."""

    name: StringProperty(name="Name", description="What the preset is called in lists", maxlen=preset.LONGEST_NAME)

    def draw(self, context: bpy.types.Context) -> None:
        layout: bpy.types.UILayout = self.layout  # type: ignore[attr-defined]
        layout.activate_init = True  # lost where labels are split off
        layout.prop(self, "name")


class VIBE_OT_preset_choose(Operator, label="Choose Preset", options={"INTERNAL"}):
    """Choose this preset"""

    path: StringProperty()

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        try:
            look = library.preset_at(properties.path)
        except schema.VibeError as error:
            return str(error)
        return look.problem or (f"“{look.prompt}”" if look.prompt else look.name)

    def perform(self, context: bpy.types.Context) -> None:
        context.window_manager.vibe_presets.chosen = self.path


class VIBE_OT_preset_apply(_PresetOperator, label="Apply", options={"UNDO"}):
    """Give the scene this look. Strength, Before, Keep and Revert work as after a vibe"""

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        return untouchable(context) if has_mesh(context.scene) else "The scene has no mesh"

    def perform(self, context: bpy.types.Context) -> str:
        look = self.look(context)
        if look.preset is None:
            raise schema.VibeError(look.problem, "Delete it, or correct the file.")
        rest = transfer.apply_preset(context.scene, look.preset, context.scene.vibe.choice())
        addon_state.forget()  # the last session's images and variants do not belong to this look
        window_state = context.window_manager.vibe_presets
        window_state.chosen, window_state.rest = str(look.path), "\n".join(rest)
        left = f"; {len(rest)} values did not fit" if len(rest) > 1 else "; one value did not fit"
        return f"{look.name} is in the scene{left if rest else ''}"


class VIBE_OT_preset_save(_NameDialog, _LookOperator, label="Save Preset"):
    """Save the look that the scene has now as a preset, with a picture of it"""

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        settings = context.scene.vibe
        first = settings.vibed_prompt.partition(",")[0]  # short, for the grid; the preset keeps the prompt
        self.name = settings.vibed_preset or preset.title(first[:1].upper() + first[1:])
        return context.window_manager.invoke_props_dialog(self, width=340, confirm_text="Save")

    def draw(self, context: bpy.types.Context) -> None:
        super().draw(context)
        self.layout.label(text="Blender waits for a small render, its picture", icon="TIME")

    def perform(self, context: bpy.types.Context) -> str:
        scene = context.scene
        look = transfer.capture_preset(scene, scene.vibe.choice(), self.name)
        with thumbnail.rendered_thumbnail(scene) as picture:
            saved = library.save_preset(look, picture)
        context.window_manager.vibe_presets.chosen = str(saved.path)
        return f"Saved as {saved.name}"


class VIBE_OT_preset_rename(_NameDialog, _OwnPresetOperator, label="Rename Preset"):
    """Give this preset another name"""

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        self.name = self.look(context).name
        return context.window_manager.invoke_props_dialog(self, width=340, confirm_text="Rename")

    def perform(self, context: bpy.types.Context) -> str:
        renamed = library.rename_preset(self.look(context), self.name)
        context.window_manager.vibe_presets.chosen = str(renamed.path)
        return f"Renamed to {renamed.name}"


class VIBE_OT_preset_delete(_OwnPresetOperator, label="Delete Preset"):
    """Delete this preset and its picture"""

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        confirm, message = context.window_manager.invoke_confirm, f"{self.look(context).name} will be gone for good."
        return confirm(self, event, title="Delete Preset", message=message, confirm_text="Delete", icon="WARNING")

    def perform(self, context: bpy.types.Context) -> str:
        look = self.look(context)
        library.delete_preset(look)
        context.window_manager.vibe_presets.chosen = ""
        return f"{look.name} is deleted"


class _FileDialog:
    """A file dialog without the column of options."""

    hide_props_region: BoolProperty(default=True, options={"HIDDEN", "SKIP_SAVE"})


class _ExportDialog(_FileDialog, ExportHelper):
    """A file dialog for saving, with a proposed name."""

    def propose(self, context: bpy.types.Context, event: bpy.types.Event, name: str, folder: str = "") -> set[str]:
        """Opens the dialog with a path for the look `name`, in the last dialog's folder, or else in `folder`."""
        if self.filepath:  # type: ignore[has-type]
            folder = str(Path(self.filepath).parent)  # type: ignore[has-type]
        self.filepath = str(library.path_for(Path(folder), name).with_suffix(self.filename_ext))
        return ExportHelper.invoke(self, context, event)


class VIBE_OT_preset_import(IdleOperator, _FileDialog, ImportHelper, label="Import Presets"):
    """Copy preset files into your presets. Nothing in them is ever run"""

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


class VIBE_OT_preset_export(_PresetOperator, _ExportDialog, label="Export Preset"):
    """Save this preset and its picture as files, to pass on"""

    filename_ext = ".json"
    filter_glob: StringProperty(default="*.json", options={"HIDDEN"})

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        return self.propose(context, event, self.look(context).name)

    def perform(self, context: bpy.types.Context) -> str:
        library.export_preset(self.look(context), Path(self.filepath))
        return f"Written: {self.filepath}"


class VIBE_OT_export_assets(_LookOperator, _ExportDialog, label="Export as Assets"):
    """Save materials, world, lights and grade of the look that the scene has now, for the Asset Browser"""

    filename_ext = ".blend"
    filter_glob: StringProperty(default="*.blend", options={"HIDDEN"})

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Opens the file dialog; proposes the folder of the first asset library."""
        libraries = context.preferences.filepaths.asset_libraries
        return self.propose(context, event, _look_name(context), libraries[0].path if libraries else "")

    def perform(self, context: bpy.types.Context) -> str:
        scene, path = context.scene, Path(self.filepath)
        settings = scene.vibe
        settings.show_original = False
        keys = [schema.split_key(change.name) for change in settings.changes]
        names = dict.fromkeys(owner for group, owner, _ in keys if group == "material")
        all_materials = {material.name_full: material for material in bpy.data.materials}
        changed = [all_materials[name] for name in names if name in all_materials]
        analysis = reading.read_scene(scene, settings.choice()).analysis
        with thumbnail.rendered_thumbnail(scene) as picture:
            words = settings.vibed_prompt
            written = assets.export_assets(analysis, _look_name(context), words, changed, path, picture)
        return f"{len(written)} assets are in {self.filepath}"


class VIBE_OT_export_lut(IdleOperator, _ExportDialog, label="Export LUT"):
    """Save the scene's color grade as a .cube file for other programs: sRGB in, sRGB out"""

    filename_ext = ".cube"
    filter_glob: StringProperty(default="*.cube", options={"HIDDEN"})

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        graded, neutral = transfer.grade_values(context.scene), lut.neutral_grade()
        same = all(value == neutral[name] for name, value in graded.items() if name not in lut.LEFT_OUT)
        return "The scene's colors are not graded" if same else ""

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        return self.propose(context, event, _look_name(context))

    def perform(self, context: bpy.types.Context) -> str:
        """Writes the file; the message names effects of the grade that a LUT cannot store."""
        values, neutral = transfer.grade_values(context.scene), lut.neutral_grade()
        lut.write_cube(Path(self.filepath), _look_name(context), values)
        rest = [name for name in lut.LEFT_OUT if values.get(name, neutral[name]) != neutral[name]]
        return f"Written: {self.filepath}" + (f", without {' and '.join(rest)}" if rest else "")


def _look_name(context: bpy.types.Context) -> str:
    settings: Any = context.scene.vibe
    return settings.vibed_preset or preset.title(settings.vibed_prompt) or context.scene.name
