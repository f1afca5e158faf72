# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything in a .blend as plain values, to compare a file with itself before and after."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from typing import Any

import bpy
from bpy.types import ID, bpy_prop_collection, bpy_struct
from vibe_render.core import compat

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
    "preview",
    "rna_type",
    "session_uid",
    "tag",
    "uv_sculpt",  # Blender 4.2 dies of reading it
}
BULK = {"vertices": "co", "polygons": "material_index"}  # of meshes, read as arrays
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
    """Where two dumps differ: path to (before, after)."""
    return {
        path: (before.get(path, "(absent)"), after.get(path, "(absent)"))
        for path in sorted({*before, *after})
        if before.get(path, "(absent)") != after.get(path, "(absent)")
    }


def contents() -> dict[str, Any]:
    """Everything in the file but the panel's own fields, the picture that Blender makes for any render, and,
    as Blender 4 cannot delete it, a compositor tree that is switched off."""
    left_out = [".vibe", "images[Render Result]"]
    if compat.compositor(bpy.context.scene) is None:
        left_out.append("scenes[Scene].node_tree")
    return {path: value for path, value in dump().items() if not any(part in path for part in left_out)}


def changes(before: dict[str, Any]) -> dict[str, tuple]:
    """What differs from before, apart from the one thing that Blender 4 offers no way to take back.

    A scene there has no compositor tree until the first use; then it has one for good. It is left
    empty and switched off.
    """
    found = difference(before, dump())
    for scene in bpy.data.scenes:
        tree = getattr(scene, "node_tree", None)
        path = f"scenes[{scene.name}].node_tree"
        if not compat.COMPOSITOR_IS_GROUP and before.get(path, 0) is None and not scene.use_nodes:
            assert tree is None or not tree.nodes
            found = {k: v for k, v in found.items() if not k.startswith(path)}
    return found


def _walk(struct: bpy_struct, path: str, seen: set[int]) -> Iterator[tuple[str, Any]]:
    if isinstance(
        struct, ID | bpy.types.Node
    ):  # custom properties; add-ons' registered ones are in bl_rna too
        own = set(struct.keys()) - set(struct.bl_rna.properties.keys())
        yield from ((f"{path}[{key!r}]", _custom(struct[key])) for key in own)
    for prop in struct.bl_rna.properties:
        name = prop.identifier
        if name in VOLATILE or (isinstance(struct, bpy.types.Mesh) and name not in OF_MESHES):
            continue
        value = getattr(struct, name, None)
        here = f"{path}.{name}"
        if isinstance(struct, bpy.types.Mesh) and name in BULK:
            yield here, [_plain(getattr(item, BULK[name])) for item in value]
        elif isinstance(value, bpy_prop_collection):
            yield from _collection(value, here, seen)
        elif isinstance(value, bpy_struct):
            yield from _pointer(value, here, seen)
        else:
            yield here, _plain(value)


def _collection(items: Any, path: str, seen: set[int]) -> Iterator[tuple[str, Any]]:
    for number, item in enumerate(items):
        if isinstance(item, bpy.types.NodeLink):  # their order means nothing
            ends = f"{item.from_node.name}.{item.from_socket.identifier} → {item.to_node.name}.{item.to_socket.identifier}"
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
