# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the meshes that a final render shows, or their bounding boxes; 'triangles' assembles meshes without Blender."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from typing import Any

import bpy
import numpy as np

from ...core import rendered
from .triangles import FARTHEST, PlacedMesh, SceneGeometry, SourceMesh
from .visibility import RayCamera

DEFAULT_MATERIAL = ""
"""Name that stands for faces without a material."""

UvLookup = Callable[[bpy.types.Material], tuple[str, np.ndarray]]
"""For a material: the name of its UV map ("" for the active one), and a 3x3 matrix applied to the UVs."""

_SKIPPED = {"CURVES": "hair", "VOLUME": "a volume object", "POINTCLOUD": "a point cloud"}

_SIDES = ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (3, 2, 6, 7), (0, 3, 7, 4), (1, 5, 6, 2))
"""Corners of the sides of a box as Blender numbers them, counter-clockwise seen from outside."""
_CORNERS = np.array([(0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0), (1, 0, 0), (1, 0, 1), (1, 1, 1), (1, 1, 0)])
"""Of a unit box."""
_Box = tuple[tuple[tuple[float, ...], ...], str]
"""The part of an object that has one material: its extent (2, 3) in the object's own space, and the material's name."""


def collect_meshes(depsgraph: bpy.types.Depsgraph, uv_of: UvLookup) -> tuple[list[PlacedMesh], list[str]]:
    """The evaluated meshes that a final render's dependency graph shows, and notes about what could not be read."""
    meshes: dict[tuple, SourceMesh] = {}
    # Thousands of instances share an object and its mesh: their content is read once.
    known: dict[tuple[int, int], PlacedMesh] = {}
    hidden: dict[str, frozenset[str]] = {}
    placed: list[PlacedMesh] = []
    warnings: dict[str, None] = {}
    of = depsgraph.view_layer
    for instance in depsgraph.object_instances:
        thing = instance.object
        if thing.type in _SKIPPED and instance.show_self:
            warnings[f"{thing.name} is {_SKIPPED[thing.type]}: the prediction leaves it out."] = None
        # Curves, texts and metaballs come once as themselves and once as the mesh that they become.
        if thing.type != "MESH" or not instance.show_self:
            continue
        key = thing.original.as_pointer(), thing.data.as_pointer()
        if key not in known:
            top = instance.parent or thing
            if note := rendered.surface_note(top, of):
                warnings[note] = None
            slots = rendered.worn(thing, of)
            names = tuple(m.name_full if m else DEFAULT_MATERIAL for m in slots)
            source = thing.data.as_pointer(), *names  # the same mesh with the same materials is read once
            mesh = meshes.get(source) or meshes.setdefault(source, _read_mesh(thing.data, slots, uv_of))
            owner = thing.original.name_full, ""
            known[key] = PlacedMesh(mesh, names, np.eye(4), owner, rendered.hidden_from(thing, of))
        shown = known[key]
        parent = instance.parent.original.name_full if instance.parent else ""
        if parent not in hidden:
            hidden[parent] = rendered.hidden_from(instance.parent, of) if parent else frozenset()
        matrix, owner = np.array(instance.matrix_world), (shown.owner[0], parent)
        placed.append(PlacedMesh(shown.mesh, shown.materials, matrix, owner, shown.hidden | hidden[parent]))
    return placed, list(warnings)


def _read_mesh(mesh: bpy.types.Mesh, slots: list[bpy.types.Material | None], uv_of: UvLookup) -> SourceMesh:
    """Copies a mesh. It reads attributes as blocks of memory, a hundred times faster than loops and triangles."""
    mesh.calc_loop_triangles()
    count, corners = len(mesh.loop_triangles), len(mesh.loops)
    polygon = array(mesh.loop_triangle_polygons, "value", (count,), np.int32)
    # Blender shows faces whose slot does not exist in the last one.
    slot = attribute(mesh, "material_index", mesh.polygons, "material_index")
    slot = np.clip(slot, 0, len(slots) - 1)[polygon]
    return SourceMesh(
        vertices=array(mesh.vertices, "co", (len(mesh.vertices), 3), np.float32),
        corners=attribute(mesh, ".corner_vert", mesh.loops, "vertex_index"),
        normals=array(mesh.corner_normals, "vector", (corners, 3), np.float32),
        triangles=array(mesh.loop_triangles, "loops", (count, 3), np.int32),
        slot=slot,
        solid=np.array([rendered.has_surface(m) for m in slots]),
        uvs=_uvs(mesh, slots, uv_of),
    )


def _uvs(
    mesh: bpy.types.Mesh, slots: list[bpy.types.Material | None], uv_of: UvLookup
) -> list[tuple[np.ndarray, np.ndarray]]:
    """See `SourceMesh.uvs`; slots that read the same map share one array."""
    if not mesh.uv_layers:
        return []
    active = next((layer for layer in mesh.uv_layers if layer.active_render), mesh.uv_layers[0])
    maps = [uv_of(material) if material else ("", np.eye(3)) for material in slots]
    layers = [mesh.uv_layers.get(name) or active for name, _ in maps]
    read = {each.name: array(each.uv, "vector", (len(mesh.loops), 2), np.float32) for each in layers}
    return [(read[each.name], matrix) for each, (_, matrix) in zip(layers, maps, strict=True)]


def attribute(mesh: bpy.types.Mesh, name: str, items: Any, same: str) -> np.ndarray:
    """An integer attribute of each item; the items' own property where the mesh has no attribute of that name."""
    layer = mesh.attributes.get(name)
    return array(layer.data if layer else items, "value" if layer else same, (len(items),), np.int32)


def array(collection, attribute: str, shape: tuple[int, ...], kind: type) -> np.ndarray:
    """An attribute of all items of a collection of Blender's; zeros where the collection is empty."""
    flat: np.ndarray = np.zeros(int(np.prod(shape)), kind)
    if len(collection):  # some files name a layer, and have lost what was in it
        collection.foreach_get(attribute, flat)
    return flat.reshape(shape)


def box_geometry(
    scene: bpy.types.Scene, shown: Collection[bpy.types.Object], camera: RayCamera
) -> SceneGeometry:
    """The sides of bounding boxes that face away from a camera: these never hide what is inside or before a box.

    Args:
        shown: The objects that count, of all that a render shows.
    """
    of = rendered.layer(scene)
    known: dict[tuple[int, int], list[_Box]] = {}
    hidden: list[frozenset[str]] = []
    objects: dict[tuple[str, str], int] = {}
    materials: dict[str, int] = {}
    extents, matrices, owners, material_numbers = [], [], [], []
    # Gather boxes with the numbers of their objects and materials; instances share what is known of an object.
    for thing, instancer, matrix in rendered.instances(scene):
        if thing.type != "MESH" or (instancer or thing.original) not in shown:
            continue
        key = thing.original.as_pointer(), thing.data.as_pointer()
        if key not in known:
            known[key] = list(_material_boxes(thing, of))
        name = thing.original.name_full, instancer.name_full if instancer else ""
        number = objects.setdefault(name, len(objects))
        if number == len(hidden):
            hidden.append(rendered.hidden_from(thing, of))
        for extent, material in known[key]:
            extents.append(extent)
            matrices.append(matrix)
            owners.append(number)
            material_numbers.append(materials.setdefault(material, len(materials)))
    # Place their corners in world space.
    low, high = np.moveaxis(np.array(extents).reshape(-1, 2, 1, 3), 1, 0)
    placed = np.array(matrices).reshape(-1, 4, 4)
    corners = (low + _CORNERS * (high - low)) @ placed[:, :3, :3].transpose(0, 2, 1) + placed[:, None, :3, 3]
    world = corners.astype(np.float32)
    usable = (np.abs(world) < FARTHEST).all((1, 2))
    mirrored = np.linalg.det(placed[:, :3, :3]) < 0
    box, faces, normals = _far_sides(world, usable, mirrored, camera)
    # Of each object, the least and the greatest corner of all its boxes; zeros without boxes.
    theirs = np.array(owners, np.int32)[usable]
    least, greatest = np.full((len(objects), 3), np.inf), np.full((len(objects), 3), -np.inf)
    np.minimum.at(least, theirs, world[usable].min(1))
    np.maximum.at(greatest, theirs, world[usable].max(1))
    around = np.where(np.isfinite(least[:, None]), np.stack([least, greatest], 1), 0.0).astype(np.float32)
    owner, material_number = (np.array(each, np.int32)[box] for each in (owners, material_numbers))
    return SceneGeometry(
        world.reshape(-1, 3),
        faces,
        normals,
        np.zeros((len(faces), 3, 2), np.float32),
        material_number,
        owner,
        [*materials],
        [*objects],
        around,
        hidden,
        [],
    )


def _material_boxes(thing: bpy.types.Object, of: bpy.types.ViewLayer) -> Iterator[_Box]:
    """The box of an object, cut along its longest side into a part for each material that its faces have."""
    box, slots = thing.bound_box, rendered.worn(thing, of)
    low, high = box[0][:], box[6][:]
    areas = {slots[0]: 1.0} if len(slots) == 1 else _face_ratios(thing.data, slots)
    areas = {material: area for material, area in areas.items() if rendered.has_surface(material)}
    if len(areas) == 1:
        (material,) = areas
        yield (low, high), material.name_full if material else DEFAULT_MATERIAL
        return
    axis = max(range(3), key=lambda n: high[n] - low[n])
    start = end = low[axis]
    for material, area in areas.items():
        start, end = end, end + area / sum(areas.values()) * (high[axis] - low[axis])
        part = tuple((*each[:axis], cut, *each[axis + 1 :]) for each, cut in ((low, start), (high, end)))
        yield part, material.name_full if material else DEFAULT_MATERIAL


def _face_ratios(
    mesh: bpy.types.Mesh, slots: list[bpy.types.Material | None]
) -> dict[bpy.types.Material | None, float]:
    """The ratio of a mesh's faces that have each material."""
    index = mesh.attributes.get("material_index")
    faces = array(index.data, "value", (len(index.data),), np.int32) if index else np.zeros(1, np.int32)
    counts = np.bincount(np.clip(faces, 0, len(slots) - 1), minlength=len(slots))
    ratios: dict[bpy.types.Material | None, float] = {}
    for material, count in zip(slots, counts / max(len(faces), 1), strict=True):
        if count:
            ratios[material] = ratios.get(material, 0.0) + float(count)
    return ratios


def _far_sides(
    world: np.ndarray, usable: np.ndarray, mirrored: np.ndarray, camera: RayCamera
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Triangles of the sides of boxes (B, 8, 3) that face away from a camera: box (F,), corners (F, 3), normals (F, 3, 3)."""
    sides = world[:, _SIDES]  # (B, 6, 4, 3)
    normals = np.cross(sides[:, :, 1] - sides[:, :, 0], sides[:, :, 2] - sides[:, :, 0])
    normals *= np.where(mirrored, -1.0, 1.0)[:, None, None]
    area = np.linalg.norm(normals, axis=2)
    ahead = -camera.pose[:3, 2] if camera.flat else sides.mean(2) - camera.pose[:3, 3]
    box, side = np.nonzero(((normals * ahead).sum(2) > 0) & (area > 0) & usable[:, None])
    quads = np.array(_SIDES)[side] + 8 * box[:, None]
    faces = np.concatenate([quads[:, (0, 1, 2)], quads[:, (0, 2, 3)]]).astype(np.int32)
    facing = np.repeat((normals / np.maximum(area, 1e-12)[..., None])[box, side][:, None], 3, axis=1)
    return np.concatenate([box, box]), faces, np.concatenate([facing, facing]).astype(np.float32)
