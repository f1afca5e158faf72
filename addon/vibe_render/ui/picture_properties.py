# SPDX-License-Identifier: GPL-3.0-or-later
# mypy: disable-error-code="valid-type"
"""The panel's fields for a picture whose look is wanted, beside those of the table of options."""

from __future__ import annotations

from typing import Any

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty, PointerProperty

from ..core.schema_import import options

SLOTS = 8
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
    """Where the picture is, and what is taken over from it."""

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
    like_slot: IntProperty(name="Slot", description="Of the render result", default=1, min=1, soft_max=SLOTS)

    def traits(self) -> tuple[str, ...]:
        """What is taken over from the picture, as the option `like_only` has it: nothing named is everything."""
        chosen = tuple(name for name in options.TRAITS if getattr(self, f"like_{name}"))
        return () if chosen == options.TRAITS else chosen
