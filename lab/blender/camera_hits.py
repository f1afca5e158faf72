# SPDX-License-Identifier: GPL-3.0-or-later
"""Camera hits: distance, normal, object and material at every ray of a picture, as a file for measurements."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree
from vibe_render.core.schema_import import atomic
from vibe_render.export.analysis import SceneAnalysis
from vibe_render.scene.geometry.triangles import camera_rays, ray_camera


def save_camera_hits(analysis: SceneAnalysis, path: Path, count: int) -> None:
    """Casts a ray through every cell of a grid and writes its first hit; fog is ignored.

    The file holds, row 0 at the top: `depth` (N, N), meters, infinite for nothing; `normal` (N, N, 3), in the
    camera's space: x to the right, y up, z towards the camera; `subject` (N, N) bool; `object` and `material`
    (N, N), numbers in `objects` and `materials`, -1 for nothing.

    Args:
        analysis: The scene; its camera is taken as it is now.
        count: Rays along each side of the picture.
    """
    geometry = analysis.geometry
    seen = np.flatnonzero(geometry.seen)
    faces = geometry.faces[seen].tolist()
    tree = BVHTree.FromPolygons(geometry.vertices.tolist(), faces, all_triangles=True)
    starts, directions = camera_rays(ray_camera(analysis.scene), count)
    face = np.full((count, count), -1)
    depth = np.full((count, count), np.inf, np.float32)
    for index in np.ndindex(face.shape):
        _, _, hit, away = tree.ray_cast(Vector(starts[index]), Vector(directions[index]))
        if hit is not None:
            face[index], depth[index] = seen[hit], away
    mean = geometry.normals.mean(1)
    mean /= np.maximum(np.linalg.norm(mean, axis=1, keepdims=True), 1e-9)
    toward = np.array(analysis.scene.camera.matrix_world.normalized())[:3, :3]
    normal = np.append(mean, np.zeros((1, 3)), 0)[face] @ toward
    normal *= np.where(np.sum(normal * (directions @ toward), -1, keepdims=True) > 0, -1.0, 1.0)  # two-sided
    grids: dict[str, Any] = {
        "depth": depth,
        "normal": normal.astype(np.float16),
        "subject": np.append(analysis.is_subject, False)[np.append(geometry.object, -1)[face]],
        "object": np.append(geometry.object, -1)[face].astype(np.int16),
        "material": np.append(geometry.material, -1)[face].astype(np.int16),
    }
    names: dict[str, Any] = {
        "objects": np.array([name for name, _ in geometry.objects]),
        "materials": np.array(geometry.materials),
    }
    with atomic.replacing(path) as part, part.open("wb") as file:
        np.savez_compressed(file, **{k: v[::-1] for k, v in grids.items()}, **names)
