# SPDX-License-Identifier: GPL-3.0-or-later
"""Notes for the artist: faults of the camera's view, causes of a black render, approximations of the prediction."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from bpy.types import Scene

from ..core import compat, rendered
from ..core.schema_import import schema
from ..scene.nodes import grade
from .analysis import SceneAnalysis

_NAMED, _MOST = 3, 5  # most materials that a note names, and most notes that are shown


def notes_by_reason(notes: Mapping[str, Sequence[str]]) -> list[str]:
    """A line for each reason in `notes` (material -> reasons): "Glossy BSDF is approximated in A, B and 7 more."."""
    things: dict[str, list[str]] = {}
    for name, reasons in notes.items():
        for reason in dict.fromkeys(reasons):
            things.setdefault(reason, []).append(name)
    lines = []
    for reason, names in things.items():
        more = f"{len(names) - _NAMED} more" if len(names) > _NAMED else names.pop()
        lines.append(f"{reason} in {' and '.join(filter(None, (', '.join(names[:_NAMED]), more)))}.")
    return lines


def shortened_notes(lines: Sequence[str]) -> list[str]:
    """The first five different lines, and a line with the number of the others, if there are more."""
    lines = list(dict.fromkeys(lines))
    rest = len(lines) - _MOST
    return lines if rest <= 0 else [*lines[:_MOST], f"And {rest} more."]


def filling(analysis: SceneAnalysis) -> int | None:
    """Index of the object that fills the image; None if others are visible, or all objects are the subject."""
    objects, shown = analysis.geometry.objects, analysis.visible.object
    number = int(np.bincount(shown[shown >= 0]).argmax())
    alone = len(objects) < 2 or analysis.is_subject.sum() == len(objects)
    return None if alone or (shown == number).mean() < 0.98 else number


def view_notes(analysis: SceneAnalysis) -> list[str]:
    """Notes on the camera's view; raises VibeError if an object that is hidden in the viewport fills it."""
    if (number := filling(analysis)) is None:
        return []
    name, parent = analysis.geometry.objects[number]
    thing = next((o for o in analysis.scene.objects if o.name_full == (parent or name)), None)
    if thing is not None and not thing.visible_get(view_layer=rendered.layer(analysis.scene)):
        message = f'"{thing.name}" fills the picture: it is hidden in the viewport, but not in renders.'
        remedy = "Hide it in renders too (the camera icon in the Outliner), or show it in the viewport."
        raise schema.VibeError(message, remedy)
    low, high = analysis.geometry.boxes[number]
    eye = np.array(analysis.scene.camera.matrix_world.translation)
    if ((low < eye) & (eye < high)).all():
        return [f'The camera is inside "{name}" and sees nothing else: move it out, or hide "{name}" in renders.']
    return []


def check_shows(scene: Scene, filling: str, lit: bool) -> None:
    """Raises VibeError with the cause of a black render; with `lit`, not if light is all that is missing.

    `lit` is True if the words may add light. `filling` is the name of the object that fills the image; "" if others are
    visible.
    """
    if grade.cut_off(compat.compositor(scene)):
        why, remedy = "no picture reaches the output of its compositor", "Connect one, or take the compositor out."
    elif scene.cycles.film_exposure * 2.0**scene.view_settings.exposure < 2.0**-8:  # even white in full light is black
        why, remedy = "it is hardly exposed", "Raise Exposure in Render Properties > Film, or in Color Management."
    elif filling:
        why = f'"{filling}" fills the picture, and no light reaches the side that the camera sees'
        remedy = f'Move "{filling}" away from the camera, or hide it in renders.'
    elif not lit:
        why = "no light reaches what the camera sees"
        remedy = "Turn a light on or towards it, or ask for one in the prompt: “lit from the left”."
    else:
        return
    raise schema.VibeError(f"The scene renders black: {why}.", remedy)
