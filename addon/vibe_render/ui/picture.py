# SPDX-License-Identifier: GPL-3.0-or-later
"""The reference image: its fields, its part of the main panel, and pasting it from the clipboard."""

from __future__ import annotations

from pathlib import Path

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty, PointerProperty

from ..core import compat
from ..core.schema_import import options, schema
from ..render import reference
from . import drawing
from .bases import IdleOperator

_TRAITS = {
    "light": "Side and color of the light",
    "grade": "Contrast, blacks and whites, tints of shadows and highlights, vignette",
    "palette": "Colors of the subject, its surroundings and the sky",
    "air": "Haze",
    "materials": "Colors and finishes of surfaces, if the image shows the same scene",
}


class PictureSettings:
    """The panel's fields for the reference image that are not in the schema's table of options."""

    like_from: EnumProperty(
        name="Reference Image",
        description="An image whose look is copied, together with the words or without any",
        items=(
            ("NONE", "None", "Words only"),
            ("FILE", "File", "A still, a photograph, a painting, an HDRI for its light"),
            ("IMAGE", "Image", "An image of this .blend, or from the clipboard"),
            ("SLOT", "Render", "A slot of the render result"),
        ),
    )
    like_image: PointerProperty(
        name="Image",
        description="The image whose look is copied",
        type=bpy.types.Image,
        poll=lambda _, image: image.type != "RENDER_RESULT",  # renders are chosen by their slots
    )
    # A render result has 8 slots at first; artists may add more.
    like_slot: IntProperty(name="Slot", description="Of the render result", default=1, min=1, soft_max=8)

    def traits(self) -> tuple[str, ...]:
        """The traits to copy, as the option `like_only` takes them: an empty tuple stands for all of them."""
        chosen = tuple(name for name in options.TRAITS if getattr(self, f"like_{name}"))
        return () if chosen == options.TRAITS else chosen


assert tuple(_TRAITS) == options.TRAITS
PictureSettings.__annotations__ |= {
    f"like_{name}": BoolProperty(
        name="Haze" if name == "air" else name.capitalize(), description=f"Copy: {what}", default=True
    )
    for name, what in _TRAITS.items()
}


def draw(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draws the reference image and the traits to copy; closed at first, with the image's name in the header."""
    settings = context.scene.vibe
    header, body = layout.panel("vibe_reference_image", default_closed=True)
    given = reference.picture_name(settings)
    header.label(text="Reference Image" + (f": {given}" if given else ""))
    if body is None:
        return
    body.row(align=True).prop(settings, "like_from", expand=True)
    column, shown = body.column(), 0
    if settings.like_from == "FILE":
        column.prop(settings, "like", text="")
        shown = drawing.icon(Path(bpy.path.abspath(settings.like)))
    elif settings.like_from == "IMAGE":
        column.template_ID(settings, "like_image", open="image.open")
        column.operator("vibe.paste_picture", icon="PASTEDOWN")
    elif settings.like_from == "SLOT":
        column.prop(settings, "like_slot")
    if not given:
        return
    if reason := reference.picture_obstacle(settings):
        drawing.paragraph(body, context, reason, "ERROR", faint=True)
        return
    if settings.like_from == "IMAGE":
        shown = body.icon(settings.like_image)
    if shown:
        body.template_icon(icon_value=shown, scale=6.0)  # heights of a button
    grid = body.grid_flow(row_major=True, columns=2, even_columns=True)
    for name in (*options.TRAITS, "same"):
        grid.prop(settings, f"like_{name}")
    drawing.paragraph(body, context, "Copies the look, not the content. The prompt has priority.", faint=True)


class VIBE_OT_paste_picture(IdleOperator, label="Paste", options={"UNDO"}):
    """Use the image in the clipboard; it becomes an image of this .blend"""

    def perform(self, context: bpy.types.Context) -> str:
        image = compat.pasted_picture(context)
        if image is None:
            remedy = "Copy one first. Some desktops hand Blender none (X11 on Linux): save it, and choose File."
            raise schema.VibeError("Blender finds no image in the clipboard.", remedy)
        image.pack()
        settings = context.scene.vibe
        settings.like_from, settings.like_image = "IMAGE", image
        return f"{image.name} is the reference image"
