# SPDX-License-Identifier: GPL-3.0-or-later
"""Why a scene renders black, and what to do about it."""

from __future__ import annotations

import bpy

from ..core import compat
from ..core.schema_import import schema
from ..scene.nodes import grade

_FAINT = 2.0**-8  # of exposure, below which white in full light is black


def check_shows(scene: bpy.types.Scene, filling: str, lit: bool) -> None:
    """Raises a VibeError with the cause of a black picture, unless light cures that and the words bring some.

    Args:
        filling: Name of the object that fills the picture; "" where several are seen.
        lit: Whether what the words ask for lights the scene.
    """
    if is_cut_off(scene):
        why = "no picture reaches the output of its compositor", "Connect one, or take the compositor out."
    elif scene.cycles.film_exposure * 2.0**scene.view_settings.exposure < _FAINT:
        why = "it is hardly exposed", "Raise Exposure in Render Properties > Film, or in Color Management."
    elif filling:
        why = (
            f'"{filling}" fills the picture, and no light reaches the side that the camera sees',
            f'Move "{filling}" away from the camera, or hide it in renders.',
        )
    elif not lit:
        remedy = "Turn a light on or towards it, or ask for one in the prompt: “lit from the left”."
        why = "no light reaches what the camera sees", remedy
    else:
        return
    raise schema.VibeError(f"The scene renders black: {why[0]}.", why[1])


def is_cut_off(scene: bpy.types.Scene) -> bool:
    """True if no picture reaches the output of a scene's compositor, so that every render is black."""
    return grade.cut_off(compat.compositor(scene))
