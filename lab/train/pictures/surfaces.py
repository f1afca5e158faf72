# SPDX-License-Identifier: Apache-2.0
"""Surfaces that shapes are put together from."""

from typing import NamedTuple

import numpy as np
import trimesh


class Shape(NamedTuple):
    """Triangles (F, 3, 3) in units of the shape's height or so, z up, and their corner normals (F, 3, 3)."""

    triangles: np.ndarray
    normals: np.ndarray


_FLAT = 0.01
"""Difference of two corners' normals up to which a triangle is flat."""


def bent(shape: Shape) -> float:
    """Share of a shape's area that is curved: smooth triangles, whose corner normals differ."""
    a, b, c = np.moveaxis(shape.triangles, 1, 0)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    turn = np.linalg.norm(shape.normals - shape.normals[:, [1, 2, 0]], axis=2).max(1)
    return float(area[turn > _FLAT].sum() / max(area.sum(), 1e-12))


def merge(parts: list[Shape]) -> Shape:
    """All parts as one shape."""
    return Shape(np.concatenate([p.triangles for p in parts]), np.concatenate([p.normals for p in parts]))


def moved(part: Shape, rotation: np.ndarray, offset: tuple = (0.0, 0.0, 0.0)) -> Shape:
    """A shape that is turned, then moved.

    Args:
        part: The shape.
        rotation: (3, 3).
    """
    return Shape(part.triangles @ rotation.T + np.asarray(offset), part.normals @ rotation.T)


def smooth(mesh: trimesh.Trimesh) -> Shape:
    """The mesh with interpolated normals."""
    mesh.merge_vertices()
    return Shape(mesh.triangles.view(np.ndarray), mesh.vertex_normals[mesh.faces])


def flat(mesh: trimesh.Trimesh) -> Shape:
    """The mesh with one normal per face."""
    return Shape(mesh.triangles.view(np.ndarray), np.repeat(mesh.face_normals[:, None], 3, 1))


def grid(points: np.ndarray) -> Shape:
    """A smooth surface through a grid of points (n, m, 3)."""
    n, m, _ = points.shape
    i, j = np.meshgrid(np.arange(n - 1), np.arange(m - 1), indexing="ij")
    a, b, c, d = i * m + j, (i + 1) * m + j, (i + 1) * m + j + 1, i * m + j + 1
    faces = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
    mesh = trimesh.Trimesh(points.reshape(-1, 3), faces, process=False)
    return smooth(mesh)


def box(low: tuple, high: tuple) -> Shape:
    """An axis-aligned box with flat sides."""
    return flat(trimesh.creation.box(bounds=np.array([low, high])))


def ellipsoid(center: tuple, radii: tuple) -> Shape:
    """An ellipsoid with its axes along x, y and z."""
    mesh = trimesh.creation.icosphere(3)
    mesh.vertices = mesh.vertices * radii + np.asarray(center)
    return smooth(mesh)


def revolve(radius: np.ndarray, height: np.ndarray, sides: int = 48) -> Shape:
    """A surface of revolution around z.

    Args:
        radius: (n,), of the points of its profile.
        height: (n,), of the same points.
    """
    angle = np.linspace(0, 2 * np.pi, sides + 1)
    ring = np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], -1)
    return grid(ring[:, None] * radius[None, :, None] + height[None, :, None] * np.array([0, 0, 1.0]))


def tube(path: np.ndarray, radius: np.ndarray, sides: int = 14) -> Shape:
    """A round tube along a path, its cross-section carried along without twist.

    Args:
        path: (n, 3).
        radius: (n,), at each point.
    """
    tangent = np.gradient(path, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True) + 1e-9
    across = np.cross(tangent[0], [0.3, 0.5, 0.8])
    rings = []
    angle = np.linspace(0, 2 * np.pi, sides + 1)[:, None]
    for point, along, r in zip(path, tangent, radius, strict=True):
        across = across - along * (across @ along)
        across /= np.linalg.norm(across) + 1e-9
        rings.append(point + r * (np.cos(angle) * across + np.sin(angle) * np.cross(along, across)))
    return grid(np.stack(rings))


def smooth_sides(drum: trimesh.Trimesh) -> Shape:
    """A cylinder along z with a smooth side and flat caps."""
    normals = drum.triangles * [1, 1, 0]
    normals = normals / (np.linalg.norm(normals, axis=-1, keepdims=True) + 1e-9)
    caps = np.abs(drum.face_normals[:, 2]) > 0.5
    normals[caps] = drum.face_normals[caps][:, None]
    return Shape(drum.triangles.view(np.ndarray), normals)
