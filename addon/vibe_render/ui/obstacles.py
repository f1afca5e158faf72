# SPDX-License-Identifier: GPL-3.0-or-later
"""Why a button is grayed out, in words for its tool tip."""

from __future__ import annotations

import bpy

from ..render import reference
from ..run.engine_state import engine_state
from ..run.state import addon_state
from ..scene import snapshot, stored_subject
from ..scene.scene_context import GEOMETRY


def obstacle(context: bpy.types.Context) -> str:
    """Why a vibe cannot start now; "" if it can."""
    scene = context.scene
    if addon_state.running:
        return "A vibe is on its way"
    if reason := untouchable(context):
        return reason
    if reason := reference.obstacle(scene.vibe):
        return reason
    if not scene.vibe.prompt.strip() and not reference.name(scene.vibe):
        return "Describe a mood first"
    if not any(obj.type in GEOMETRY for obj in scene.objects):
        return "The scene has no mesh"
    if not scene.vibe.groups():
        return "Nothing may change: open a lock"
    if scene.vibe.subject == "COLLECTION" and not scene.vibe.collection:
        return "Choose the subject's collection"
    if scene.vibe.subject == "SELECTED" and not (context.selected_objects or stored_subject.recall(scene)):
        return "Select the subject"
    if engine_state.problem:
        return "Set up the engine first"
    return ""


def result_obstacle(context: bpy.types.Context) -> str:
    """Why the result can be neither kept, reverted nor changed now; "" if it can."""
    if addon_state.running:
        return "A vibe is on its way"
    if not snapshot.exists(context.scene):
        return "This scene has not been vibed"
    return untouchable(context)


def untouchable(context: bpy.types.Context) -> str:
    """Why the scene must not be changed now; "" if it may be."""
    if not context.scene.is_editable:
        return "This scene is linked from a library"
    if context.mode != "OBJECT":  # in other modes, undo takes back only that mode's own steps
        return "Go to Object Mode first"
    return ""
