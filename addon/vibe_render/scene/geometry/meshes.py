# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the meshes that a final render shows, or their bounding boxes, for `assembled` in `triangles`."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import replace
from typing import Any

import numpy as np
from bpy.types import Depsgraph, Material, Mesh, Object, Scene

from ...core import rendered
from .triangles import PlacedMesh, RayCamera, SceneGeometry, SourceMesh, assembled

UvLookup = Callable[[Material], tuple[str, np.ndarray]]
"""For a material: the name of its UV map ("" for the active one), and a 3x3 matrix applied to the UVs."""

_SKIPPED = {"CURVES": "hair", "VOLUME": "a volume object", "POINTCLOUD": "a point cloud"}

_SIDES = ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (3, 2, 6, 7), (0, 3, 7, 4), (1, 5, 6, 2))
"""Corners of the sides of a box as Blender numbers them, counter-clockwise seen from outside."""
_CORNERS = np.array([(0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0), (1, 0, 0), (1, 0, 1), (1, 1, 1), (1, 1, 0)])
"""The corners of a unit box, in Blender's order."""
_NORMALS = np.array([(-1, 0, 0), (1, 0, 0), (0, -1, 0), (0, 1, 0), (0, 0, -1), (0, 0, 1)], np.float32)
"""The outward normals of `_SIDES`."""


def collect_meshes(depsgraph: Depsgraph, uv_of: UvLookup) -> tuple[list[PlacedMesh], list[str]]:
    """(meshes in a final render's dependency graph, notes for artists on objects that the prediction cannot show)."""
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
            if note := rendered.surface_note(instance.parent or thing, of):
                warnings[note] = None
            slots = rendered.worn(thing, of)
            names = _names(slots)
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


def _names(slots: list[Material | None]) -> tuple[str, ...]:
    return tuple(material.name_full if material else "" for material in slots)


def _read_mesh(mesh: Mesh, slots: list[Material | None], uv_of: UvLookup) -> SourceMesh:
    """Copies a mesh with its material slots; reads attributes as blocks, a hundred times faster than item by item."""
    mesh.calc_loop_triangles()
    count, corners = len(mesh.loop_triangles), len(mesh.loops)
    polygon = array(mesh.loop_triangle_polygons, "value", (count,), np.int32)
    # A face whose slot does not exist has the material of the last slot.
    slot = attribute(mesh, "material_index", mesh.polygons, "material_index")
    slot = np.clip(slot, 0, len(slots) - 1)[polygon]
    uvs = []
    if mesh.uv_layers:  # slots that read the same map share one array
        active = next((layer for layer in mesh.uv_layers if layer.active_render), mesh.uv_layers[0])
        maps = [uv_of(material) if material else ("", np.eye(3)) for material in slots]
        layers = [mesh.uv_layers.get(name) or active for name, _ in maps]
        read = {each.name: array(each.uv, "vector", (corners, 2), np.float32) for each in layers}
        uvs = [(read[each.name], matrix) for each, (_, matrix) in zip(layers, maps, strict=True)]
    return SourceMesh(
        vertices=array(mesh.vertices, "co", (len(mesh.vertices), 3), np.float32),
        corners=attribute(mesh, ".corner_vert", mesh.loops, "vertex_index"),
        normals=array(mesh.corner_normals, "vector", (corners, 3), np.float32),
        triangles=array(mesh.loop_triangles, "loops", (count, 3), np.int32),
        slot=slot,
        solid=np.array([rendered.has_surface(m) for m in slots]),
        uvs=uvs,
    )


def attribute(mesh: Mesh, name: str, items: Any, same: str) -> np.ndarray:
    """Integers (N,) of N items: the mesh's attribute `name`; without it, the items' own property `same`."""
    layer = mesh.attributes.get(name)
    return array(layer.data if layer else items, "value" if layer else same, (len(items),), np.int32)


def array(collection, attribute: str, shape: tuple[int, ...], kind: type) -> np.ndarray:
    """An attribute of all items of a Blender collection, as an array of this shape and type; zeros if it is empty."""
    flat: np.ndarray = np.zeros(int(np.prod(shape)), kind)
    if len(collection):  # some files name a layer, and have lost what was in it
        collection.foreach_get(attribute, flat)
    return flat.reshape(shape)


def box_geometry(scene: Scene, shown: Collection[Object], camera: RayCamera) -> SceneGeometry:
    """Triangles of the `shown` objects' bounding boxes, without sides that face the camera and would hide objects."""
    of = rendered.layer(scene)
    known: dict[tuple[int, int], PlacedMesh] = {}
    placed: list[PlacedMesh] = []
    for thing, instancer, matrix in rendered.instances(scene):
        if thing.type != "MESH" or (instancer or thing.original) not in shown:
            continue
        owner = thing.original.name_full, instancer.name_full if instancer else ""
        key = thing.original.as_pointer(), thing.data.as_pointer()
        if key not in known:
            slots = rendered.worn(thing, of)
            mesh, hidden = _box_mesh(thing, slots), rendered.hidden_from(thing, of)
            known[key] = PlacedMesh(mesh, _names(slots), np.eye(4), owner, hidden)
        box = known[key]
        placed.append(PlacedMesh(box.mesh, box.materials, np.array(matrix), owner, box.hidden))
    geometry = assembled(placed, [])
    ahead = -camera.pose[:3, 2]
    if not camera.flat:
        ahead = geometry.vertices[geometry.faces].mean(1) - camera.pose[:3, 3]
    far = (geometry.normals[:, 0] * ahead).sum(1) > 0
    of_faces = ("faces", "normals", "uvs", "material", "object")
    return replace(geometry, **{name: getattr(geometry, name)[far] for name in of_faces})


def _box_mesh(thing: Object, slots: list[Material | None]) -> SourceMesh:
    """An object's bounding box as a mesh; for several material slots, divided by their shares of the faces.

    The parts follow each other along the longest side of the box.
    """
    index = thing.data.attributes.get("material_index") if len(slots) > 1 else None
    faces = array(index.data, "value", (len(index.data),), np.int32) if index else np.zeros(1, np.int32)
    ratios = np.bincount(np.clip(faces, 0, len(slots) - 1), minlength=len(slots)) / max(len(faces), 1)
    whole = np.array([thing.bound_box[0], thing.bound_box[6]])
    axis = np.ptp(whole, axis=0).argmax()
    cuts = whole[0, axis] + np.cumsum([0.0, *ratios]) * np.ptp(whole[:, axis])
    parts = np.tile(whole, (len(slots), 1, 1))
    parts[:, :, axis] = np.stack([cuts[:-1], cuts[1:]], axis=1)
    low, high = parts[:, None].astype(np.float32).transpose(2, 0, 1, 3)  # (S, 1, 3) each
    corners = np.array(_SIDES) + 8 * np.arange(len(slots))[:, None, None]  # (S, 6, 4)
    quads = np.arange(corners.size).reshape(-1, 4)
    return SourceMesh(
        vertices=(low + _CORNERS * (high - low)).reshape(-1, 3),
        corners=corners.ravel().astype(np.int32),
        normals=np.tile(np.repeat(_NORMALS, 4, axis=0), (len(slots), 1)),
        triangles=np.concatenate([quads[:, (0, 1, 2)], quads[:, (0, 2, 3)]]),
        slot=np.tile(np.repeat(np.arange(len(slots)), 6), 2),
        solid=np.array([rendered.has_surface(material) for material in slots]) & (ratios > 0.0),
        uvs=[],
    )
