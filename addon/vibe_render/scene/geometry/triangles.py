# SPDX-License-Identifier: GPL-3.0-or-later
"""Assembles the meshes read from a scene to triangles in world space. Does not use bpy."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

FARTHEST = 1e9  # meters from the origin beyond which squares of areas leave the range of 32-bit floats
_BATCH = 1_000_000  # most vertices that are transformed at once for copies of a mesh; limits memory


@dataclass(frozen=True)
class SourceMesh:
    """One mesh as Blender holds it, in its own space."""

    vertices: np.ndarray  # (V, 3) float32
    corners: np.ndarray  # (C,) int32, the vertex of each corner
    normals: np.ndarray  # (C, 3) float32, one per corner; custom normals are honored
    triangles: np.ndarray  # (F, 3) int32, corners
    slot: np.ndarray  # (F,) int32, the number of the material slot
    solid: np.ndarray  # (S,) bool, which slots show a surface
    # for each slot the UVs that its material's texture reads, (C, 2) float32, and a 3x3 matrix for them; empty
    # without a UV map
    uvs: list[tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class PlacedMesh:
    """A mesh at its place in the world."""

    mesh: SourceMesh  # shared by instances
    materials: tuple[str, ...]  # a name for each slot
    matrix: np.ndarray  # (4, 4), to world space
    owner: tuple[str, str]  # name of the object, and of the object that instances it ("" for none)
    # kinds of rays that pass through it, by Blender's names: "camera", "shadow", …
    hidden: frozenset[str] = frozenset()


@dataclass
class SceneGeometry:
    """All triangles of a scene."""

    vertices: np.ndarray  # (V, 3) float32, world space
    faces: np.ndarray  # (F, 3) int32
    normals: np.ndarray  # (F, 3, 3) float32, one per corner; custom normals are honored
    uvs: np.ndarray  # (F, 3, 2) float32; zeros without a UV map
    material: np.ndarray  # (F,) int32, number in `materials`
    object: np.ndarray  # (F,) int32, number in `objects`
    materials: list[str]  # names; "" for faces without a material
    # (name, name of the object that instances it, "" for none)
    objects: list[tuple[str, str]]
    boxes: np.ndarray  # (N, 2, 3), the least and the greatest corner of each object
    hidden: list[frozenset[str]]  # for each object, the kinds of rays that pass through it
    warnings: list[str]  # notes about what was left out, in words for the artist

    @property
    def seen(self) -> np.ndarray:
        """(F,) bool: triangles that are not hidden from the camera."""
        return ~np.array(["camera" in rays for rays in self.hidden], bool)[self.object]


def assembled(things: list[PlacedMesh], warnings: list[str]) -> SceneGeometry:
    """The triangles of all placed meshes in world space, without those of slots that show no surface; adds to the warnings."""
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
        owners = np.full(len(piece.faces), owner, np.int32)
        rest = piece.normals, piece.uvs, by_slot[piece.slot], owners
        parts.append((piece.vertices, piece.faces + count, *rest))
        count += len(piece.vertices)
    vertices, faces, normals, uvs, material, owned = map(np.concatenate, zip(*parts, strict=True))
    names = [*materials], [*objects]
    extents = np.array(boxes).reshape(-1, 2, 3)
    return SceneGeometry(vertices, faces, normals, uvs, material, owned, *names, extents, hidden, [*notes])


@dataclass
class _Piece:
    """A placed mesh: arrays as in `SceneGeometry`, but `faces` count from its own vertices."""

    vertices: np.ndarray
    faces: np.ndarray
    normals: np.ndarray
    uvs: np.ndarray
    slot: np.ndarray  # (F,) numbers of material slots
    box: np.ndarray  # (2, 3), the least and the greatest corner
    broken: bool  # whether some vertices have no usable place


def _pieces(copies: list[PlacedMesh]) -> Iterator[_Piece]:
    """The placed copies of one mesh. Many are transformed at once, because a tree may have thousands of leaves."""
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
    step = max(1, _BATCH // len(mesh.vertices))
    for first in range(0, len(copies), step):
        matrices = np.stack([copy.matrix for copy in copies[first : first + step]])
        mirrored = np.linalg.det(matrices[:, :3, :3]) < 0
        vertices, normals = _place(mesh.vertices, own_normals, matrices, np.where(mirrored, -1.0, 1.0))
        x, y, z = np.moveaxis(np.abs(vertices) < FARTHEST, -1, 0)  # also false for NaN
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
    """World-space vertices (I, V, 3) and corner normals (I, F, 3, 3) of copies at matrices (I, 4, 4); sign -1 if mirrored."""
    linear = matrices[:, :3, :3]
    with np.errstate(invalid="ignore", over="ignore"):
        placed = vertices @ linear.transpose(0, 2, 1) + matrices[:, None, :3, 3]
        places = placed.astype(np.float32)
    # Normals transform by the inverse transpose. The cofactor matrix is the inverse transpose times the
    # determinant, and exists for flattened objects too.
    a, b, c = linear.transpose(1, 0, 2)
    cofactor = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=1)
    normals = normals @ (cofactor.transpose(0, 2, 1) * sign[:, None, None])[:, None]
    lengths = np.sqrt(np.einsum("...i,...i->...", normals, normals))  # np.linalg.norm takes ten times as long
    normals /= np.maximum(lengths, 1e-12)[..., None]
    return places, normals.astype(np.float32)
