# SPDX-License-Identifier: GPL-3.0-or-later
"""A sketch of a scene: a job folder with bounding boxes in place of meshes, for readers of words."""

from __future__ import annotations

from pathlib import Path

import bpy

from ..scene import scene_context
from ..scene.geometry import visibility
from ..scene.geometry.meshes import box_geometry
from ..scene.nodes import owned
from ..scene.subject import SubjectChoice
from .analysis import VisibleScene, analyze, check_camera
from .job_folder import write_sketch


def sketch_scene(scene: bpy.types.Scene, folder: Path, choice: SubjectChoice) -> None:
    """Writes a sketch, which the engine reads like any exported scene.

    Nothing is rendered, and nothing in the scene changes. Subject, roles and places are found as for a vibe.

    Args:
        folder: Made if it does not exist.

    Raises:
        VibeError: The scene cannot be worked with; see `analysis.analyze`.
    """
    check_camera(scene)
    depsgraph = scene_context.depsgraph(scene)
    camera = visibility.ray_camera(scene)
    shown = {obj for obj in scene_context.shown(scene) if not owned.is_unseen(obj)}
    geometry = box_geometry(depsgraph, shown, camera)
    visible = VisibleScene(geometry, visibility.visible_surfaces(camera, geometry), frozenset())
    write_sketch(analyze(scene, choice, visible), folder)
