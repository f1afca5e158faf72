# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles of everything that a final render shows, in world space."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import bpy
import numpy as np

from .compat import node_tree

DEFAULT_MATERIAL = ""
"""Name that stands for faces without a material."""

UvOf = Callable[[bpy.types.Material], tuple[str, np.ndarray]]
"""For a material: the name of its UV map ("" for the active one), and a 3x3 matrix applied to the UVs."""

_SKIPPED = {"CURVES": "hair", "VOLUME": "a volume object", "POINTCLOUD": "a point cloud"}

_FARTHEST = 1e9
"""Meters from the origin beyond which squares of areas leave the range of 32-bit floats."""


@dataclass
class Geometry:
    """All triangles of a scene.

    Attributes:
        vertices: (V, 3) float32, world space.
        faces: (F, 3) int32.
        normals: (F, 3, 3) float32, one per corner; custom normals are honored.
        uvs: (F, 3, 2) float32; zeros without a UV map.
        material: (F,) int32, number in `materials`.
        object: (F,) int32, number in `objects`.
        materials: Names; `DEFAULT_MATERIAL` for faces without one.
        objects: (name, name of the object that it is an instance of or for, otherwise "").
        warnings: What could not be brought along.
    """

    vertices: np.ndarray
    faces: np.ndarray
    normals: np.ndarray
    uvs: np.ndarray
    material: np.ndarray
    object: np.ndarray
    materials: list[str] = field(default_factory=list)
    objects: list[tuple[str, str]] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)


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


def collect(depsgraph: bpy.types.Depsgraph, uv_of: UvOf) -> Geometry:
    """Reads the evaluated meshes and instances of a final render's dependency graph."""
    parts: dict[tuple, _Part] = {}
    result = _Builder()
    for instance in depsgraph.object_instances:
        thing = instance.object
        if thing.type in _SKIPPED and instance.show_self:
            result.warnings[f"{thing.name} is {_SKIPPED[thing.type]}: the prediction leaves it out."] = None
        if instance.show_self and thing.type == "MESH":
            result.warnings.update(dict.fromkeys(_special(thing)))
        # Curves, texts and metaballs come once as themselves and once as the mesh that they become.
        if thing.type != "MESH" or not instance.show_self or not thing.visible_camera:
            continue
        slots = _materials(thing)
        key = (thing.data.as_pointer(), *(m.name_full if m else "" for m in slots))
        part = parts.get(key) or parts.setdefault(key, _read(thing.data, slots, uv_of))
        if len(part.faces):
            parent = instance.parent.original.name_full if instance.parent else ""
            result.add(part, slots, np.array(instance.matrix_world), (thing.original.name_full, parent))
    return result.geometry()


def _special(thing: bpy.types.Object) -> list[str]:
    """Ways of being rendered that the prediction does not know, in words."""
    found = []
    if not thing.visible_camera:
        found.append(
            f"{thing.name} is hidden from the camera: the prediction leaves it out, shadows and all."
        )
    elif thing.is_holdout or thing.is_shadow_catcher:
        kind = "a holdout" if thing.is_holdout else "a shadow catcher"
        found.append(f"{thing.name} is {kind}: the prediction shows it as a plain surface.")
    elif not all((thing.visible_diffuse, thing.visible_glossy, thing.visible_shadow)):
        found.append(f"{thing.name} is hidden from some rays: the prediction shows it to all.")
    return found


class _Builder:
    """Gathers placed parts and numbers their materials and objects."""

    def __init__(self) -> None:
        self.pieces: list[tuple[np.ndarray, ...]] = []
        self.materials: dict[str, int] = {}
        self.objects: dict[tuple[str, str], int] = {}
        self.warnings: dict[str, None] = {}
        self.count = 0

    def add(
        self, part: _Part, slots: list[bpy.types.Material | None], matrix: np.ndarray, who: tuple[str, str]
    ) -> None:
        vertices, normals = _place(part, matrix)
        usable = (np.abs(vertices) < _FARTHEST).all(1)  # also false for what is not a number
        if not usable.all():
            self.warnings[f"{who[0]} has corners without a usable place: their faces are left out."] = None
            vertices[~usable] = 0.0
        whole = usable[part.faces].all(1) & _has_area(vertices[part.faces])
        if not whole.any():
            return
        part, normals = part.pick(whole), normals[whole]
        names = [m.name_full if m else DEFAULT_MATERIAL for m in slots]
        numbers = np.array([self.materials.setdefault(n, len(self.materials)) for n in names], np.int32)
        owner = self.objects.setdefault(who, len(self.objects))
        # a mirrored instance keeps its winding counter-clockwise seen from outside
        order = [2, 1, 0] if np.linalg.det(matrix[:3, :3]) < 0 else [0, 1, 2]
        faces, normals, uvs = part.faces[:, order] + self.count, normals[:, order], part.uvs[:, order]
        owners = np.full(len(faces), owner, np.int32)
        self.pieces.append((vertices, faces, normals, uvs, numbers[part.slot], owners))
        self.count += len(vertices)

    def geometry(self) -> Geometry:
        if self.pieces:
            arrays = [np.concatenate(column) for column in zip(*self.pieces, strict=True)]
        else:
            shapes = ((0, 3), (0, 3), (0, 3, 3), (0, 3, 2), (0,), (0,))
            arrays = [np.zeros(shape, np.float32) for shape in shapes]
        vertices, faces, normals, uvs, material, owner = arrays
        names = list(self.materials), list(self.objects), list(self.warnings)
        return Geometry(vertices, faces, normals, uvs, material, owner, *names)


def _materials(thing: bpy.types.Object) -> list[bpy.types.Material | None]:
    """What the slots hold; at least one slot, which may hold nothing."""
    slots = [slot.material for slot in thing.material_slots] or list(thing.data.materials)
    return [m.original if m else None for m in slots] or [None]


def has_surface(material: bpy.types.Material | None) -> bool:
    """Whether a material shows a surface; a box of fog has none."""
    tree = node_tree(material) if material else None
    output = tree.get_output_node("CYCLES") if tree else None
    return output is None or output.inputs["Surface"].is_linked or not output.inputs["Volume"].is_linked


def _read(mesh: bpy.types.Mesh, slots: list[bpy.types.Material | None], uv_of: UvOf) -> _Part:
    """The triangles of a mesh; those of materials without a surface are left out."""
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    loops = _array(mesh.loop_triangles, "loops", (count, 3), np.int32)
    slot = _array(mesh.loop_triangles, "material_index", (count,), np.int32)
    # Blender shows faces whose slot does not exist in the last one.
    slot = np.clip(slot, 0, len(slots) - 1)
    solid = np.array([has_surface(m) for m in slots])[slot]
    loops, slot = loops[solid], slot[solid]
    corner_vertex = _array(mesh.loops, "vertex_index", (len(mesh.loops),), np.int32)
    normals = _array(mesh.corner_normals, "vector", (len(mesh.loops), 3), np.float32)
    vertices = _array(mesh.vertices, "co", (len(mesh.vertices), 3), np.float32)
    return _Part(vertices, corner_vertex[loops], normals[loops], _uvs(mesh, slots, loops, slot, uv_of), slot)


def _uvs(
    mesh: bpy.types.Mesh,
    slots: list[bpy.types.Material | None],
    loops: np.ndarray,
    slot: np.ndarray,
    uv_of: UvOf,
) -> np.ndarray:
    """(F, 3, 2): for each face the UVs that its material's texture reads."""
    result = np.zeros((*loops.shape, 2), np.float32)
    if not mesh.uv_layers:
        return result
    active = next((layer for layer in mesh.uv_layers if layer.active_render), mesh.uv_layers[0])
    for number, material in enumerate(slots):
        chosen = slot == number
        if not chosen.any():
            continue
        name, matrix = uv_of(material) if material else ("", np.eye(3))
        layer = mesh.uv_layers.get(name) or active
        uv = _array(layer.uv, "vector", (len(mesh.loops), 2), np.float32)[loops[chosen]]
        result[chosen] = uv @ matrix[:2, :2].T + matrix[:2, 2]
    return result


def _array(collection, attribute: str, shape: tuple[int, ...], kind: type) -> np.ndarray:
    flat: np.ndarray = np.empty(int(np.prod(shape)), kind)
    collection.foreach_get(attribute, flat)
    return flat.reshape(shape)


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
