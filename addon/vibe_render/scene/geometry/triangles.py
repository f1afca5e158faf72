# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles in world space: assembled from meshes, and seen by a camera through a coarse grid of rays.

All but `ray_camera`, which reads Blender's data, may run in a thread.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from bpy.types import Scene
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from ...core.rendered import FILM

RAYS = 48  # along each side of the image
_SLACK = 1e-3  # in steps between rays: how far rounding may move a corner


@dataclass(frozen=True)
class SourceMesh:
    """One mesh as Blender stores it, in object space."""

    vertices: np.ndarray  # (V, 3) float32
    corners: np.ndarray  # (C,) int32, the vertex of each corner
    normals: np.ndarray  # (C, 3) float32, one per corner; custom normals are honored
    triangles: np.ndarray  # (F, 3) int32, indices of corners
    slot: np.ndarray  # (F,) int32, index of the material slot
    solid: np.ndarray  # (S,) bool, which slots show a surface
    # for each slot the UVs that its texture reads, (C, 2) float32, and a 3x3 matrix for them; empty without a UV map
    uvs: list[tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class PlacedMesh:
    """A mesh at its place in the world."""

    mesh: SourceMesh  # shared by instances
    materials: tuple[str, ...]  # a name for each slot
    matrix: np.ndarray  # (4, 4), to world space
    owner: tuple[str, str]  # name of the object, and of the object that instances it ("" for none)
    hidden: frozenset[str] = frozenset()  # the kinds of rays that pass through it: "camera", "shadow", …


@dataclass
class SceneGeometry:
    """All triangles of a scene."""

    vertices: np.ndarray  # (V, 3) float32, world space
    faces: np.ndarray  # (F, 3) int32, indices of vertices
    normals: np.ndarray  # (F, 3, 3) float32, one per corner; custom normals are honored
    uvs: np.ndarray  # (F, 3, 2) float32; zeros without a UV map
    material: np.ndarray  # (F,) int32, index into `materials`
    object: np.ndarray  # (F,) int32, index into `objects`
    materials: list[str]  # names; "" for faces without a material
    objects: list[tuple[str, str]]  # name, and name of the object that instances it ("" for none)
    boxes: np.ndarray  # (N, 2, 3), the least and the greatest corner of each object
    hidden: list[frozenset[str]]  # for each object, the kinds of rays that pass through it
    warnings: list[str]  # notes about what was left out, in words for the artist

    @property
    def seen(self) -> np.ndarray:
        """(F,) bool: triangles that are not hidden from the camera."""
        return ~np.array(["camera" in rays for rays in self.hidden], bool)[self.object]


def assembled(things: list[PlacedMesh], warnings: list[str]) -> SceneGeometry:
    """World-space triangles of all placed meshes, without slots that show no surface; has `warnings` and new ones."""
    copies: dict[int, list[int]] = {}
    for number, thing in enumerate(things):
        copies.setdefault(id(thing.mesh), []).append(number)
    pieces: dict[int, _Piece] = {}
    for numbers in copies.values():
        pieces.update(zip(numbers, _pieces([things[n] for n in numbers]), strict=False))
    notes = dict.fromkeys(warnings)
    materials: dict[str, int] = {}
    objects: dict[tuple[str, str], int] = {}
    boxes: list[np.ndarray] = []
    hidden: list[frozenset[str]] = []
    shapes = ((0, 3), (0, 3), (0, 3, 3), (0, 3, 2), (0,), (0,))
    kinds = (np.float32, np.int32, np.float32, np.float32, np.int32, np.int32)
    parts = [tuple(map(np.zeros, shapes, kinds))]  # so that concatenation works without meshes
    count = 0
    # Number materials and objects in the order of the placed meshes; the box of an object grows by each of its meshes.
    for number in sorted(pieces):
        piece, thing = pieces[number], things[number]
        if piece.broken:
            notes[f"{thing.owner[0]} has corners without a usable place: their faces are left out."] = None
        if not len(piece.faces):
            continue
        by_slot = np.array([materials.setdefault(n, len(materials)) for n in thing.materials], np.int32)
        owner = objects.setdefault(thing.owner, len(objects))
        if owner == len(boxes):
            boxes.append(piece.box)
            hidden.append(thing.hidden)
        else:
            low, high = boxes[owner]
            boxes[owner] = np.stack([np.minimum(low, piece.box[0]), np.maximum(high, piece.box[1])])
        rest = piece.normals, piece.uvs, by_slot[piece.slot], np.full(len(piece.faces), owner, np.int32)
        parts.append((piece.vertices, piece.faces + count, *rest))
        count += len(piece.vertices)
    vertices, faces, normals, uvs, material, owned = map(np.concatenate, zip(*parts, strict=True))
    names = [*materials], [*objects]
    extents = np.array(boxes).reshape(-1, 2, 3)
    return SceneGeometry(vertices, faces, normals, uvs, material, owned, *names, extents, hidden, [*notes])


@dataclass
class _Piece:
    """A placed mesh: arrays as in `SceneGeometry`, but `faces` are indices into this mesh's own `vertices`."""

    vertices: np.ndarray
    faces: np.ndarray
    normals: np.ndarray
    uvs: np.ndarray
    slot: np.ndarray  # (F,) numbers of material slots
    box: np.ndarray  # (2, 3), the least and the greatest corner
    broken: bool  # whether some vertices have no usable place


def _pieces(copies: list[PlacedMesh]) -> Iterator[_Piece]:
    """Yields a piece for each placed copy of one mesh; transforms many copies, such as a tree's leaves, at once."""
    mesh = copies[0].mesh
    solid = mesh.solid[mesh.slot]
    corners, slot = mesh.triangles[solid], mesh.slot[solid]
    if not len(corners):
        return
    faces, own_normals = mesh.corners[corners], mesh.normals[corners]
    uvs = np.zeros((*corners.shape, 2), np.float32)
    for number, (layer, matrix) in enumerate(mesh.uvs):
        chosen = slot == number
        uvs[chosen] = layer[corners[chosen]] @ matrix[:2, :2].T + matrix[:2, 2]
    step = max(1, 1_000_000 // len(mesh.vertices))  # a million vertices at once: limits memory
    for first in range(0, len(copies), step):
        matrices = np.stack([copy.matrix for copy in copies[first : first + step]])
        mirrored = np.linalg.det(matrices[:, :3, :3]) < 0
        vertices, normals = _place(mesh.vertices, own_normals, matrices, np.where(mirrored, -1.0, 1.0))
        # Farther away, squares of areas leave the range of 32-bit floats. False for NaN, too.
        x, y, z = np.moveaxis(np.abs(vertices) < 1e9, -1, 0)
        usable = x & y & z
        vertices[~usable] = 0.0
        points = vertices[:, faces]
        # Triangles that are only lines or points have no cross product; np.cross takes four times as long.
        a, b, c = np.moveaxis(points.astype(float), -2, 0)
        (x, y, z), (u, v, w) = np.moveaxis(b - a, -1, 0), np.moveaxis(c - a, -1, 0)
        whole = (y * w != z * v) | (z * u != x * w) | (x * v != y * u)
        if not usable.all():
            whole &= usable[:, faces].all(2)
        boxes = np.stack([points.min((1, 2)), points.max((1, 2))], axis=1)
        for copy in range(len(matrices)):
            complete = whole[copy].all()
            keep = slice(None) if complete else whole[copy]
            # a mirrored copy keeps its winding counter-clockwise seen from outside
            order = slice(None, None, -1 if mirrored[copy] else 1)
            kept = points[copy][keep].reshape(-1, 3)
            yield _Piece(
                vertices[copy],
                faces[keep][:, order],
                normals[copy][keep][:, order],
                uvs[keep][:, order],
                slot[keep],
                boxes[copy] if complete or not len(kept) else np.stack([kept.min(0), kept.max(0)]),
                not usable[copy].all(),
            )


def _place(
    vertices: np.ndarray, normals: np.ndarray, matrices: np.ndarray, sign: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (I, V, 3) and corner normals (I, F, 3, 3) in world space, for matrices (I, 4, 4); sign -1 if mirrored."""
    linear = matrices[:, :3, :3]
    with np.errstate(invalid="ignore", over="ignore"):
        places = (vertices @ linear.transpose(0, 2, 1) + matrices[:, None, :3, 3]).astype(np.float32)
    # Normals transform by the inverse transpose. The cofactor matrix is the inverse transpose times the
    # determinant, and exists for flattened objects too.
    a, b, c = linear.transpose(1, 0, 2)
    cofactor = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=1)
    normals = normals @ (cofactor.transpose(0, 2, 1) * sign[:, None, None])[:, None]
    lengths = np.sqrt(np.einsum("...i,...i->...", normals, normals))  # np.linalg.norm takes ten times as long
    normals /= np.maximum(lengths, 1e-12)[..., None]
    return places, normals.astype(np.float32)


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
    material: np.ndarray  # (R, R) int, index into the geometry's materials, -1 for none


def ray_camera(scene: Scene) -> RayCamera:
    """The values of the scene's camera, for use in a thread."""
    lens, pose = scene.camera.data, np.array(scene.camera.matrix_world.normalized())
    frame = np.array(lens.view_frame(scene=scene))
    return RayCamera(frame, pose, lens.type == "ORTHO", (lens.clip_start, lens.clip_end))


def visible_surfaces(camera: RayCamera, geometry: SceneGeometry) -> VisibleSurfaces:
    """The surfaces that the camera's rays meet first; all -1 for an empty geometry. Does not read Blender's data."""
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
