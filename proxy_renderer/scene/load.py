# SPDX-License-Identifier: Apache-2.0
"""Reads and checks a job folder that the add-on has written: `scene.json`, `meshes.npz`, images."""

import json
import math
import weakref
from dataclasses import fields, replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from ..schema import PARAMETERS, Instance, VibeError, labels, schema_hash, split_key
from . import data
from .data import Array

FORMAT = 1
_FARTHEST = 1e9  # meters from the origin beyond which squares of areas leave the range of 32-bit floats
_AT_ONCE = 1 << 18  # most triangles that are checked at once; limits memory
_EXPORT_AGAIN = "Export the scene again with the add-on that belongs to this engine."
_ROWS = {(p.group, p.name): p for p in PARAMETERS}
_MESH_SHAPES = {"vertices": (3,), "faces": (3,), "normals": (3, 3), "uvs": (3, 2), "material": (), "object": ()}

T = TypeVar("T")


def load_scene(folder: Path | str) -> data.SceneData:
    """Reads and validates an exported scene: arrays are float32 or int32 and finite, indices in range.

    Raises VibeError if a file is missing, broken or of another version, or if there is nothing to render.
    """
    folder = Path(folder)
    try:
        content = json.loads((folder / "scene.json").read_text(encoding="utf-8"))
        if content.get("format") != FORMAT or content.get("schema") != schema_hash():
            raise VibeError("The scene was exported by another version of Vibe Render.", _EXPORT_AGAIN)
        return _scene(folder, content)
    except (OSError, ValueError, KeyError, TypeError, IndexError) as error:
        reason = f"The exported scene in {folder} cannot be read ({type(error).__name__}: {error})."
        raise VibeError(reason, _EXPORT_AGAIN) from error


def _scene(folder: Path, content: dict[str, Any]) -> data.SceneData:
    materials = tuple(_material(folder, m) for m in content["materials"])
    objects = tuple(_record(data.MeshObject, o) for o in content["objects"])
    standby, world, film = content.get("standby", {}), content["world"], content["film"]
    pictures = {name: _picture(folder / world[name]) for name in world.keys() & {"image", "backdrop"}}
    table = film.get("compositor")
    table = np.load(folder / table, allow_pickle=False) if table else None
    width, height = content["resolution"]
    if width < 1 or height < 1:
        raise VibeError(f"The picture's size {width} x {height} is empty.", "Set a resolution in Blender.")
    x, y, z = map(float, content["pivot"])
    if not all(map(math.isfinite, (x, y, z))):
        raise ValueError("a position is not finite")
    camera = _record(data.Camera, content["camera"])
    if camera.type not in ("PERSP", "ORTHO"):
        remedy = "Use a perspective or orthographic camera."
        raise VibeError(f"The camera's type {camera.type} is not supported.", remedy)
    return data.SceneData(
        folder=folder,
        resolution=(int(width), int(height)),
        pixel_aspect=float(content["pixel_aspect"]),
        pivot=(x, y, z),
        references=content["references"],
        camera=camera,
        lights=tuple(_light(light) for light in content["lights"]),
        materials=materials,
        objects=objects,
        world=_record(data.WorldData, world | pictures),
        volume=_record(data.FogBounds, content["volume"]),
        film=_record(data.FilmSettings, {**film, "compositor": table}),
        mesh=_mesh(folder / "meshes.npz", len(materials), len(objects)),
        instances=_instances(content["parameters"]),
        standby=data.Standby(tuple(map(_light, standby.get("lights", ()))), _instances(standby.get("parameters", {}))),
        bounces=int(content.get("bounces", 4)),
        unseen={key: i.value for key, i in _instances(content.get("unseen", {})).items()},
    )


def _record(kind: type[T], row: dict[str, Any]) -> T:
    """A dataclass `kind` from those JSON keys that are its fields; lists become tuples, their whole numbers floats."""
    names = {f.name for f in fields(kind)}  # type: ignore[arg-type]
    return kind(**{k: _tuples(v) for k, v in row.items() if k in names})


def _tuples(value: Any) -> Any:
    if isinstance(value, list):
        return tuple(float(v) if type(v) is int else _tuples(v) for v in value)
    return value


def _light(row: dict[str, Any]) -> data.Light:
    return replace(_record(data.Light, row), unlit=tuple(map(int, row.get("unlit", ()))))


def _material(folder: Path, row: dict[str, Any]) -> data.Material:
    # All textures by input; that of the base color has a field of its own.
    rows = {"": row.get("texture"), **(row.get("maps") or {})}
    maps = {
        name: _record(data.Texture, {**each, "image": _picture(folder / each["image"], (1, 3))})
        for name, each in rows.items()
        if each
    }
    return replace(_record(data.Material, {**row, "maps": {}}), texture=maps.pop("", None), maps=maps)


def _picture(path: Path, channels: tuple[int, ...] = (3,)) -> Array:
    """Reads a linear image (H, W, C) as float32, C one of `channels`; negative and not finite values become 0."""
    image = np.load(path, allow_pickle=False).astype(np.float32)
    if image.ndim != 3 or image.shape[2] not in channels or 0 in image.shape:
        raise ValueError(f"{path.name} has the shape {image.shape}, not (H, W, {channels[-1]})")
    return np.nan_to_num(image, nan=0.0, posinf=0.0, neginf=0.0).clip(0.0)


_meshes: weakref.WeakSet[data.SceneMesh] = weakref.WeakSet()
"""Meshes in use. Jobs with the same mesh share one object, and the results cached by it, such as its ray tree."""
_ALIKE = {"vertices": 1e-6, "normals": 1e-3, "uvs": 0.02}
"""Greatest difference that rounding makes between exports of one mesh; of vertices, relative to the greatest value."""


def _mesh(path: Path, materials: int, objects: int) -> data.SceneMesh:
    with np.load(path, allow_pickle=False) as stored:
        arrays = {name: stored[name] for name in _MESH_SHAPES}
    for name, tail in _MESH_SHAPES.items():
        kind = np.float32 if name in ("vertices", "normals", "uvs") else np.int32
        arrays[name] = np.ascontiguousarray(arrays[name], kind)
        if arrays[name].shape[1:] != tail or (name != "vertices" and len(arrays[name]) != len(arrays["faces"])):
            raise ValueError(f"{name} has the shape {arrays[name].shape}")
    for name, count in (("faces", len(arrays["vertices"])), ("material", materials), ("object", objects)):
        if arrays[name].size and not 0 <= arrays[name].min() <= arrays[name].max() < count:
            raise ValueError(f"an index in {name} is out of range")
    arrays = _drop_broken(arrays)
    if not len(arrays["faces"]):
        raise VibeError("The scene has no mesh that can be rendered.", "Add a mesh, or make one visible.")
    mesh = next((known for known in tuple(_meshes) if _is_alike(known, arrays)), None) or data.SceneMesh(**arrays)
    _meshes.add(mesh)
    return mesh


def _is_alike(mesh: data.SceneMesh, arrays: dict[str, Array]) -> bool:
    """True if `arrays` equal those of `mesh`, up to the differences in `_ALIKE`."""
    pairs = {name: (getattr(mesh, name), array) for name, array in arrays.items()}
    if any(one.shape != other.shape for one, other in pairs.values()):
        return False
    if not all(np.array_equal(*pairs[name]) for name in pairs.keys() - _ALIKE):
        return False
    greatest = {name: max(float(np.abs(mesh.vertices).max()), 1e-9) if name == "vertices" else 1.0 for name in _ALIKE}
    return all(np.abs(np.subtract(*pairs[name])).max() <= most * greatest[name] for name, most in _ALIKE.items())


def _drop_broken(arrays: dict[str, Array]) -> dict[str, Array]:
    """Removes triangles without area or with a corner that is not finite or too far; repairs broken normals and UVs."""
    keep = np.ones(len(arrays["faces"]), bool)
    for first in range(0, len(keep), _AT_ONCE):
        some = slice(first, first + _AT_ONCE)
        corners, normals = arrays["vertices"][arrays["faces"][some]], arrays["normals"][some]
        finite = (np.abs(corners) < _FARTHEST).all((1, 2))  # also false for NaN
        corners = np.where(finite[:, None, None], corners, 0.0).astype(float)
        flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        area = np.linalg.norm(flat, axis=1)
        # Normals become unit vectors, in place; a broken one becomes the normal of its triangle.
        length = np.linalg.norm(normals, axis=2, keepdims=True)
        facet = (flat / np.where(area > 0, area, 1.0)[:, None]).astype(np.float32)
        sound = np.isfinite(length) & (length > 1e-6)
        normals[:] = np.where(sound, normals / np.where(sound, length, 1.0), facet[:, None])
        keep[some] = finite & (area > 0)
    np.nan_to_num(arrays["uvs"], copy=False, nan=0.0, posinf=0.0, neginf=0.0)
    return arrays if keep.all() else {k: v if k == "vertices" else v[keep] for k, v in arrays.items()}


def _instances(rows: dict[str, Any]) -> dict[str, Instance]:
    found = {}
    for key, row in rows.items():
        group, owner, name = split_key(key)
        parameter = _ROWS[group, name]
        value = row["value"] if isinstance(row["value"], list) else [row["value"]]
        if len(value) != parameter.components or not all(math.isfinite(v) for v in value):
            remedy = "Correct it in Blender."
            raise VibeError(f"The value of {labels.title(key)} is not usable: {row['value']}.", remedy)
        reference, numbers = float(row.get("reference", 1.0)), tuple(float(v) for v in value)
        marks = {"role": row.get("role", ""), "locked": row.get("locked", "")}
        found[key] = Instance(parameter, owner, numbers, reference, **marks)
    return found
