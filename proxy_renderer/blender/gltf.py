# SPDX-License-Identifier: Apache-2.0
"""What a glTF file requires of its reader, and whether Blender's importer can do that."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

from ..schema import VibeError

MAGIC, JSON, BIN = b"glTF", 0x4E4F534A, 0x004E4942
_READ = frozenset(
    f"KHR_{name}"
    for name in [
        "animation_pointer",
        "draco_mesh_compression",
        "lights_punctual",
        "mesh_quantization",
        "texture_transform",
        "xmp_json_ld",
        "materials_anisotropy",
        "materials_clearcoat",
        "materials_dispersion",
        "materials_emissive_strength",
        "materials_ior",
        "materials_iridescence",
        "materials_pbrSpecularGlossiness",
        "materials_sheen",
        "materials_specular",
        "materials_transmission",
        "materials_unlit",
        "materials_variants",
        "materials_volume",
    ]
) | {"EXT_mesh_gpu_instancing", "EXT_texture_webp"}
"""Extensions that Blender 4.5 and 5 read, or pass over without harm; Draco is unpacked here."""
_BASISU = "KHR_texture_basisu"
_UNCOMPRESSED = "Export it again without compression."
_REMEDIES = {
    _BASISU: "Export it again with PNG or JPEG textures.",
    "EXT_meshopt_compression": _UNCOMPRESSED,
    "KHR_meshopt_compression": _UNCOMPRESSED,
}


def read(path: Path) -> tuple[dict[str, Any], bytes]:
    """The document and the binary chunk of a .glb or .gltf; b"" where it has none.

    Raises:
        ValueError: It is neither; so does struct.error.
    """
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


def check(path: Path) -> None:
    """Refuses a glTF file that requires what Blender's importer cannot do; a broken one is left to others.

    Raises:
        VibeError: It cannot be read as it is meant.
    """
    try:
        document, _ = read(path)
        required = set(document.get("extensionsRequired", ()))
        textures = [dict(texture) for texture in document.get("textures", ())]
    except (ValueError, OSError, struct.error, AttributeError, TypeError):
        return
    if any(_BASISU in t.get("extensions", {}) and "source" not in t for t in textures):
        required.add(_BASISU)
    for name in sorted(required - _READ):
        remedy = _REMEDIES.get(name, "Export it again without this extension.")
        raise VibeError(f"{path.name} needs the glTF extension {name}, which Blender cannot read.", remedy)
