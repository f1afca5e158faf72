# SPDX-License-Identifier: Apache-2.0
"""Unpacks glTF of the extension KHR_draco_mesh_compression, which the bpy package cannot read.

Only the geometry's bytes are replaced: nodes, materials, textures, further extensions stay as they are written.
(trimesh can decode Draco too, but what it would write back lacks most of a material.)
"""

from __future__ import annotations

import base64
import json
import struct
from pathlib import Path
from typing import Any
from urllib.parse import quote, unquote

import numpy as np

from ..schema import VibeError
from . import gltf

_NAME = "KHR_draco_mesh_compression"
_NUMBERS = {5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
"""glTF's `componentType` -> type of a component."""
_INDICES = 5125


def is_packed(path: Path) -> bool:
    """Whether a mesh file is a glTF with Draco-compressed geometry; a broken file is not."""
    try:
        return path.suffix.lower() in (".glb", ".gltf") and _NAME in gltf.read(path)[0].get(
            "extensionsUsed", ()
        )
    except (ValueError, OSError, struct.error, AttributeError):
        return False


def unpacked(path: Path, folder: Path) -> Path:
    """Writes an uncompressed .glb of the same name.

    Args:
        path: A file that `is_packed`.

    Raises:
        VibeError: Its geometry cannot be decoded.
    """
    try:
        document, binary = gltf.read(path)
        data = _joined(document, binary, path.parent)
        for primitive in (p for mesh in document["meshes"] for p in mesh["primitives"]):
            packed = primitive.get("extensions", {}).pop(_NAME, None)
            if packed:
                _unpack(document, data, primitive, packed)
    except Exception as error:
        reason = (str(error).strip() or type(error).__name__).splitlines()[0].rstrip(".")
        raise VibeError(
            f"The Draco compression of {path.name} cannot be decoded: {reason[:120]}.",
            "Export it again without compression.",
        ) from error
    for key in ("extensionsUsed", "extensionsRequired"):
        names = [name for name in document.pop(key, ()) if name != _NAME]
        document |= {key: names} if names else {}
    target = folder / f"{path.stem}.glb"
    _write(target, document, data)
    return target


def _joined(document: dict[str, Any], binary: bytes, folder: Path) -> bytearray:
    """All buffers as one, to which the views then refer; pictures keep their files, by whole paths."""
    data, starts = bytearray(), []
    for buffer in document.pop("buffers", ()):
        data += bytes(-len(data) % 4)
        starts.append(len(data))
        data += _content(buffer["uri"], folder) if "uri" in buffer else binary
    for view in document.get("bufferViews", ()):
        view["byteOffset"] = view.get("byteOffset", 0) + starts[view.pop("buffer")]
        view["buffer"] = 0
    for image in document.get("images", ()):
        if "uri" in image and not image["uri"].startswith("data:"):
            image["uri"] = quote((folder / unquote(image["uri"])).resolve().as_posix())
    return data


def _content(uri: str, folder: Path) -> bytes:
    if uri.startswith("data:"):
        return base64.b64decode(uri.partition(",")[2])
    return (folder / unquote(uri)).read_bytes()


def _unpack(document: dict[str, Any], data: bytearray, primitive: dict[str, Any], packed: Any) -> None:
    """Decodes a primitive's attributes and indices into views of their own."""
    import DracoPy

    view = document["bufferViews"][packed["bufferView"]]
    start = view["byteOffset"]
    decoded = DracoPy.decode(bytes(data[start : start + view["byteLength"]]))
    values = {attribute["unique_id"]: attribute["data"] for attribute in decoded.attributes}
    accessors = document["accessors"]
    for name, number in packed["attributes"].items():
        accessor = accessors[primitive["attributes"][name]]
        _store(document, data, accessor, values[number].astype(_NUMBERS[accessor["componentType"]]))
    if "indices" in primitive:
        accessor = accessors[primitive["indices"]]
        accessor["componentType"] = _INDICES
        _store(document, data, accessor, decoded.faces.astype(np.uint32).reshape(-1))


def _store(document: dict[str, Any], data: bytearray, accessor: dict[str, Any], values: np.ndarray) -> None:
    """Appends an accessor's values, each row at a multiple of four bytes as glTF wants them."""
    data += bytes(-len(data) % 4)
    rows = values.reshape(len(values), -1)
    size = rows.shape[1] * rows.itemsize
    stride = size + -size % 4 if values.ndim > 1 else size
    raw = np.zeros((len(rows), stride), np.uint8)
    raw[:, :size] = np.ascontiguousarray(rows).view(np.uint8).reshape(len(rows), size)
    document["bufferViews"].append({"buffer": 0, "byteOffset": len(data), "byteLength": raw.size})
    document["bufferViews"][-1] |= {"byteStride": stride} if values.ndim > 1 else {}
    accessor |= {"bufferView": len(document["bufferViews"]) - 1, "byteOffset": 0, "count": len(rows)}
    data += raw.tobytes()


def _write(path: Path, document: dict[str, Any], data: bytearray) -> None:
    data += bytes(-len(data) % 4)
    document["buffers"] = [{"byteLength": len(data)}]
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4sII", gltf.MAGIC, 2, 12 + 8 + len(text) + 8 + len(data))
    chunks = struct.pack("<II", len(text), gltf.JSON) + text + struct.pack("<II", len(data), gltf.BIN) + data
    path.write_bytes(head + chunks)
