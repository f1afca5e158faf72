# SPDX-License-Identifier: GPL-3.0-or-later
"""Planar captures: flat grounds and walls rendered straight on, because mirrors show parts outside the picture."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Matrix

_FLAT = 1e-4  # deviation, in parts of the extent, that counts as flat
_REACH = 3.0  # times the camera's distance from the subject: patterns beyond are too small to be told apart


@dataclass(frozen=True)
class CapturePlane:
    """A square of a flat surface: center (3,), axes right, up and out (3, 3) in columns, and side in meters."""

    center: np.ndarray
    axes: np.ndarray
    side: float

    @property
    def mapping(self) -> list[list[float]]:
        """2 rows (4,) that take a point (x, y, z, 1) to the square, [0, 1] from its lower left."""
        rows = self.axes.T[:2] / self.side
        return np.column_stack((rows, 0.5 - rows @ self.center)).tolist()


def capture_plane(corners: np.ndarray, pivot: np.ndarray, distance: float) -> CapturePlane | None:
    """The square that triangles of one plane fill.

    Args:
        corners: (F, 3, 3), world space, meters.
        pivot: (3,), the pivot of the scene's orbits.
        distance: From the camera to the pivot, meters.

    Returns:
        None if the triangles do not lie in one plane.
    """
    edges = corners[:, 1:] - corners[:, :1]
    areas = np.cross(edges[:, 0], edges[:, 1])
    out = areas[np.argmax(np.linalg.norm(areas, axis=1))]
    out = out / max(np.linalg.norm(out), 1e-20)
    points = corners.reshape(-1, 3)
    extent = float(np.ptp(points, axis=0).max())
    if extent <= 0 or np.abs((points - points[0]) @ out).max() > _FLAT * extent:
        return None
    helper = np.array([1.0, 0.0, 0.0]) if abs(out[0]) < 0.7 else np.array([0.0, 1.0, 0.0])
    right = helper - out * (helper @ out)
    right /= np.linalg.norm(right)
    axes = np.column_stack((right, np.cross(out, right), out))
    flat = (points - pivot) @ axes
    low, high = (
        np.clip(f(flat, axis=0)[:2], -_REACH * distance, _REACH * distance) for f in (np.min, np.max)
    )
    if (high - low).min() <= 0:
        return None
    middle = np.append((low + high) / 2, flat[0, 2])
    return CapturePlane(pivot + axes @ middle, axes, float((high - low).max()))


@contextmanager
def straight_on(scene: bpy.types.Scene, plane: CapturePlane) -> Iterator[None]:
    """Gives a scene a camera that sees a plane and nothing in front of or behind it, inside the block."""
    data = bpy.data.cameras.new("Vibe Bake")
    camera = bpy.data.objects.new("Vibe Bake", data)
    scene.collection.objects.link(camera)
    data.type, data.ortho_scale = "ORTHO", plane.side
    above = max(plane.side, 1e-3)
    data.clip_start, data.clip_end = above * (1 - 1e-3), above * (1 + 1e-3)
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = plane.axes, plane.center + plane.axes[:, 2] * above
    camera.matrix_world = Matrix(pose.tolist())
    scene.camera = camera
    try:
        yield
    finally:
        bpy.data.objects.remove(camera)
        bpy.data.cameras.remove(data)
