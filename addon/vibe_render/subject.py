# SPDX-License-Identifier: GPL-3.0-or-later
"""What a picture is about: named objects, a collection, what is selected, or what the camera is pointed at."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from .chosen import recall
from .contract import schema
from .export_mesh import Geometry

_RAYS = 48  # along each side of the picture
_SLACK = 1e-3  # of a step between rays: what rounding may move a corner
_PROMINENT = 0.1  # of the most prominent object's weight: what is less is decoration
_FLAT = 0.35  # height over width of things that others stand on


@dataclass(frozen=True)
class Choice:
    """How the subject is chosen; with no field set, by what the picture shows.

    Attributes:
        objects: Names of objects or collections.
        selected: Take the selected objects.
    """

    objects: tuple[str, ...] = ()
    selected: bool = False

    @property
    def explicit(self) -> bool:
        """Whether somebody chose."""
        return self.selected or bool(self.objects)


@dataclass(frozen=True)
class Visibility:
    """What the camera sees through a coarse grid of rays.

    Attributes:
        object: (R, R) int, number of the object in the geometry, -1 for none; row 0 is the bottom.
        material: (R, R) int, likewise.
    """

    object: np.ndarray
    material: np.ndarray


def choose(scene: bpy.types.Scene, geometry: Geometry, seen: Visibility, choice: Choice) -> np.ndarray:
    """Which objects of the geometry are the subject: (number of objects,) bool, at least one True.

    Raises:
        VibeError: A name is unknown, or nothing of what was chosen shows in the render.
    """
    names = {o.name_full for o in named(scene, choice)}
    if not names:
        return automatic(scene, geometry, seen)
    chosen = np.array([name in names or parent in names for name, parent in geometry.objects])
    if not chosen.any():
        if not choice.explicit:  # what was chosen once is not in the picture now
            return automatic(scene, geometry, seen)
        raise schema.VibeError(
            "The chosen subject has no mesh that a render shows.", "Choose another object."
        )
    return chosen


def named(scene: bpy.types.Scene, choice: Choice) -> list[bpy.types.Object]:
    """The chosen objects, or those of the last choice, and everything below them; none if the choice is ours.

    Raises:
        VibeError: A name is unknown, or nothing is selected.
    """
    chosen: list[bpy.types.Object] = []
    for name in choice.objects:
        collection = next((c for c in scene.collection.children_recursive if c.name == name), None)
        if collection is None and name not in scene.objects:
            near = ", ".join(o.name for o in scene.objects if o.type == "MESH")[:200]
            raise schema.VibeError(f"There is no object or collection {name!r}.", f"There are: {near}.")
        chosen += collection.all_objects if collection else [scene.objects[name]]
    if choice.selected:
        chosen += [o for o in scene.objects if o.select_get()] or recall(scene)
        if not chosen:
            raise schema.VibeError("Nothing is selected.", "Select the subject, or leave the choice to us.")
    if not choice.explicit:
        chosen = recall(scene)
    return list(dict.fromkeys(o for thing in chosen for o in (thing, *thing.children_recursive)))


def see(scene: bpy.types.Scene, geometry: Geometry) -> Visibility:
    """Casts the camera's rays. All -1 for an empty geometry."""
    hits = np.full((_RAYS, _RAYS), -1)
    if len(geometry.faces):
        near = np.flatnonzero(_may_meet(scene, geometry))
        corners = geometry.vertices[geometry.faces[near]].reshape(-1, 3)
        faces = np.arange(len(corners)).reshape(-1, 3)
        tree = BVHTree.FromPolygons(corners.tolist(), faces.tolist(), all_triangles=True)
        starts, directions = camera_rays(scene, _RAYS)
        ahead = -np.array(scene.camera.matrix_world.normalized())[:3, 2]
        lens = scene.camera.data
        for index in np.ndindex(hits.shape):
            toward, slant = Vector(directions[index]), 1.0 / max(directions[index] @ ahead, 1e-6)
            start = Vector(starts[index]) + toward * (slant * lens.clip_start)
            face = tree.ray_cast(start, toward, slant * (lens.clip_end - lens.clip_start))[2]
            hits[index] = -1 if face is None else near[face]
    owner, material = (np.append(a, -1)[hits] for a in (geometry.object, geometry.material))
    return Visibility(owner, material)


def _may_meet(scene: bpy.types.Scene, geometry: Geometry) -> np.ndarray:
    """(F,) bool: triangles that a ray may meet. Most of a fine mesh lies between the rays, and need not be sorted."""
    camera = scene.camera
    frame = np.array(camera.data.view_frame(scene=scene))
    low, high = frame[:, :2].min(0), frame[:, :2].max(0)
    pose = np.array(camera.matrix_world.normalized().inverted())
    points = geometry.vertices @ pose[:3, :3].T + pose[:3, 3]
    places = points[:, :2]
    if camera.data.type != "ORTHO":
        places = places * (frame[0, 2] / np.minimum(points[:, 2:], -1e-6))
    column = ((places - low) / (high - low) * _RAYS - 0.5)[geometry.faces]  # (F, 3, 2), in rays
    first = np.ceil(np.maximum(column.min(1), 0) - _SLACK)
    last = np.floor(np.minimum(column.max(1), _RAYS - 1) + _SLACK)
    behind = (points[:, 2] > -1e-6)[geometry.faces].any(1)
    return (first <= last).all(1) | behind


def camera_rays(scene: bpy.types.Scene, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Origins and directions, (count, count, 3) each, of rays through the picture; row 0 is the bottom."""
    camera = scene.camera
    corners = np.array(camera.data.view_frame(scene=scene))  # (4, 3), camera space
    low, high = corners.min(0), corners.max(0)
    u = (np.arange(count) + 0.5) / count
    x, y = np.meshgrid(low[0] + u * (high[0] - low[0]), low[1] + u * (high[1] - low[1]))
    points = np.stack([x, y, np.full_like(x, corners[0, 2])], axis=-1)
    ahead = np.array([0.0, 0.0, -1.0])
    if camera.data.type == "ORTHO":
        starts, directions = points * (1, 1, 0), np.broadcast_to(ahead, points.shape)
    else:
        starts, directions = np.zeros_like(points), points
    pose = np.array(camera.matrix_world.normalized())
    directions = directions / np.linalg.norm(directions, axis=-1, keepdims=True)
    return starts @ pose[:3, :3].T + pose[:3, 3], directions @ pose[:3, :3].T


def automatic(scene: bpy.types.Scene, geometry: Geometry, seen: Visibility) -> np.ndarray:
    """The prominent things in view, without what they stand on or in front of: (number of objects,) bool.

    Surroundings are things that reach three sides of the picture, that enclose the camera, or that
    are flat and leave the picture or carry another thing.

    Raises:
        VibeError: The camera sees nothing.
    """
    count = len(geometry.objects)
    weight = np.array([(_centrality() * (seen.object == i)).sum() for i in range(count)])
    if not weight.any():
        raise schema.VibeError("The camera sees no mesh.", "Point the scene's camera at something.")
    boxes = np.array([_box(geometry, i) for i in range(count)])  # (N, 2, 3)
    visible = weight > 0
    apart = visible & ~_enclosing(scene, boxes) & (_borders(seen.object, count) < 3)
    apart &= ~_grounds(boxes, visible, _borders(seen.object, count))
    if not apart.any():  # a close-up fills the picture, and is what it is about
        apart = weight == weight.max()
    return apart & (weight >= _PROMINENT * weight[apart].max())


def _centrality() -> np.ndarray:
    """(R, R): how much a place in the picture matters, 1 in the middle."""
    u = (np.arange(_RAYS) + 0.5) / _RAYS * 2 - 1
    return np.exp(-1.5 * (u[:, None] ** 2 + u**2))


def _box(geometry: Geometry, number: int) -> tuple[np.ndarray, np.ndarray]:
    corners = geometry.vertices[np.unique(geometry.faces[geometry.object == number])]
    return corners.min(0), corners.max(0)


def _enclosing(scene: bpy.types.Scene, boxes: np.ndarray) -> np.ndarray:
    eye = np.array(scene.camera.matrix_world.translation)
    return ((boxes[:, 0] < eye) & (eye < boxes[:, 1])).all(1)


def _borders(owner: np.ndarray, count: int) -> np.ndarray:
    """(N,): on how many of the picture's four sides an object shows."""
    sides = (owner[0], owner[-1], owner[:, 0], owner[:, -1])
    return np.array([sum(bool((side == i).any()) for side in sides) for i in range(count)])


def _grounds(boxes: np.ndarray, visible: np.ndarray, borders: np.ndarray) -> np.ndarray:
    """(N,): flat things that leave the picture or that something visible stands on or in front of."""
    size = boxes[:, 1] - boxes[:, 0]
    widest = np.maximum(size.max(1), 1e-9)
    thin = size.min(1) < 0.02 * widest
    low = size[:, 2] < _FLAT * widest
    slack = 0.05 * widest[:, None]
    middle = boxes.mean(1)
    over = (boxes[:, None, 0, :2] < middle[None, :, :2]) & (middle[None, :, :2] < boxes[:, None, 1, :2])
    above = boxes[None, :, 0, 2] > boxes[:, None, 1, 2] - slack
    smaller = widest[None] < 0.7 * widest[:, None]
    carries = (over.all(2) & above & smaller & visible[None]).any(1)
    return (thin & (borders > 0)) | (low & carries)
