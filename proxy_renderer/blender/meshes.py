# SPDX-License-Identifier: Apache-2.0
"""Checks bare meshes before Blender is started, and decodes Draco compression. Blender's side checks what it imports, too."""

import base64
import json
import struct
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import quote, unquote

import numpy as np

from ..schema import VibeError

MAGIC, JSON, BIN = b"glTF", 0x4E4F534A, 0x004E4942
_READ = """
    KHR_animation_pointer KHR_draco_mesh_compression KHR_lights_punctual KHR_mesh_quantization KHR_texture_transform
    KHR_xmp_json_ld EXT_mesh_gpu_instancing EXT_texture_webp KHR_materials_anisotropy KHR_materials_clearcoat
    KHR_materials_dispersion KHR_materials_emissive_strength KHR_materials_ior KHR_materials_iridescence
    KHR_materials_pbrSpecularGlossiness KHR_materials_sheen KHR_materials_specular KHR_materials_transmission
    KHR_materials_unlit KHR_materials_variants KHR_materials_volume
"""
"""glTF extensions that Blender 4.5 and 5 read or can ignore without harm; Draco is decoded here."""
_BASISU = "KHR_texture_basisu"
_UNCOMPRESSED = "Export it again without compression."
_REMEDIES = dict.fromkeys(("EXT_meshopt_compression", "KHR_meshopt_compression"), _UNCOMPRESSED)
_REMEDIES[_BASISU] = "Export it again with PNG or JPEG textures."
_NAME = "KHR_draco_mesh_compression"
_LONGEST_TEXT = 16_000_000  # bytes; reading more of a text format would take longer than Blender's start
_NUMBERS = {5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
"""glTF's `componentType` -> type of a component."""


def read_gltf(path: Path) -> tuple[dict[str, Any], bytes]:
    """The JSON document and the binary chunk of a .glb or .gltf; the chunk is b"" if there is none."""
    raw = path.read_bytes()
    if raw[:4] != MAGIC:
        return json.loads(raw), b""
    document, binary, start = {}, b"", 12
    while start + 8 <= len(raw):
        length, kind = struct.unpack_from("<II", raw, start)
        chunk = raw[start + 8 : start + 8 + length]
        if kind == JSON:
            document = json.loads(chunk)
        elif kind == BIN:
            binary = chunk
        start += 8 + length
    return document, binary


def refuse_unread_extensions(path: Path) -> None:
    """Raises VibeError if a glTF file requires an extension that Blender's importer lacks; broken files pass."""
    try:
        document, _ = read_gltf(path)
        required = set(document.get("extensionsRequired", ()))
        textures = [dict(texture) for texture in document.get("textures", ())]
    except (ValueError, OSError, struct.error, AttributeError, TypeError):
        return
    if any(_BASISU in t.get("extensions", {}) and "source" not in t for t in textures):
        required.add(_BASISU)
    for name in sorted(required.difference(_READ.split())):
        remedy = _REMEDIES.get(name, "Export it again without this extension.")
        raise VibeError(f"{path.name} needs the glTF extension {name}, which Blender cannot read.", remedy)


def is_packed(path: Path) -> bool:
    """True for a glTF with Draco-compressed geometry, and not for a broken file."""
    try:
        return path.suffix.lower() in (".glb", ".gltf") and _NAME in read_gltf(path)[0]["extensionsUsed"]
    except (ValueError, OSError, struct.error, TypeError, KeyError):
        return False


def unpacked(path: Path, folder: Path) -> Path:
    """Writes a Draco-compressed glTF as an uncompressed .glb into a folder; returns its path, or raises VibeError."""
    try:
        document, binary = read_gltf(path)
        data = _joined(document, binary, path.parent)
        for primitive in (p for mesh in document["meshes"] for p in mesh["primitives"]):
            packed = primitive.get("extensions", {}).pop(_NAME, None)
            if packed:
                _unpack(document, data, primitive, packed)
    except Exception as error:
        reason = (str(error).strip() or type(error).__name__).splitlines()[0].rstrip(".")
        problem = f"The Draco compression of {path.name} cannot be decoded: {reason[:120]}."
        raise VibeError(problem, _UNCOMPRESSED) from error
    for key in ("extensionsUsed", "extensionsRequired"):
        names = [name for name in document.pop(key, ()) if name != _NAME]
        document |= {key: names} if names else {}
    target = folder / f"{path.stem}.glb"
    _write(target, document, data)
    return target


def _joined(document: dict[str, Any], binary: bytes, folder: Path) -> bytearray:
    """All buffers of a glTF as one; makes `document` refer to it, and paths of image files in `document` absolute."""
    data, starts = bytearray(), []
    for buffer in document.pop("buffers", ()):
        data += bytes(-len(data) % 4)
        starts.append(len(data))
        uri = buffer.get("uri")
        if uri is None:
            data += binary
        elif uri.startswith("data:"):
            data += base64.b64decode(uri.partition(",")[2])
        else:
            data += (folder / unquote(uri)).read_bytes()
    for view in document.get("bufferViews", ()):
        view["byteOffset"] = view.get("byteOffset", 0) + starts[view.pop("buffer")]
        view["buffer"] = 0
    for image in document.get("images", ()):
        if "uri" in image and not image["uri"].startswith("data:"):
            image["uri"] = quote((folder / unquote(image["uri"])).resolve().as_posix())
    return data


def _unpack(document: dict[str, Any], data: bytearray, primitive: dict[str, Any], packed: Any) -> None:
    """Decodes a primitive's attributes and indices into new buffer views."""
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
        accessor["componentType"] = 5125  # of 32-bit numbers
        _store(document, data, accessor, decoded.faces.astype(np.uint32).reshape(-1))


def _store(document: dict[str, Any], data: bytearray, accessor: dict[str, Any], values: np.ndarray) -> None:
    """Appends an accessor's values to `data`, each row at a multiple of four bytes, as glTF requires."""
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
    head = struct.pack("<4sII", MAGIC, 2, 12 + 8 + len(text) + 8 + len(data))
    chunks = struct.pack("<II", len(text), JSON) + text + struct.pack("<II", len(data), BIN) + data
    path.write_bytes(head + chunks)


@contextmanager
def prepared(scene: Path) -> Iterator[Path]:
    """Yields the file for Blender: `scene`, or an uncompressed copy for the block. Raises VibeError for bad meshes."""
    if scene.suffix.lower() == ".blend":
        yield scene
        return
    if scene.suffix.lower() in (".glb", ".gltf"):
        refuse_unread_extensions(scene)
    with tempfile.TemporaryDirectory(prefix="vibe-mesh-") as folder:
        path = unpacked(scene, Path(folder)) if is_packed(scene) else scene
        check(path)
        yield path


def check(path: Path) -> None:
    """Raises VibeError for a broken file, or if its meshes have no faces, no size or coordinates that are not finite.

    Text files over 16 MB and variants that trimesh does not know pass unchecked.
    """
    with path.open("rb") as file:
        is_text = b"\0" not in file.read(1024)
    if is_text and path.stat().st_size > _LONGEST_TEXT:
        return
    import trimesh

    try:
        # numpy would warn of values in a broken file, before trimesh or the checks below refuse it
        with np.errstate(all="ignore"):
            scene = trimesh.load_scene(path, process=False, skip_materials=True)
    except (ImportError, NotImplementedError):
        return  # a variant of the format that trimesh does not know; Blender may
    except Exception as error:
        reason = (str(error).strip() or type(error).__name__).splitlines()[0].rstrip(".")
        raise VibeError(f"{path.name} cannot be read: {reason[:120]}.", "Export it again.") from error
    meshes = [m for m in scene.geometry.values() if isinstance(m, trimesh.Trimesh) and len(m.faces)]
    if not meshes:
        raise VibeError(f"There is no mesh with faces in {path.name}.", "Check that it is a model.")
    if not all(np.isfinite(m.vertices).all() for m in meshes):
        raise VibeError(f"{path.name} has coordinates that are not finite numbers.", "Export it again.")
    if not np.ptp(np.stack([b for m in meshes for b in m.bounds]), axis=0).any():
        raise VibeError(f"The mesh in {path.name} has no size.", "Check that it is a model.")
