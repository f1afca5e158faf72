# SPDX-License-Identifier: GPL-3.0-or-later
"""The subject of an image: named objects, a collection, the selection, the last subject, or the most prominent objects."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from bpy.types import Object, Scene

from ..core.schema_import import schema
from .geometry.triangles import RAYS, SceneGeometry, VisibleSurfaces

SUBJECT_KEY = "vibe_subject"


@dataclass(frozen=True)
class SubjectChoice:
    """The artist's choice of a subject: names of objects or collections, or the selection; without either, automatic."""

    objects: tuple[str, ...] = ()
    selected: bool = False

    @property
    def explicit(self) -> bool:
        """True if the artist has chosen a subject."""
        return self.selected or bool(self.objects)


def choose_subject(
    scene: Scene, geometry: SceneGeometry, surfaces: VisibleSurfaces, choice: SubjectChoice
) -> np.ndarray:
    """(N,) bool: True for the objects of the geometry that are the subject, at least one.

    Raises VibeError for an unknown name, or if the choice has no rendered mesh.
    """
    names = {o.name_full for o in named_objects(scene, choice)}
    chosen = np.array([name in names or parent in names for name, parent in geometry.objects])
    if chosen.any():
        return chosen
    if names and choice.explicit:
        raise schema.VibeError("The chosen subject has no mesh that a render shows.", "Choose another object.")
    return automatic_subject(scene, geometry, surfaces)  # no choice, or a stored subject that is not in the image now


def named_objects(scene: Scene, choice: SubjectChoice) -> list[Object]:
    """The chosen objects with their children; without a choice, those of the stored subject, if any.

    Raises VibeError for an unknown name, or if the selection is chosen and nothing is selected or stored.
    """
    chosen: list[Object] = []
    for name in choice.objects:
        collection = next((c for c in scene.collection.children_recursive if c.name == name), None)
        if collection is None and name not in scene.objects:
            near = ", ".join(o.name for o in scene.objects if o.type == "MESH")[:200]
            raise schema.VibeError(f"There is no object or collection {name!r}.", f"There are: {near}.")
        chosen += collection.all_objects if collection else [scene.objects[name]]
    if choice.selected:
        chosen += [o for o in scene.objects if o.select_get()] or recall_subject(scene)
        if not chosen:
            raise schema.VibeError("Nothing is selected.", "Select the subject, or leave the choice to us.")
    if not choice.explicit:
        chosen = recall_subject(scene)
    return list(dict.fromkeys(o for thing in chosen for o in (thing, *thing.children_recursive)))


def automatic_subject(scene: Scene, geometry: SceneGeometry, surfaces: VisibleSurfaces) -> np.ndarray:
    """(N,) bool: True for objects of the geometry that are prominent in view, without grounds and backdrops."""
    count = len(geometry.objects)
    seen = surfaces.object >= 0
    # The middle of the image counts most: the weights of the rays are (R, R).
    u = (np.arange(RAYS) + 0.5) / RAYS * 2 - 1
    centrality = np.exp(-1.5 * (u[:, None] ** 2 + u**2))
    weight = np.bincount(surfaces.object[seen], centrality[seen], minlength=count)
    visible = weight > 0
    # For each object, the number of the image's four sides at which it is visible.
    owner = surfaces.object
    shown = np.concatenate([np.unique(side) for side in (owner[0], owner[-1], owner[:, 0], owner[:, -1])])
    borders = np.bincount(shown[shown >= 0], minlength=count)
    eye = np.array(scene.camera.matrix_world.translation)
    enclosing = ((geometry.boxes[:, 0] < eye) & (eye < geometry.boxes[:, 1])).all(1)
    # Surroundings are objects that reach three sides of the image or enclose the camera, and grounds.
    loose = visible & ~enclosing & (borders < 3)
    apart = loose.copy()  # compares visible objects only: a scene may have thousands
    apart[visible] &= ~_grounds(geometry.boxes[visible], borders[visible])
    if not apart.any():  # a close-up: the object that fills the image is the subject
        apart = weight == weight.max()
    subject = apart & (weight >= 0.1 * weight[apart].max())  # with less weight, an object is decoration
    # Objects inside the subject's bounding box are parts of it.
    low, high = geometry.boxes[subject, 0].min(0), geometry.boxes[subject, 1].max(0)
    slack = 0.02 * (high - low).max()  # a part may stick out a little
    within = ((geometry.boxes[:, 0] >= low - slack) & (geometry.boxes[:, 1] <= high + slack)).all(1)
    return subject | (loose & ~_thin(geometry.boxes) & within)


def _grounds(boxes: np.ndarray, borders: np.ndarray) -> np.ndarray:
    """(N,) bool: True for grounds: thin objects at the image's border, and flat objects that carry a smaller object.

    `boxes` (N, 2, 3) are bounding boxes; `borders` (N,) are the numbers of image sides that the objects reach.
    """
    size = boxes[:, 1] - boxes[:, 0]
    widest = np.maximum(size.max(1), 1e-9)
    low = size[:, 2] < 0.35 * widest  # flat enough that others may stand on it
    slack = 0.05 * widest[:, None]
    middle = boxes.mean(1)
    over = (boxes[:, None, 0, :2] < middle[None, :, :2]) & (middle[None, :, :2] < boxes[:, None, 1, :2])
    above = boxes[None, :, 0, 2] > boxes[:, None, 1, 2] - slack
    smaller = widest[None] < 0.7 * widest[:, None]
    carries = (over.all(2) & above & smaller).any(1)
    return (_thin(boxes) & (borders > 0)) | (low & carries)


def _thin(boxes: np.ndarray) -> np.ndarray:
    """(N,) bool: True for objects whose shortest side is below 2 % of the longest: cloths, leaves, planes."""
    size = boxes[:, 1] - boxes[:, 0]
    return size.min(1) < 0.02 * np.maximum(size.max(1), 1e-9)


def remember_subject(scene: Scene, subject: Iterable[Object], choice: SubjectChoice) -> None:
    """Stores the names of a subject's objects in the scene if the artist has chosen them; else does nothing."""
    if choice.explicit:
        scene[SUBJECT_KEY] = json.dumps([thing.name_full for thing in subject])


def recall_subject(scene: Scene) -> list[Object]:
    """The stored subject's objects that still exist; empty without a stored subject."""
    try:
        names = json.loads(scene.get(SUBJECT_KEY, "[]"))
    except (TypeError, ValueError):  # not a list that was stored here
        return []
    stored = {name for name in names if isinstance(name, str)} if isinstance(names, list) else set()
    return [thing for thing in scene.objects if thing.name_full in stored]


def forget_subject(scene: Scene) -> None:
    """Forgets the stored subject: the next one is found automatically."""
    scene.pop(SUBJECT_KEY, None)
