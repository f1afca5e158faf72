# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything in a .blend as plain values, to compare a file with itself before and after."""

from __future__ import annotations

import hashlib
import warnings
from collections.abc import Iterator
from typing import Any

import bpy
import numpy as np
from bpy.types import ID, bpy_prop_collection, bpy_struct

COLLECTIONS = (  # noqa: SIM905
    "actions cameras collections curves images lights materials meshes node_groups objects scenes texts worlds"
).split()

# What Blender itself changes on saving, loading or evaluating, and what only mirrors other values.
VOLATILE = {
    "depsgraph",
    "id_data",
    "is_dirty",
    "is_evaluated",
    "is_updated",
    "is_updated_data",
    "original",
    "pixels",
    "preview",
    "rna_type",
    "session_uid",
    "tag",
    "is_outdated",  # of a cache of particles: any evaluation sets it
    "uv_sculpt",  # Blender 4.2 dies of reading it
}
BULK = {  # of meshes, read as one array each, of so many numbers an item
    "vertices": ("co", 3, np.float32),
    "polygons": ("material_index", 1, np.int32),
}
OF_MESHES = {*BULK, "name", "materials", "users", "use_fake_user"}


def dump() -> dict[str, Any]:
    """Path to value, for every property of every data-block that a vibe might touch."""
    found: dict[str, Any] = {}
    for layer in (layer for scene in bpy.data.scenes for layer in scene.view_layers):
        layer.update()  # matrices
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        for name in COLLECTIONS:
            for block in getattr(bpy.data, name):
                found.update(_walk(block, f"{name}[{block.name_full}]", {block.as_pointer()}))
    return found


def difference(before: dict[str, Any], after: dict[str, Any]) -> dict[str, tuple]:
    """Differences of two dumps.

    Args:
        before: As `dump` returns it.

    Returns:
        Path to (before, after), sorted; "(absent)" where one of them lacks it.
    """
    return {
        path: (before.get(path, "(absent)"), after.get(path, "(absent)"))
        for path in sorted({*before, *after})
        if before.get(path, "(absent)") != after.get(path, "(absent)")
    }


def _given_by_blender(struct: bpy_struct, name: str, value: Any) -> bool:
    """True if it is what Blender says of a cache: how full it is, and where a fluid's is while the file has no place for it."""
    if isinstance(struct, bpy.types.PointCache):
        return name == "info"
    fluid = isinstance(struct, bpy.types.FluidDomainSettings)
    return fluid and name == "cache_directory" and not value.startswith("//")


def _walk(struct: bpy_struct, path: str, seen: set[int]) -> Iterator[tuple[str, Any]]:
    if isinstance(struct, ID | bpy.types.Node):  # custom properties; add-ons' registered ones are in bl_rna too
        own = set(struct.keys()) - set(struct.bl_rna.properties.keys())
        yield from ((f"{path}[{key!r}]", _custom(struct[key])) for key in own)
    for prop in struct.bl_rna.properties:
        name = prop.identifier
        if name in VOLATILE or (isinstance(struct, bpy.types.Mesh) and name not in OF_MESHES):
            continue
        if name == "outputs" and isinstance(struct, bpy.types.CompositorNodeRLayers):
            continue  # they follow the passes: any render makes them anew
        if name == "users" and isinstance(struct, bpy.types.Scene):
            continue  # a Render Layers node that comes a second time counts twice, though both are gone
        value = getattr(struct, name, None)
        if _given_by_blender(struct, name, value):
            continue
        here = f"{path}.{name}"
        if isinstance(struct, bpy.types.Mesh) and name in BULK:
            yield here, _digest(value, *BULK[name])
        elif isinstance(value, bpy_prop_collection):
            yield from _collection(value, here, seen)
        elif isinstance(value, bpy_struct):
            yield from _pointer(value, here, seen)
        else:
            yield here, _plain(value)


def _collection(items: Any, path: str, seen: set[int]) -> Iterator[tuple[str, Any]]:
    for number, item in enumerate(items):
        if isinstance(item, bpy.types.NodeLink):  # their order means nothing
            ends = (
                f"{item.from_node.name}.{item.from_socket.identifier} → {item.to_node.name}.{item.to_socket.identifier}"
            )
            yield f"{path}[{ends}]", (item.is_muted, item.is_hidden)
        elif isinstance(item, bpy_struct):
            name = item.name if isinstance(item, bpy.types.Node) else number
            yield from _pointer(item, f"{path}[{name}]", seen)
        else:
            yield f"{path}[{number}]", _plain(item)


def _pointer(value: Any, path: str, seen: set[int]) -> Iterator[tuple[str, Any]]:
    if isinstance(value, ID) and not value.is_embedded_data:
        yield path, f"{type(value).__name__} {value.name_full}"
    elif value.as_pointer() in seen:
        yield path, f"{type(value).__name__} {getattr(value, 'name', '')}"
    else:
        seen.add(value.as_pointer())
        yield from _walk(value, path, seen)


def _digest(items: Any, attribute: str, components: int, kind: type) -> str:
    """A hash of one attribute of many items."""
    flat: np.ndarray = np.empty(len(items) * components, kind)
    items.foreach_get(attribute, flat)
    return f"{len(items)} {attribute} {hashlib.sha256(flat.tobytes()).hexdigest()[:16]}"


def _plain(value: Any) -> Any:
    if value is None or isinstance(value, bool | int | float | str | bytes):
        return value
    if isinstance(value, set):
        return sorted(value)
    try:
        return [_plain(item) for item in value]
    except TypeError:
        return repr(type(value))


def _custom(value: Any) -> Any:
    if hasattr(value, "to_dict"):
        return {key: _custom(value[key]) for key in value.keys()}  # noqa: SIM118
    return repr(value) if isinstance(value, ID) else _plain(value)
