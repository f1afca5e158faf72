# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles of everything that a picture shows, in world space, from what was read of a scene. No bpy here."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

_FARTHEST = 1e9
"""Meters from the origin beyond which squares of areas leave the range of 32-bit floats."""


@dataclass(frozen=True)
class SourceMesh:
    """One mesh as Blender holds it, in its own space.

    Attributes:
        vertices: (V, 3) float32.
        corners: (C,) int32, the vertex of each corner.
        normals: (C, 3) float32, one per corner; custom normals are honored.
        triangles: (F, 3) int32, corners.
        slot: (F,) int32, the number of the material slot.
        solid: (S,) bool, which slots show a surface.
        uvs: For each slot the UVs that its material's texture reads, (C, 2) float32, and a 3x3 matrix for them;
            empty without a UV map.
    """

    vertices: np.ndarray
    corners: np.ndarray
    normals: np.ndarray
    triangles: np.ndarray
    slot: np.ndarray
    solid: np.ndarray
    uvs: list[tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class PlacedMesh:
    """A mesh at its place in the world.

    Attributes:
        mesh: The mesh, which instances share.
        materials: A name for each slot.
        matrix: (4, 4), to world space.
        owner: Name, and name of the object that it is an instance of or for, otherwise "".
    """

    mesh: SourceMesh
    materials: tuple[str, ...]
    matrix: np.ndarray
    owner: tuple[str, str]


@dataclass
class SceneGeometry:
    """All triangles of a scene.

    Attributes:
        vertices: (V, 3) float32, world space.
        faces: (F, 3) int32.
        normals: (F, 3, 3) float32, one per corner; custom normals are honored.
        uvs: (F, 3, 2) float32; zeros without a UV map.
        material: (F,) int32, number in `materials`.
        object: (F,) int32, number in `objects`.
        materials: Names; "" for faces without one.
        objects: (name, name of the object that it is an instance of or for, otherwise "").
        boxes: (N, 2, 3), the least and the greatest corner of each object.
        warnings: Notes about what was left out, in words for the artist.
    """

    vertices: np.ndarray
    faces: np.ndarray
    normals: np.ndarray
    uvs: np.ndarray
    material: np.ndarray
    object: np.ndarray
    materials: list[str]
    objects: list[tuple[str, str]]
    boxes: np.ndarray
    warnings: list[str]


def assembled(things: list[PlacedMesh], warnings: list[str]) -> SceneGeometry:
    """Puts all triangles in world space; those of slots without a surface are left out.

    Args:
        things: What a picture shows.
        warnings: Notes about what could not be read.
    """
    parts: dict[int, _Part] = {}
    result = _Builder(dict.fromkeys(warnings))
    for thing in things:
        part = parts.get(id(thing.mesh)) or parts.setdefault(id(thing.mesh), _part(thing.mesh))
        if len(part.faces):
            result.add(part, thing)
    return result.geometry()


@dataclass
class _Part:
    """Triangles of one mesh, in its own space; `slot` (F,) is the number of the material slot."""

    vertices: np.ndarray
    faces: np.ndarray
    normals: np.ndarray
    uvs: np.ndarray
    slot: np.ndarray

    def pick(self, faces: np.ndarray) -> _Part:
        """The same mesh with some of its faces, (F,) bool."""
        rest = (self.faces[faces], self.normals[faces], self.uvs[faces], self.slot[faces])
        return _Part(self.vertices, *rest)


def _part(mesh: SourceMesh) -> _Part:
    solid = mesh.solid[mesh.slot]
    corners, slot = mesh.triangles[solid], mesh.slot[solid]
    uvs = np.zeros((*corners.shape, 2), np.float32)
    for number, (layer, matrix) in enumerate(mesh.uvs):
        chosen = slot == number
        uvs[chosen] = layer[corners[chosen]] @ matrix[:2, :2].T + matrix[:2, 2]
    return _Part(mesh.vertices, mesh.corners[corners], mesh.normals[corners], uvs, slot)


class _Builder:
    """Gathers placed parts and numbers their materials and objects."""

    def __init__(self, warnings: dict[str, None]) -> None:
        self.pieces: list[tuple[np.ndarray, ...]] = []
        self.materials: dict[str, int] = {}
        self.objects: dict[tuple[str, str], int] = {}
        self.boxes: list[np.ndarray] = []
        self.warnings = warnings
        self.count = 0

    def add(self, part: _Part, thing: PlacedMesh) -> None:
        vertices, normals = _place(part, thing.matrix)
        usable = (np.abs(vertices) < _FARTHEST).all(1)  # also false for what is not a number
        if not usable.all():
            name = thing.owner[0]
            self.warnings[f"{name} has corners without a usable place: their faces are left out."] = None
            vertices[~usable] = 0.0
        corners = vertices[part.faces]
        whole = usable[part.faces].all(1) & _has_area(corners)
        if not whole.any():
            return
        owner = self._owner(thing.owner, corners[whole].reshape(-1, 3))
        part, normals = part.pick(whole), normals[whole]
        numbers = np.array(
            [self.materials.setdefault(n, len(self.materials)) for n in thing.materials], np.int32
        )
        # a mirrored instance keeps its winding counter-clockwise seen from outside
        order = [2, 1, 0] if np.linalg.det(thing.matrix[:3, :3]) < 0 else [0, 1, 2]
        faces, normals, uvs = part.faces[:, order] + self.count, normals[:, order], part.uvs[:, order]
        owners = np.full(len(faces), owner, np.int32)
        self.pieces.append((vertices, faces, normals, uvs, numbers[part.slot], owners))
        self.count += len(vertices)

    def _owner(self, who: tuple[str, str], points: np.ndarray) -> int:
        """The object's number; its box grows around the points, (P, 3)."""
        box = np.stack([points.min(0), points.max(0)])
        number = self.objects.setdefault(who, len(self.objects))
        if number == len(self.boxes):
            self.boxes.append(box)
        else:
            before = self.boxes[number]
            self.boxes[number] = np.stack([np.minimum(before[0], box[0]), np.maximum(before[1], box[1])])
        return number

    def geometry(self) -> SceneGeometry:
        if self.pieces:
            arrays = [np.concatenate(column) for column in zip(*self.pieces, strict=True)]
        else:
            shapes = ((0, 3), (0, 3), (0, 3, 3), (0, 3, 2), (0,), (0,))
            arrays = [np.zeros(shape, np.float32) for shape in shapes]
        vertices, faces, normals, uvs, material, owner = arrays
        boxes = np.array(self.boxes).reshape(-1, 2, 3)
        rest = list(self.materials), list(self.objects), boxes, list(self.warnings)
        return SceneGeometry(vertices, faces, normals, uvs, material, owner, *rest)


def _has_area(corners: np.ndarray) -> np.ndarray:
    """(F,) bool: whether triangles (F, 3, 3) are more than lines and points."""
    a, b, c = corners.astype(float).transpose(1, 2, 0)
    (x, y, z), (u, v, w) = b - a, c - a
    return (y * w != z * v) | (z * u != x * w) | (x * v != y * u)  # np.cross takes four times as long


def _place(part: _Part, matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and corner normals in world space."""
    linear = matrix[:3, :3]
    with np.errstate(invalid="ignore", over="ignore"):
        vertices = (part.vertices @ linear.T + matrix[:3, 3]).astype(np.float32)
    # Normals go with the inverse transpose; the cofactor matrix is that times the determinant, and
    # flattened objects have one too.
    a, b, c = linear
    cofactor = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)])
    normals = part.normals @ (cofactor.T * (-1 if np.linalg.det(linear) < 0 else 1))
    normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-12)
    return vertices, normals.astype(np.float32)
