# SPDX-License-Identifier: GPL-3.0-or-later
"""What spoils a scene's picture whatever its look: said before anything is searched for."""

from __future__ import annotations

import bpy
import numpy as np

from ..core.schema_import import schema
from ..scene import scene_context
from .analysis import SceneAnalysis

_WHOLE_PICTURE = 0.98  # of the picture: what fills this much leaves nothing else to see


def view_notes(analysis: SceneAnalysis) -> list[str]:
    """What an artist would want to know of the camera's view; empty if nothing is odd.

    Raises:
        VibeError: The picture shows nothing but an object that the artist has hidden in the viewport.
    """
    objects, shown = analysis.geometry.objects, analysis.visible.object
    number = int(np.bincount(shown[shown >= 0]).argmax())
    if (
        len(objects) < 2
        or (shown == number).mean() < _WHOLE_PICTURE
        or analysis.is_subject.sum() == len(objects)
    ):
        return []
    name, parent = objects[number]
    thing = next((o for o in analysis.scene.objects if o.name_full == (parent or name)), None)
    if thing is not None and _hidden_in_viewport(analysis.scene, thing):
        raise schema.VibeError(
            f'"{thing.name}" fills the picture: it is hidden in the viewport, but not in renders.',
            "Hide it in renders too (the camera icon in the Outliner), or show it in the viewport.",
        )
    low, high = analysis.geometry.boxes[number]
    eye = np.array(analysis.scene.camera.matrix_world.translation)
    if ((low < eye) & (eye < high)).all():
        return [
            f'The camera is inside "{name}" and sees nothing else: move it out, or hide "{name}" in renders.'
        ]
    return []


def _hidden_in_viewport(scene: bpy.types.Scene, thing: bpy.types.Object) -> bool:
    return not thing.visible_get(view_layer=scene_context.layer(scene))
