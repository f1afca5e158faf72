# SPDX-License-Identifier: GPL-3.0-or-later
"""Notes for the artist: what spoils a picture whatever its look, and what a prediction approximates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..core import rendered
from ..core.schema_import import schema
from .analysis import SceneAnalysis

_NAMED = 3
_MOST = 5

_WHOLE_PICTURE = 0.98  # of the picture: what fills this much leaves nothing else to see


def notes_by_reason(notes: Mapping[str, Sequence[str]]) -> list[str]:
    """Lines for each reason: "Glossy BSDF is approximated in A, B and 7 more."; important names first."""
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
    """At most five lines, each once, and how many more there are."""
    lines = list(dict.fromkeys(lines))
    rest = len(lines) - _MOST
    return lines if rest <= 0 else [*lines[:_MOST], f"And {rest} more."]


def filling(analysis: SceneAnalysis) -> int | None:
    """The number of the object that fills the picture, and is not all that there is; None where other things are seen."""
    objects, shown = analysis.geometry.objects, analysis.visible.object
    number = int(np.bincount(shown[shown >= 0]).argmax())
    alone = len(objects) < 2 or analysis.is_subject.sum() == len(objects)
    return None if alone or (shown == number).mean() < _WHOLE_PICTURE else number


def view_notes(analysis: SceneAnalysis) -> list[str]:
    """Faults of the camera's view; a VibeError if it is filled by what is hidden in the viewport."""
    if (number := filling(analysis)) is None:
        return []
    name, parent = analysis.geometry.objects[number]
    thing = next((o for o in analysis.scene.objects if o.name_full == (parent or name)), None)
    if thing is not None and not thing.visible_get(view_layer=rendered.layer(analysis.scene)):
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
