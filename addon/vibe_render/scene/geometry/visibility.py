# SPDX-License-Identifier: GPL-3.0-or-later
"""Visibility: which triangles a camera sees, by a coarse grid of rays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from bpy.types import Scene
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from ...core.rendered import FILM
from .triangles import SceneGeometry

RAYS = 48  # along each side of the image
_SLACK = 1e-3  # in steps between rays: how far rounding may move a corner


@dataclass(frozen=True)
class RayCamera:
    """The values of a camera that its rays depend on, copied from Blender's data."""

    frame: np.ndarray  # (4, 3), the corners of its image, camera space
    pose: np.ndarray  # (4, 4), to world space, without scale
    flat: bool  # whether it is orthographic
    clip: tuple[float, float]  # nearest and farthest depth that it sees, meters


@dataclass(frozen=True)
class VisibleSurfaces:
    """The surface that each of R x R rays meets (R = `RAYS`); row 0 is the bottom of the image."""

    object: np.ndarray  # (R, R) int, index into the geometry's objects, -1 for none
    material: np.ndarray  # (R, R) int, index into its materials, -1 for none


def ray_camera(scene: Scene) -> RayCamera:
    """The scene's camera, copied."""
    lens, pose = scene.camera.data, np.array(scene.camera.matrix_world.normalized())
    frame = np.array(lens.view_frame(scene=scene))
    return RayCamera(frame, pose, lens.type == "ORTHO", (lens.clip_start, lens.clip_end))


def visible_surfaces(camera: RayCamera, geometry: SceneGeometry) -> VisibleSurfaces:
    """Casts the camera's rays at triangles; does not read Blender's data. All -1 for an empty geometry."""
    hits = np.full((RAYS, RAYS), -1)
    if len(geometry.faces):
        # A fine mesh lies mostly between the rays: leaving out triangles that no ray may meet makes a small tree.
        low, high = camera.frame[:, :2].min(0), camera.frame[:, :2].max(0)
        pose = np.linalg.inv(camera.pose)
        points = geometry.vertices @ pose[:3, :3].T + pose[:3, 3]
        positions = points[:, :2]
        if not camera.flat:
            positions = positions * (camera.frame[0, 2] / np.minimum(points[:, 2:], -1e-6))
        column = ((positions - low) / (high - low) * RAYS - 0.5)[geometry.faces]  # (F, 3, 2), in rays
        left = np.ceil(np.maximum(column.min(1), 0) - _SLACK)
        right = np.floor(np.minimum(column.max(1), RAYS - 1) + _SLACK)
        behind = (points[:, 2] > -1e-6)[geometry.faces].any(1)
        near = np.flatnonzero(((left <= right).all(1) | behind) & geometry.seen)
        corners = geometry.vertices[geometry.faces[near]].reshape(-1, 3)
        faces = np.arange(len(corners)).reshape(-1, 3)
        tree = BVHTree.FromPolygons(corners.tolist(), faces.tolist(), all_triangles=True)
        starts, directions = camera_rays(camera, RAYS)
        slants = 1.0 / np.maximum(directions @ -camera.pose[:3, 2], 1e-6)
        first, last = camera.clip
        for index in np.ndindex(hits.shape):
            toward, slant = Vector(directions[index]), slants[index]
            start = Vector(starts[index]) + toward * (slant * first)
            face = tree.ray_cast(start, toward, slant * (last - first))[2]
            hits[index] = -1 if face is None else near[face]
        holdout = np.array([FILM in rays for rays in geometry.hidden], bool)[geometry.object]
        hits[holdout[hits]] = -1  # -1 indexes the last face, but stays -1
    owner, material = (np.append(a, -1)[hits] for a in (geometry.object, geometry.material))
    return VisibleSurfaces(owner, material)


def camera_rays(camera: RayCamera, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Origins and directions in world space, (count, count, 3) each, of rays through the image; row 0 is the bottom."""
    low, high = camera.frame.min(0), camera.frame.max(0)
    u = (np.arange(count) + 0.5) / count
    x, y = np.meshgrid(low[0] + u * (high[0] - low[0]), low[1] + u * (high[1] - low[1]))
    points = np.stack([x, y, np.full_like(x, camera.frame[0, 2])], axis=-1)
    ahead = np.array([0.0, 0.0, -1.0])
    if camera.flat:
        starts, directions = points * (1, 1, 0), np.broadcast_to(ahead, points.shape)
    else:
        starts, directions = np.zeros_like(points), points
    directions = directions / np.linalg.norm(directions, axis=-1, keepdims=True)
    return starts @ camera.pose[:3, :3].T + camera.pose[:3, 3], directions @ camera.pose[:3, :3].T
