# SPDX-License-Identifier: GPL-3.0-or-later
# mypy: disable-error-code="valid-type"
"""What the preset panel's buttons do."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, ClassVar

import bpy
from bpy.props import CollectionProperty, StringProperty
from bpy_extras.io_utils import ExportHelper, ImportHelper

from . import assets, library, lut, preset_use, scene_io, thumbnail
from .contract import preset, schema
from .operators import untouchable
from .roster import GEOMETRY
from .session import choice, desk


class VibePresets(bpy.types.PropertyGroup):
    """What the preset panel holds, kept with the window."""

    search: StringProperty(
        name="Search",
        description="Words of a preset's name or prompt",
        options={"TEXTEDIT_UPDATE", "SKIP_SAVE"},
    )
    chosen: StringProperty(description="The file of the chosen preset")
    rest: StringProperty(description="What did not fit of the last one, in lines")


class _Idle(bpy.types.Operator):
    """For what must wait until a vibe is over; a failure is one line, and leaves everything as it was."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Greyed out, with the reason, while there is an obstacle."""
        reason = "A vibe is on its way" if desk.running else cls.obstacle(context)
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
                said = self.act(context)
        except schema.VibeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for area in context.screen.areas if context.screen else ():
            area.tag_redraw()
        self.report({"INFO"}, said)
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


class _Chosen(_Idle):
    """For what is done with the chosen preset."""

    path: StringProperty(
        options={"HIDDEN", "SKIP_SAVE"}, description="The preset's file; empty: the chosen one"
    )

    def look(self, context: bpy.types.Context) -> library.Look:
        """The preset; raises VibeError where it is gone."""
        return library.at(self.path or context.window_manager.vibe_presets.chosen)


class _OwnChosen(_Chosen):
    """For what cannot be done with the presets that come with Vibe Render."""

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        """Says whose preset it is."""
        chosen = context.window_manager.vibe_presets.chosen
        if not chosen:
            return "Choose a preset first"
        return "It comes with Vibe Render" if Path(chosen).parent == library.SHIPPED else ""


class _Look(_Idle):
    """For what is done with the look that the scene has now."""

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        """Says that there is none."""
        return "" if context.scene.vibe.changes else "Vibe the scene first, or apply a preset"


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


class VIBE_OT_preset_apply(_Chosen):
    """Give the scene this look. Strength, Original, Keep and Revert work as after a vibe"""

    bl_idname = "vibe.preset_apply"
    bl_label = "Apply"
    bl_options: ClassVar[set[str]] = {"UNDO"}

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        """Says that there is nothing to light."""
        there = any(obj.type in GEOMETRY for obj in context.scene.objects)
        return untouchable(context) if there else "The scene has no mesh"

    def act(self, context: bpy.types.Context) -> str:
        """Applies it; what did not fit is listed in the panel."""
        look = self.look(context)
        if look.preset is None:
            raise schema.VibeError(look.problem, "Delete it, or correct the file.")
        rest = preset_use.apply(context.scene, look.preset, choice(context.scene.vibe))
        desk.forget()  # its pictures and variants are not of this look
        context.window_manager.vibe_presets.rest = "\n".join(rest)
        left = (
            f"; {len(rest)} things did not fit"
            if len(rest) > 1
            else "; one thing did not fit"
            if rest
            else ""
        )
        return f"{look.name} is in the scene{left}"


class VIBE_OT_preset_save(_Look):
    """Save the look that the scene has now as a preset, with a picture of it"""

    bl_idname = "vibe.preset_save"
    bl_label = "Save Preset"

    name: StringProperty(name="Name", maxlen=preset.LONGEST_NAME)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Asks for a name."""
        settings = context.scene.vibe
        self.name = settings.vibed_preset or preset.title(settings.vibed_prompt)
        return context.window_manager.invoke_props_dialog(self, width=340, confirm_text="Save")

    def act(self, context: bpy.types.Context) -> str:
        """Saves it; the picture is a small render."""
        scene = context.scene
        look = preset_use.capture(scene, choice(scene.vibe), self.name)
        with tempfile.TemporaryDirectory(prefix="vibe-") as folder:
            picture = Path(folder) / f"picture{thumbnail.SUFFIX}"
            thumbnail.render(scene, picture)
            saved = library.save(look, picture)
        context.window_manager.vibe_presets.chosen = str(saved.path)
        return f"Saved as {saved.name}"


class VIBE_OT_preset_rename(_OwnChosen):
    """Give this preset another name"""

    bl_idname = "vibe.preset_rename"
    bl_label = "Rename Preset"

    name: StringProperty(name="Name", maxlen=preset.LONGEST_NAME)

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


class VIBE_OT_preset_delete(_OwnChosen):
    """Delete this preset and its picture"""

    bl_idname = "vibe.preset_delete"
    bl_label = "Delete Preset"

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Asks whether it is meant."""
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


class VIBE_OT_preset_import(_Idle, ImportHelper):
    """Copy preset files into your presets. Nothing in them is ever run"""

    bl_idname = "vibe.preset_import"
    bl_label = "Import Presets"

    filename_ext = ".json"
    filter_glob: StringProperty(default="*.json", options={"HIDDEN"})
    directory: StringProperty(subtype="DIR_PATH", options={"HIDDEN", "SKIP_SAVE"})
    files: CollectionProperty(type=bpy.types.OperatorFileListElement, options={"HIDDEN", "SKIP_SAVE"})

    def act(self, context: bpy.types.Context) -> str:
        """Imports all that can be; the first that cannot is said."""
        paths = [Path(self.directory) / file.name for file in self.files if file.name] or [
            Path(self.filepath)
        ]
        for path in paths:
            brought = library.bring(path)
            context.window_manager.vibe_presets.chosen = str(brought.path)
        return (
            f"{brought.name} is among your presets" if len(paths) == 1 else f"{len(paths)} presets imported"
        )


class _Export(ExportHelper):
    """A file dialog that proposes a name."""

    def propose(self, name: str, folder: str = "") -> None:
        """Proposes a file for a look of this name."""
        if not self.filepath:  # type: ignore[has-type]
            self.filepath = str(library.path_for(Path(folder), name).with_suffix(self.filename_ext))


class VIBE_OT_preset_export(_Chosen, _Export):
    """Write this preset, and its picture beside it, for somebody else"""

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


class VIBE_OT_export_assets(_Look, _Export):
    """Write materials, world, light rig and grade of the look that the scene has now for the Asset Browser"""

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
        known = {material.name_full: material for material in bpy.data.materials}
        survey = scene_io.look_at(scene, choice(settings)).survey
        with tempfile.TemporaryDirectory(prefix="vibe-") as folder:
            picture = Path(folder) / f"picture{thumbnail.SUFFIX}"
            thumbnail.render(scene, picture)
            written = assets.export(
                survey,
                _name(context),
                settings.vibed_prompt,
                [known[name] for name in names if name in known],
                Path(self.filepath),
                picture,
            )
        return f"{len(written)} assets are in {self.filepath}"


class VIBE_OT_export_lut(_Idle, _Export):
    """Write the scene's grade as a .cube for other programs: sRGB in, sRGB out"""

    bl_idname = "vibe.export_lut"
    bl_label = "Export LUT"

    filename_ext = ".cube"
    filter_glob: StringProperty(default="*.cube", options={"HIDDEN"})

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        """Says that nothing is graded."""
        graded = preset_use.grade_values(context.scene)
        colors = {name: value for name, value in graded.items() if name not in lut.LEFT_OUT}
        neutral = lut.identity()
        same = all(value == neutral[name] for name, value in colors.items())
        return "The scene's colors are not graded" if same else ""

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Asks where."""
        self.propose(_name(context))
        return ExportHelper.invoke(self, context, event)

    def act(self, context: bpy.types.Context) -> str:
        """Writes it; says what cannot be in it."""
        values = preset_use.grade_values(context.scene)
        lut.write(Path(self.filepath), _name(context), values)
        neutral = lut.identity()
        rest = [name for name in lut.LEFT_OUT if values.get(name, neutral[name]) != neutral[name]]
        return f"Written: {self.filepath}" + (f", without {' and '.join(rest)}" if rest else "")


def _name(context: bpy.types.Context) -> str:
    settings: Any = context.scene.vibe
    return settings.vibed_preset or preset.title(settings.vibed_prompt) or context.scene.name


CLASSES = (
    VibePresets,
    VIBE_OT_preset_choose,
    VIBE_OT_preset_apply,
    VIBE_OT_preset_save,
    VIBE_OT_preset_rename,
    VIBE_OT_preset_delete,
    VIBE_OT_preset_import,
    VIBE_OT_preset_export,
    VIBE_OT_export_assets,
    VIBE_OT_export_lut,
)
