# SPDX-License-Identifier: Apache-2.0
"""Makes a Draco-compressed glTF of an uncompressed .glb, with an encoder that is not the decoder's counterpart of ours."""

from pathlib import Path

import DracoPy
import numpy as np

from proxy_renderer.blender import meshes

NAME = "KHR_draco_mesh_compression"
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}


def pack(plain: Path, target: Path) -> Path:
    """Compresses positions, normals, texture coordinates and indices of every primitive.

    A .gltf gets its bytes as a file beside it; in a .glb they are inside.
    """
    document, binary = meshes.read_gltf(plain)
    data = bytearray(binary)
    for primitive in (p for mesh in document["meshes"] for p in mesh["primitives"]):
        _pack(document, data, primitive)
    document["extensionsUsed"] = [*document.get("extensionsUsed", []), NAME]
    document["extensionsRequired"] = [NAME]
    if target.suffix == ".glb":
        meshes._write(target, document, data)
        return target
    import json

    (target.parent / "the bytes.bin").write_bytes(data)
    document["buffers"] = [{"byteLength": len(data), "uri": "the%20bytes.bin"}]
    target.write_text(json.dumps(document), encoding="utf-8")
    return target


def _pack(document, data, primitive):
    def values(number):
        accessor = document["accessors"][number]
        view = document["bufferViews"][accessor["bufferView"]]
        width, kind = _WIDTHS[accessor["type"]], meshes._NUMBERS[accessor["componentType"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        return np.frombuffer(data, kind, accessor["count"] * width, start).reshape(-1, width)

    names = primitive["attributes"]
    blob = DracoPy.encode(
        points=values(names["POSITION"]),
        faces=values(primitive["indices"]).reshape(-1, 3).astype(np.uint32),
        normals=values(names["NORMAL"]).astype(np.float64),
        tex_coord=values(names["TEXCOORD_0"]).astype(np.float64),
        preserve_order=True,
        quantization_bits=16,
    )
    kinds = {a["attribute_type"]: a["unique_id"] for a in DracoPy.decode(blob).attributes}
    types = DracoPy.AttributeType
    numbers = {"POSITION": kinds[types.POSITION], "NORMAL": kinds[types.NORMAL], "TEXCOORD_0": kinds[types.TEX_COORD]}
    for number in (*names.values(), primitive["indices"]):
        document["accessors"][number].pop("bufferView")
    data += bytes(-len(data) % 4)
    document["bufferViews"].append({"buffer": 0, "byteOffset": len(data), "byteLength": len(blob)})
    data += blob
    packed = {"bufferView": len(document["bufferViews"]) - 1, "attributes": numbers}
    primitive["extensions"] = {NAME: packed}
