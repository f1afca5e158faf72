# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights on standby: those that we would add to a scene if the words asked for a light that it lacks."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import bpy
from mathutils import Vector

from ..core.journal import Journal
from ..core.schema_import import schema
from ..scene import bindings, prepare, scene_context
from . import view
from .analysis import SceneAnalysis


def lights(analysis: SceneAnalysis) -> tuple[list[dict[str, Any]], dict[str, schema.Instance]]:
    """Their entries in scene.json and their parameters; they are in the scene only while this reads them."""
    scene, pivot = analysis.scene, Vector(analysis.pivot)
    names = [name for name in prepare.LIGHTS if name not in bpy.data.objects]
    journal = Journal()
    try:
        added = bindings.add_lights(journal, scene, names, analysis.objects)
        scene_context.layer(scene).update()
        rows = [view.light(obj, prepare.ROLES[obj.name], pivot) for obj in added]
        bound = bindings.instances(scene, analysis.objects, analysis.pivot, ("light",))
        ours = {k: replace(i, role=prepare.ROLES[i.owner]) for k, i in bound.items() if i.owner in names}
    finally:
        journal.undo()
        scene_context.layer(scene).update()
    return rows, ours
