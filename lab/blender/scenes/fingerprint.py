# SPDX-License-Identifier: GPL-3.0-or-later
"""A hash of everything in a file that its picture depends on, so that a reference is rendered once.

It is taken of the scene and not of what the exporter makes of it: a better exporter changes no reference.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from pathlib import PurePath
from typing import Any

import bpy
import numpy as np
from bpy.types import ID, Image, Mesh, Scene, bpy_struct

_BLOCKS = ("objects", "meshes", "curves", "materials", "worlds", "lights", "cameras", "images", "node_groups")
_OWNED = {"nodes", "links", "inputs", "outputs", "modifiers", "material_slots", "elements", "items_tree"}
_IGNORED = {
    "animation_data",
    "bl_rna",
    "filepath_raw",
    "id_data",
    "preview",
    "rna_type",
    "session_uid",
    "use_nodes",  # always on here, and asking is deprecated
    "users",
}
_OF_SCENE = ("view_settings", "display_settings", "cycles", "camera", "world")
_OF_RENDER = ("film_transparent", "filter_size", "pixel_aspect_x", "pixel_aspect_y", "use_compositing")


def fingerprint(scene: Scene) -> str:
    """The hash of an open file with one scene: values, links, meshes and pictures, but no paths and addresses."""
    digest = hashlib.sha256()

    def add(path: str, value: Any) -> None:
        digest.update(f"{path}={value}\n".encode())

    for name in _BLOCKS:
        for block in sorted(getattr(bpy.data, name), key=lambda b: b.name_full):
            path = f"{name}[{block.name_full}]"
            for line in _walk(block, path, set()):
                add(*line)
            if isinstance(block, Mesh):
                add(path, _of_mesh(block))
            elif isinstance(block, Image):
                add(path, _of_image(block))
    for name in _OF_SCENE:
        value = getattr(scene, name)
        lines = [(name, value.name_full)] if isinstance(value, ID) else _walk(value, name, set())
        for line in lines if value else ():
            add(*line)
    for name in _OF_RENDER:
        add(name, _plain(getattr(scene.render, name)))
    return digest.hexdigest()


def _walk(struct: bpy_struct, path: str, visited: set[int]) -> Iterator[tuple[str, Any]]:
    """Path and value of everything that belongs to a data-block and can be set."""
    visited.add(struct.as_pointer())
    for prop in struct.bl_rna.properties:
        name = prop.identifier
        if name in _IGNORED:
            continue
        here = f"{path}.{name}"
        if prop.type == "COLLECTION":
            if name in _OWNED:
                for number, item in enumerate(getattr(struct, name)):
                    yield from _walk(item, f"{here}[{number}]", visited)
        elif prop.type == "POINTER":
            value = getattr(struct, name)
            if isinstance(value, ID) and not value.is_embedded_data:
                yield here, value.name_full
            elif value is not None and value.as_pointer() not in visited:
                yield from _walk(value, here, visited)
            elif isinstance(value, bpy_struct):
                yield here, _named(value)
        elif not prop.is_readonly:
            yield here, _plain(getattr(struct, name))


def _named(value: bpy_struct) -> str:
    """The end of a link."""
    return str(getattr(value, "identifier", "") or getattr(value, "name", ""))


def _plain(value: Any) -> Any:
    """Text that is the same everywhere: six digits of a number, the last part of a path."""
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, str):
        return PurePath(value.replace("\\", "/")).name
    if isinstance(value, set):
        return sorted(value)
    if isinstance(value, bool | int | bytes) or value is None:
        return value
    return [_plain(item) for item in value]


def _of_mesh(mesh: Mesh) -> str:
    arrays = [_array(mesh.vertices, "co", 3 * len(mesh.vertices), np.float32)]
    arrays.append(_array(mesh.loops, "vertex_index", len(mesh.loops), np.int32))
    for name in ("material_index", "loop_total"):
        arrays.append(_array(mesh.polygons, name, len(mesh.polygons), np.int32))
    arrays += [_array(layer.data, "uv", 2 * len(layer.data), np.float32) for layer in mesh.uv_layers]
    return _digest(arrays)


def _of_image(image: Image) -> str:
    flat = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(flat)
    return _digest([flat])


def _array(items: Any, name: str, length: int, kind: type) -> np.ndarray:
    flat: np.ndarray = np.empty(length, kind)
    items.foreach_get(name, flat)
    return flat


def _digest(arrays: list[np.ndarray]) -> str:
    digest = hashlib.sha256()
    for array in arrays:
        # + 0.0: zero has one sign
        whole = np.round(array.astype(np.float64), 5) + 0.0 if array.dtype == np.float32 else array
        digest.update(whole.tobytes())
    return digest.hexdigest()
