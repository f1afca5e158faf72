# SPDX-License-Identifier: GPL-3.0-or-later
"""What is on standby: lights that a scene lacks, and a backdrop of its own, added only if the words ask for them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import bpy
import numpy as np
from mathutils import Vector

from ..core.journal import Journal
from ..core.schema_import import schema
from ..scene import bindings, prepare, scene_context
from ..scene.nodes import backgrounds
from . import view
from .analysis import SceneAnalysis

_SEEN_WORLD = 0.05  # of what is around the subject: less world than this is out of sight


def standby_lights(analysis: SceneAnalysis) -> tuple[list[dict[str, Any]], dict[str, schema.Instance]]:
    """Their entries in scene.json and their parameters; they are in the scene only while this reads them."""
    scene, pivot = analysis.scene, Vector(analysis.pivot)
    known = schema.added_lights.ADDED_LIGHTS
    names = [name for name in known if name not in bpy.data.objects]
    journal = Journal()
    try:
        added = bindings.add_lights(journal, scene, names, analysis.objects)
        scene_context.layer(scene).update()
        corners = scene_context.bounds(scene, analysis.objects or scene_context.meshes(scene))
        size = prepare.card_size(*corners)
        rows = [
            view.light_row(obj, known[obj.name].role, pivot)
            | ({"card": size} if known[obj.name].pattern else {})
            for obj in added
        ]
        bound = bindings.instances(scene, analysis.objects, analysis.pivot, ("light",))
        ours = {k: replace(i, role=known[i.owner].role) for k, i in bound.items() if i.owner in names}
    finally:
        journal.undo()
        scene_context.layer(scene).update()
    return rows, ours


def standby_backdrop(
    analysis: SceneAnalysis, instances: Mapping[str, schema.Instance]
) -> dict[str, schema.Instance]:
    """The parameters of a backdrop that the world may get; none where the picture does not show the world.

    Args:
        instances: Its parameters by key.
    """
    scene, shown = analysis.scene, analysis.visible.object
    mine = np.append(analysis.is_subject, False)[shown]
    world_is_seen = (shown < 0).sum() >= _SEEN_WORLD * max((~mine).sum(), 1)
    if scene.render.film_transparent or not world_is_seen:
        return {}
    return backgrounds.offered_backdrop(scene.world, instances)
