# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the passes of a render from a multi-layer OpenEXR file. Blender's own Python can write them, not read them.

Only what Blender writes with the settings of `passes_of` is understood: one part, scan lines, no compression,
32-bit floats (openexr.com/en/latest/OpenEXRFileLayout.html).
"""

from __future__ import annotations

import struct
import tempfile
from pathlib import Path

import bpy
import numpy as np

from ..scene import scene_context
from . import final_render


def render_passes(scene: bpy.types.Scene) -> dict[str, np.ndarray]:
    """Renders a scene as it is set up; its first view layer's passes by name.

    Returns:
        (H, W, C) float32 each, row 0 at the bottom; the channels in the order R, G, B, A or X, Y, Z, W.
    """
    layer = scene_context.layer(scene)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "passes.exr"
        final_render.write_layers(scene, layer, path, exr_codec="NONE", use_exr_interleave=True)
        channels = read_exr(path)
    passes: dict[str, dict[str, np.ndarray]] = {}
    for name, values in channels.items():
        owner, _, letter = name.rpartition(".")
        if owner.startswith(f"{layer.name}."):
            passes.setdefault(owner[len(layer.name) + 1 :], {})[letter] = values
    order = "RGBAXYZW"
    return {
        name: np.stack([letters[k] for k in sorted(letters, key=order.index)], -1)
        for name, letters in passes.items()
    }


def read_exr(path: Path) -> dict[str, np.ndarray]:
    """Channels (H, W) float32 by their full names, row 0 at the bottom.

    Raises:
        ValueError: The file is of another kind.
    """
    data = path.read_bytes()
    if data[:4] != b"v/1\x01" or data[5] & 0b11010:  # tiles, deep data, several parts
        raise ValueError(f"{path.name} is not a plain OpenEXR file")
    header, start = _header(data)
    if header["compression"] != b"\0":
        raise ValueError(f"{path.name} is compressed")
    left, low, right, high = struct.unpack("<4i", header["dataWindow"])
    width, height = right - left + 1, high - low + 1
    names = _channels(header["channels"])
    line = 4 * width * len(names)
    begin = start + 8 * height  # after the table of lines, which follow one another
    rows = np.frombuffer(data, np.uint8, height * (line + 8), begin).reshape(height, line + 8)
    values = np.ascontiguousarray(rows[:, 8:]).view("<f4").reshape(height, len(names), width)
    return {name: values[::-1, i] for i, name in enumerate(names)}


def _header(data: bytes) -> tuple[dict[str, bytes], int]:
    """The attributes by name, and where they end."""
    attributes, at = {}, 8
    while data[at]:
        name_end = data.index(b"\0", at)
        kind_end = data.index(b"\0", name_end + 1)
        size = struct.unpack_from("<i", data, kind_end + 1)[0]
        attributes[data[at:name_end].decode()] = data[kind_end + 5 : kind_end + 5 + size]
        at = kind_end + 5 + size
    return attributes, at + 1


def _channels(table: bytes) -> list[str]:
    """The names of the channels, in the order of the lines' content."""
    names, at = [], 0
    while table[at]:
        end = table.index(b"\0", at)
        if struct.unpack_from("<i", table, end + 1)[0] != 2:
            raise ValueError("a channel does not hold 32-bit floats")
        names.append(table[at:end].decode())
        at = end + 17
    return names
