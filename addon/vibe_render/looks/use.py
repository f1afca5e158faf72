# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets and the open file: apply one to a scene as a vibe's result is, capture one from a scene."""

from __future__ import annotations

import bpy

from ..core import compat
from ..core.schema_import import messages, preset, schema
from ..core.value_slots import socket_slot
from ..export import reading
from ..run import result
from ..scene import bindings
from ..scene.nodes import grade, owned
from ..scene.subject import SubjectChoice, remember_subject
from . import lut, transfer

_POWER = "/power"


def apply_preset(scene: bpy.types.Scene, look: preset.Preset, choice: SubjectChoice) -> list[str]:
    """Applies a look to the scene, as a vibe's result is; returns what did not fit, in words for the artist.

    A look from another preset that has not been kept is taken out first, so that presets can be tried one after the
    other. A failure leaves the scene as it was.

    Raises:
        VibeError: Nothing of the look fits, or the scene cannot be worked with.
    """
    settings = scene.vibe
    another, shown = bool(settings.vibed_preset), settings.show_original
    if another:
        settings.show_original = True
    try:
        with reading.rollback_on_failure(scene):
            scene_reading = reading.prepare_and_read(scene, choice)
            subject, pivot = scene_reading.analysis.objects, scene_reading.analysis.pivot
            fitted = transfer.fit_look(look, scene_reading)
            if not fitted.values:
                message = "Nothing in this scene takes what the preset holds."
                raise schema.VibeError(message, "See what it is for in its description.")
            # New lights are dark at strength 0.
            added = {
                key: [0.0]
                for key in fitted.values
                if key.endswith(_POWER) and key not in scene_reading.instances
            }
            bindings.write(scene, added, subject, pivot)
            # no reasons: the preset's name is above the list
            as_result = messages.Result(fitted.values, {}, "")
            result.apply(scene, look.prompt or look.name, as_result, subject, pivot, fresh_list=True)
    except BaseException:
        settings.show_original = shown
        raise
    settings.vibed_preset = look.name
    if choice.explicit:
        remember_subject(scene, subject)
    return fitted.rest


def capture_preset(scene: bpy.types.Scene, choice: SubjectChoice, name: str) -> preset.Preset:
    """All that the last vibe or preset changed, which the scene then shows; a VibeError if that is nothing."""
    settings = scene.vibe
    settings.show_original = False
    scene_reading = reading.read_scene(scene, choice)
    changed = (change.name for change in settings.changes)
    values = {key: scene_reading.instances[key].value for key in changed if key in scene_reading.instances}
    look = transfer.extract_look(settings.vibed_prompt, scene_reading, values, name, settings.vibed_goals)
    if not look.roles:
        raise schema.VibeError("There is no look to save.", "Vibe the scene first, or apply a preset.")
    return look


def grade_values(scene: bpy.types.Scene) -> dict[str, tuple[float, ...]]:
    """The values of the scene's grade, by name; empty if it has none."""
    nodes = owned.group_nodes(compat.compositor(scene), grade.NAME)
    if not nodes:
        return {}
    rows = [row for row in bindings.BINDINGS if row.parameter.name in lut.neutral_grade()]
    sockets = {row: nodes[0].inputs[row.parameter.blender.rpartition(" > ")[2]] for row in rows}
    return {
        row.parameter.name: row.codec.decode(socket_slot(socket).get()) for row, socket in sockets.items()
    }
