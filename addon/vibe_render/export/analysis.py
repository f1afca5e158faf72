# SPDX-License-Identifier: GPL-3.0-or-later
"""Scene analysis: geometry, surfaces that the camera sees, subject, and the pivot that camera and lights orbit."""

from __future__ import annotations

from dataclasses import dataclass, replace

import bpy
import numpy as np
from bpy.types import Object, Scene
from mathutils import Vector

from ..core import names, rendered
from ..core.rendered import GEOMETRY
from ..core.schema_import import schema
from ..scene import copies, subject
from ..scene.geometry import triangles
from ..scene.geometry.meshes import collect_meshes
from ..scene.geometry.triangles import PlacedMesh, RayCamera, SceneGeometry, VisibleSurfaces
from ..scene.scene_context import SceneContext
from .materials import uv_of


@dataclass(frozen=True)
class VisibleScene:
    """A captured scene's geometry, and the surfaces that its camera sees; holds no reference into Blender's data."""

    geometry: SceneGeometry
    visible: VisibleSurfaces
    blocks: frozenset[tuple[str, str]]  # (kind, name) of the geometry's objects and materials, see `data_blocks`


@dataclass(frozen=True)
class SceneCapture:
    """A copy of what a render of a scene shows; holds no reference into Blender's data."""

    meshes: list[PlacedMesh]
    warnings: list[str]  # notes for the artist on what could not be copied
    camera: RayCamera
    blocks: frozenset[tuple[str, str]]  # (kind, name) of all objects and materials of the file

    def visible_scene(self) -> VisibleScene:
        """Computes what the camera sees. Safe in a thread: it reads nothing of Blender's data."""
        geometry = triangles.assembled(self.meshes, self.warnings)
        named = {("object", name) for pair in geometry.objects for name in pair}
        named |= {("material", name) for name in geometry.materials}
        surfaces = triangles.visible_surfaces(self.camera, geometry)
        return VisibleScene(geometry, surfaces, self.blocks & named)


@dataclass(frozen=True)
class SceneAnalysis:
    """A scene's geometry, visible surfaces and subject, as they are before a vibe changes values."""

    scene: Scene
    geometry: SceneGeometry
    visible: VisibleSurfaces
    is_subject: np.ndarray  # (number of objects in the geometry,) bool
    objects: tuple[Object, ...]  # those that the subject consists of
    low: tuple[float, float, float]  # and `high`: corners of the subject's bounding box, world space, meters
    high: tuple[float, float, float]

    @property
    def pivot(self) -> tuple[float, float, float]:
        """The center of the subject's bounding box, world space, meters."""
        x, y, z = ((a + b) / 2 for a, b in zip(self.low, self.high, strict=True))
        return x, y, z

    def context(self) -> SceneContext:
        """The scene, its subject and pivot, from which locators find the places of values."""
        return SceneContext(self.scene, self.objects, Vector(self.pivot))


def check_scene(scene: Scene) -> None:
    """Replaces names that are not UTF-8. Raises VibeError for an unusable camera; a scene without a camera passes."""
    names.make_readable()
    camera = scene.camera
    if camera is None:  # one will be added
        return
    remedy = "Choose a perspective or orthographic camera."
    if camera.type != "CAMERA":
        raise schema.VibeError(f"{camera.name}, through which the scene is seen, is no camera.", remedy)
    if camera.data.type not in ("PERSP", "ORTHO"):
        kind = {"PANO": "panoramic"}.get(camera.data.type, camera.data.type.lower())
        raise schema.VibeError(f"{camera.name} is a {kind} camera.", remedy)
    if not np.isfinite(np.array(camera.matrix_world)).all():
        raise schema.VibeError(f"{camera.name} has no usable place: it is not a number.", "Move it back.")


def capture(scene: Scene) -> SceneCapture:
    """A copy of what a render of the scene shows. Renames data whose names are no valid text, and changes nothing else.

    Raises VibeError without a usable camera.
    """
    if scene.camera is None:
        raise schema.VibeError("The scene has no camera.", "Add one, and aim it at the subject.")
    check_scene(scene)
    meshes, warnings = copies.evaluate_render(scene, lambda depsgraph: collect_meshes(depsgraph, uv_of))
    return SceneCapture(meshes, warnings, triangles.ray_camera(scene), data_blocks())


def data_blocks() -> frozenset[tuple[str, str]]:
    """(kind, name) of all objects and materials in the file, such as ("object", "Cube")."""
    objects = (("object", o.name_full) for o in bpy.data.objects)
    return frozenset(objects) | {("material", m.name_full) for m in bpy.data.materials}


def analyze(scene: Scene, choice: subject.SubjectChoice, visible_scene: VisibleScene | None = None) -> SceneAnalysis:
    """Analyzes a scene as it is now, or as captured in `visible_scene`; `choice` names the subject.

    Raises VibeError if there is no usable camera, no mesh in view, or no such subject.
    """
    visible_scene = visible_scene or capture(scene).visible_scene()
    geometry, visible = visible_scene.geometry, visible_scene.visible
    if not len(geometry.faces):
        full = [s.name for s in bpy.data.scenes if s != scene and any(o.type in GEOMETRY for o in s.objects)]
        if full:
            message = f'The scene "{scene.name}" has no mesh that a render shows.'
            raise schema.VibeError(message, f'Save the file with another scene open: "{full[0]}" has meshes.')
        excluded = [c.name for c in rendered.layer(scene).layer_collection.children if c.exclude]
        remedy = f'Include "{excluded[0]}" in the view layer.' if excluded else "Add one, or unhide it for renders."
        raise schema.VibeError("The scene has no mesh that a render shows.", remedy)
    if (visible.object < 0).all():
        raise schema.VibeError("The camera sees no mesh.", "Point the scene's camera at the subject.")
    is_subject = subject.choose_subject(scene, geometry, visible, choice)
    boxes = geometry.boxes[is_subject].astype(float)
    low, high = boxes[:, 0].min(0), boxes[:, 1].max(0)
    names = {n for keep, pair in zip(is_subject, geometry.objects, strict=True) if keep for n in pair if n}
    objects = tuple(o for o in scene.objects if o.name_full in names)
    return SceneAnalysis(scene, geometry, visible, is_subject, objects, tuple(low.tolist()), tuple(high.tolist()))


def with_subject_of(analysis: SceneAnalysis, first_shot: SceneAnalysis) -> SceneAnalysis:
    """A shot's `analysis` with the subject and pivot of the first shot. Raises VibeError if this subject is hidden."""
    names = {o.name_full for o in first_shot.objects}
    objects = analysis.geometry.objects
    is_subject = np.array([name in names or parent in names for name, parent in objects])
    if not is_subject.any():
        message = f"The subject ({', '.join(sorted(names))}) is hidden at frame {analysis.scene.frame_current}."
        raise schema.VibeError(message, "Choose other frames, or name another --subject.")
    low, high = first_shot.low, first_shot.high
    return replace(analysis, is_subject=is_subject, objects=first_shot.objects, low=low, high=high)
