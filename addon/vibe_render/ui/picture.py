# SPDX-License-Identifier: GPL-3.0-or-later
# mypy: disable-error-code="valid-type"
"""A picture whose look is the target: its fields, its panel, and pasting it from the clipboard."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty, PointerProperty

from ..core import compat
from ..core.schema_import import options, schema
from ..render import reference
from . import drawing
from .bases import IdleOperator, IdlePanel

_SCALE = 6.0
"""Of the thumbnail, in buttons."""
_SLOTS = 8
"""Most slots that a render result begins with; artists may add more."""
_TRAITS = {
    "light": "Where its light comes from, how hard and how warm it is",
    "grade": "Its contrast, its blacks and whites, the tints of shadows and highlights, its vignette",
    "palette": "The colors of the subject, of its surroundings and of the sky",
    "air": "Its haze and its glow",
    "materials": "Colors and finishes of surfaces, where it shows this very scene",
}


def _is_picture(_: Any, image: bpy.types.Image) -> bool:
    """Render results have slots, and a choice of their own."""
    return image.type != "RENDER_RESULT"


def _toggles() -> dict[str, Any]:
    assert tuple(_TRAITS) == options.TRAITS
    return {
        f"like_{name}": BoolProperty(name=name.capitalize(), description=f"Take over: {what}", default=True)
        for name, what in _TRAITS.items()
    }


_Toggles = type("VibePictureToggles", (), {"__annotations__": _toggles(), "__module__": __name__})


class PictureSettings(_Toggles):  # type: ignore[misc]
    """The panel's fields for the picture, apart from those of the table of options."""

    like_from: EnumProperty(
        name="Picture",
        description="A picture whose look is wanted, together with the words or without any",
        items=(
            ("NONE", "None", "Words only", "X", 0),
            ("FILE", "File", "A still, a photograph, a painting, an HDRI for its light", "FILE_IMAGE", 1),
            ("IMAGE", "Image", "An image of this .blend, or from the clipboard", "IMAGE_DATA", 2),
            ("SLOT", "Render", "A slot of the render result", "RENDER_RESULT", 3),
        ),
    )
    like_image: PointerProperty(
        type=bpy.types.Image, name="Image", description="The picture whose look is wanted", poll=_is_picture
    )
    like_slot: IntProperty(name="Slot", description="Of the render result", default=1, min=1, soft_max=_SLOTS)

    def traits(self) -> tuple[str, ...]:
        """The traits that are taken over, as the option `like_only` has them: none named is all of them."""
        chosen = tuple(name for name in options.TRAITS if getattr(self, f"like_{name}"))
        return () if chosen == options.TRAITS else chosen


class PicturePanel(IdlePanel):
    """A picture, and what is taken over from it."""

    bl_label = "Like a Picture"
    bl_options: ClassVar[set[str]] = {"DEFAULT_CLOSED"}

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        if given := reference.picture_name(context.scene.vibe):
            self.layout.label(text=f"{given} " if len(given) < 24 else f"{given[:22]}… ")  # type: ignore[attr-defined]

    def draw(self, context: bpy.types.Context) -> None:
        layout: Any = self.layout  # type: ignore[attr-defined]
        settings = context.scene.vibe
        row = layout.row(align=True)
        row.prop_enum(settings, "like_from", "NONE", text="")
        for place in ("FILE", "IMAGE", "SLOT"):
            row.prop_enum(settings, "like_from", place)
        column, shown = layout.column(), 0
        if settings.like_from == "FILE":
            column.prop(settings, "like", text="")
            shown = drawing.icon(Path(bpy.path.abspath(settings.like)))
        elif settings.like_from == "IMAGE":
            column.template_ID(settings, "like_image", open="image.open")
            if compat.HAS_CLIPBOARD_PICTURES:
                column.operator("vibe.paste_picture", icon="PASTEDOWN")
        elif settings.like_from == "SLOT":
            column.prop(settings, "like_slot")
        if not reference.picture_name(settings):
            return
        if reason := reference.picture_obstacle(settings):
            drawing.paragraph(layout, context, reason, "ERROR", faint=True)
            return
        if settings.like_from == "IMAGE":
            shown = layout.icon(settings.like_image)
        if shown:
            layout.template_icon(icon_value=shown, scale=_SCALE)
        grid = layout.grid_flow(columns=2, even_columns=True, align=True)
        for name in options.TRAITS:
            grid.prop(settings, f"like_{name}", toggle=True)
        grid.prop(settings, "like_same", toggle=True)
        drawing.paragraph(layout, context, "Its look, not its content. Words count more.", faint=True)


class VIBE_OT_paste_picture(IdleOperator):
    """Use the picture in the clipboard; it becomes an image of this .blend"""

    bl_idname = "vibe.paste_picture"
    bl_label = "Paste"
    bl_options: ClassVar[set[str]] = {"UNDO"}

    def act(self, context: bpy.types.Context) -> str:
        image = compat.pasted_picture(context)
        if image is None:
            raise schema.VibeError(
                "Blender sees no picture in the clipboard.",
                "Copy one first. Some desktops hand Blender none (X11 on Linux): save it, and choose File.",
            )
        image.pack()
        settings = context.scene.vibe
        settings.like_from, settings.like_image = "IMAGE", image
        return f"{image.name} is the look that is wanted"


CLASSES = (VIBE_OT_paste_picture,)
