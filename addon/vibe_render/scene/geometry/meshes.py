# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the meshes that a final render shows; `triangles` assembles them without Blender."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np

from ...core.compat import node_tree
from .triangles import PlacedMesh, SourceMesh

DEFAULT_MATERIAL = ""
"""Name that stands for faces without a material."""

UvLookup = Callable[[bpy.types.Material], tuple[str, np.ndarray]]
"""For a material: the name of its UV map ("" for the active one), and a 3x3 matrix applied to the UVs."""

_RAYS = ("camera", "diffuse", "glossy", "transmission", "shadow")
_SKIPPED = {"CURVES": "hair", "VOLUME": "a volume object", "POINTCLOUD": "a point cloud"}


def collect_meshes(depsgraph: bpy.types.Depsgraph, uv_of: UvLookup) -> tuple[list[PlacedMesh], list[str]]:
    """Reads the evaluated meshes and instances of a final render's dependency graph.

    Returns:
        The meshes that the render shows, and notes about what could not be read.
    """
    meshes: dict[tuple, SourceMesh] = {}
    # Thousands of instances share an object and its mesh: what these say is asked for once.
    known: dict[tuple[int, int], _Shown] = {}
    hidden: dict[str, frozenset[str]] = {}
    placed: list[PlacedMesh] = []
    warnings: dict[str, None] = {}
    for instance in depsgraph.object_instances:
        thing = instance.object
        if thing.type in _SKIPPED and instance.show_self:
            warnings[f"{thing.name} is {_SKIPPED[thing.type]}: the prediction leaves it out."] = None
        # Curves, texts and metaballs come once as themselves and once as the mesh that they become.
        if thing.type != "MESH" or not instance.show_self:
            continue
        key = thing.original.as_pointer(), thing.data.as_pointer()
        if key not in known:
            warnings.update(dict.fromkeys(_special(thing)))
            known[key] = _shown(thing, meshes, uv_of)
        shown = known[key]
        parent = instance.parent.original.name_full if instance.parent else ""
        if parent not in hidden:
            hidden[parent] = hidden_from(instance.parent) if parent else frozenset()
        matrix, owner = np.array(instance.matrix_world), (shown.name, parent)
        placed.append(PlacedMesh(shown.mesh, shown.materials, matrix, owner, shown.hidden | hidden[parent]))
    return placed, list(warnings)


@dataclass(frozen=True)
class _Shown:
    """What an evaluated object shows of itself: its mesh, and the kinds of rays that pass it."""

    mesh: SourceMesh
    materials: tuple[str, ...]
    name: str
    hidden: frozenset[str]


def _shown(thing: bpy.types.Object, meshes: dict[tuple, SourceMesh], uv_of: UvLookup) -> _Shown:
    """Reads an object with a mesh, unless the same mesh with the same materials has been read already."""
    slots = slots_of(thing)
    names = tuple(m.name_full if m else DEFAULT_MATERIAL for m in slots)
    key = (thing.data.as_pointer(), *names)
    mesh = meshes.get(key) or meshes.setdefault(key, _read_mesh(thing.data, slots, uv_of))
    return _Shown(mesh, names, thing.original.name_full, hidden_from(thing))


def hidden_from(thing: bpy.types.Object) -> frozenset[str]:
    """The kinds of rays that pass an object, and its instances."""
    return frozenset(ray for ray in _RAYS if not getattr(thing, f"visible_{ray}"))


def _special(thing: bpy.types.Object) -> list[str]:
    """Notes about holdouts, which the prediction leaves out."""
    if not (thing.is_holdout or thing.is_shadow_catcher):
        return []
    kind = "a holdout" if thing.is_holdout else "a shadow catcher"
    return [f"{thing.name} is {kind}: the prediction shows it as a plain surface."]


def slots_of(thing: bpy.types.Object) -> list[bpy.types.Material | None]:
    """What the slots hold; at least one slot, which may hold nothing."""
    slots = [slot.material for slot in thing.material_slots] or list(thing.data.materials)
    return [m.original if m else None for m in slots] or [None]


def has_surface(material: bpy.types.Material | None) -> bool:
    """Whether a material shows a surface; a box of fog has none."""
    tree = node_tree(material) if material else None
    output = tree.get_output_node("CYCLES") if tree else None
    return output is None or output.inputs["Surface"].is_linked or not output.inputs["Volume"].is_linked


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
        solid=np.array([has_surface(m) for m in slots]),
        uvs=_uvs(mesh, slots, uv_of),
    )


def _uvs(
    mesh: bpy.types.Mesh, slots: list[bpy.types.Material | None], uv_of: UvLookup
) -> list[tuple[np.ndarray, np.ndarray]]:
    """See `SourceMesh.uvs`; slots that read the same map share one array."""
    if not mesh.uv_layers:
        return []
    active = next((layer for layer in mesh.uv_layers if layer.active_render), mesh.uv_layers[0])
    wanted = [uv_of(material) if material else ("", np.eye(3)) for material in slots]
    layers = [mesh.uv_layers.get(name) or active for name, _ in wanted]
    read = {each.name: array(each.uv, "vector", (len(mesh.loops), 2), np.float32) for each in layers}
    return [(read[each.name], matrix) for each, (_, matrix) in zip(layers, wanted, strict=True)]


def attribute(mesh: bpy.types.Mesh, name: str, items: Any, same: str) -> np.ndarray:
    """Whole numbers of an attribute, one for each item; by the items' own property where the mesh lists none of that name."""
    layer = mesh.attributes.get(name)
    return array(layer.data if layer else items, "value" if layer else same, (len(items),), np.int32)


def array(collection, attribute: str, shape: tuple[int, ...], kind: type) -> np.ndarray:
    """An attribute of all items of a collection of Blender's; zeros where the collection is empty."""
    flat: np.ndarray = np.zeros(int(np.prod(shape)), kind)
    if len(collection):  # some files name a layer, and have lost what was in it
        collection.foreach_get(attribute, flat)
    return flat.reshape(shape)
