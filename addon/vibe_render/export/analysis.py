# SPDX-License-Identifier: GPL-3.0-or-later
"""A first look at a scene: its geometry, what the camera sees, what the subject is, and around what it turns."""

from __future__ import annotations

from dataclasses import dataclass, replace

import bpy
import numpy as np

from ..core.schema_import import schema
from ..scene import evaluated, subject
from ..scene.geometry import visibility
from ..scene.geometry.meshes import collect
from ..scene.geometry.triangles import Geometry, Placed, assembled
from .materials import uv_of


@dataclass(frozen=True)
class Prospect:
    """What the scene's camera has before it, apart from the scene.

    Attributes:
        geometry: Everything that a render shows.
        seen: What the camera sees of it.
        blocks: Kind and name of the file's objects and materials that it speaks of.
    """

    geometry: Geometry
    seen: visibility.Visibility
    blocks: frozenset[tuple[str, str]]


@dataclass(frozen=True)
class Capture:
    """A scene as it was read from Blender, apart from it; `blocks` are those of the whole file."""

    things: list[Placed]
    warnings: list[str]
    view: visibility.View
    blocks: frozenset[tuple[str, str]]

    def prospect(self) -> Prospect:
        """Works out what the camera sees; nothing of Blender's data is read, so it may go on beside Blender."""
        geometry = assembled(self.things, self.warnings)
        named = {("object", name) for pair in geometry.objects for name in pair}
        named |= {("material", name) for name in geometry.materials}
        return Prospect(geometry, visibility.see(self.view, geometry), self.blocks & named)


@dataclass(frozen=True)
class Survey:
    """What is known about a scene before anything is changed.

    Attributes:
        scene: The scene.
        geometry: Everything that a render shows.
        seen: What the camera sees of it.
        chosen: (number of objects in the geometry,) bool: the subject.
        objects: The subject's objects, including the instancers that make it.
        pivot: The center of the subject's bounding box, world space, meters.
        low: Its least corner.
        high: Its greatest corner.
    """

    scene: bpy.types.Scene
    geometry: Geometry
    seen: visibility.Visibility
    chosen: np.ndarray
    objects: tuple[bpy.types.Object, ...]
    low: tuple[float, float, float]
    high: tuple[float, float, float]

    @property
    def pivot(self) -> tuple[float, float, float]:
        x, y, z = ((a + b) / 2 for a, b in zip(self.low, self.high, strict=True))
        return x, y, z


def refuse(scene: bpy.types.Scene) -> None:
    """Says no to a camera that cannot be worked with, before anything in the scene is touched.

    Raises:
        VibeError: The camera is panoramic, no camera at all, or nowhere. None is fine: we add one.
    """
    camera = scene.camera
    if camera is None:
        return
    remedy = "Choose a perspective or orthographic camera."
    if camera.type != "CAMERA":
        raise schema.VibeError(f"{camera.name}, through which the scene is seen, is no camera.", remedy)
    if camera.data.type not in ("PERSP", "ORTHO"):
        kind = {"PANO": "panoramic"}.get(camera.data.type, camera.data.type.lower())
        raise schema.VibeError(f"{camera.name} is a {kind} camera.", remedy)
    if not np.isfinite(np.array(camera.matrix_world)).all():
        raise schema.VibeError(f"{camera.name} has no usable place: it is not a number.", "Move it back.")


def capture(scene: bpy.types.Scene) -> Capture:
    """Reads what a render of the scene shows; nothing in it is changed.

    Raises:
        VibeError: There is no camera, or no usable one.
    """
    if scene.camera is None:
        raise schema.VibeError("The scene has no camera.", "Add one, and aim it at the subject.")
    refuse(scene)
    things, warnings = evaluated.look(scene, lambda depsgraph: collect(depsgraph, uv_of))
    return Capture(things, warnings, visibility.view(scene), blocks())


def blocks() -> frozenset[tuple[str, str]]:
    """Kind and name of the objects and materials that the file has now."""
    objects = (("object", o.name_full) for o in bpy.data.objects)
    return frozenset(objects) | {("material", m.name_full) for m in bpy.data.materials}


def survey(scene: bpy.types.Scene, choice: subject.Choice, prospect: Prospect | None = None) -> Survey:
    """Looks at the scene; nothing in it is changed.

    Args:
        scene: The scene.
        choice: How the subject is chosen.
        prospect: What the camera has before it, if that is known.

    Raises:
        VibeError: There is no mesh, no usable camera, no mesh in view, or no such subject.
    """
    known = prospect or capture(scene).prospect()
    geometry, seen = known.geometry, known.seen
    if not len(geometry.faces):
        raise schema.VibeError(
            "The scene has no mesh that a render shows.", "Add one, or unhide it for renders."
        )
    if (seen.object < 0).all():
        raise schema.VibeError("The camera sees no mesh.", "Point the scene's camera at the subject.")
    chosen = subject.choose(scene, geometry, seen, choice)
    boxes = geometry.boxes[chosen].astype(float)
    low, high = boxes[:, 0].min(0), boxes[:, 1].max(0)
    names = {n for keep, pair in zip(chosen, geometry.objects, strict=True) if keep for n in pair if n}
    objects = tuple(o for o in scene.objects if o.name_full in names)
    return Survey(scene, geometry, seen, chosen, objects, tuple(low.tolist()), tuple(high.tolist()))


def like(found: Survey, earlier: Survey) -> Survey:
    """A look at another shot of a scene, with the subject and the pivot of an earlier one.

    Raises:
        VibeError: The subject is hidden in this shot.
    """
    names = {o.name_full for o in earlier.objects}
    objects = found.geometry.objects
    chosen = np.array([name in names or parent in names for name, parent in objects])
    if not chosen.any():
        raise schema.VibeError(
            f"The subject ({', '.join(sorted(names))}) is hidden at frame {found.scene.frame_current}.",
            "Choose other frames, or name another --subject.",
        )
    return replace(found, chosen=chosen, objects=earlier.objects, low=earlier.low, high=earlier.high)
