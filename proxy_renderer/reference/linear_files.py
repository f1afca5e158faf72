# SPDX-License-Identifier: Apache-2.0
"""Pictures of linear light: OpenEXR, and Radiance (.hdr), which nothing that is installed with the product reads."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..color import constants as c
from ..schema import VibeError
from .encoded_files import LONGEST, FileContents, counted, shrunk_linear

_LARGEST = 3 * 10**9  # bytes of all channels, above which a file is not opened
_REC709 = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290)
_BRADFORD = np.array(((0.8951, 0.2664, -0.1614), (-0.7502, 1.7135, 0.0367), (0.0389, -0.0685, 1.0296)))
"""Cones from XYZ, for adaptation to another white (Lindbloom, "Chromatic Adaptation")."""


def read_exr(path: Path) -> FileContents:
    """Reads an EXR's only layer, or Blender's Combined. Raises VibeError if it is damaged or too large."""
    layer, pixels, header = _picture(path)
    if pixels.ndim == 2:
        pixels = np.repeat(pixels[..., None], 3, -1)
    notes = [] if layer in ("RGB", "RGBA", "Y") else [f"Its layer {layer} was read."]
    good = np.isfinite(pixels).all(-1)
    if not good.all():
        notes.append(f"{np.count_nonzero(~good)} of its pixels are no numbers, and do not count.")
    pixels = np.where(good[..., None], pixels, 0.0).astype(np.float32)
    color, alpha = pixels[..., :3], good.astype(np.float32)
    if pixels.shape[2] == 4:  # EXR holds colors that are multiplied by alpha
        alpha = alpha * pixels[..., 3].clip(0.0, 1.0)
        color = color / np.maximum(alpha, 1e-4)[..., None]
    primaries = header.get("chromaticities")
    if primaries is not None and not np.allclose(primaries, _REC709, atol=2e-3):
        color = color @ rec709_from(primaries).T.astype(np.float32)
        notes.append("Its colors were brought to Rec.709.")
    if max(color.shape[:2]) > LONGEST:
        notes.append(f"It was reduced from {color.shape[1]} × {color.shape[0]} pixels.")
    small, alpha = shrunk_linear(color.clip(0.0), alpha)
    return FileContents(small, counted(alpha), linear=True, panorama="envmap" in header, notes=tuple(notes))


def rec709_from(chromaticities: Sequence[float]) -> np.ndarray:
    """Matrix (3, 3) to linear Rec.709 from CIE x and y of red, green, blue and white, which is adapted."""

    def white(xy: Sequence[float]) -> np.ndarray:
        return np.array((xy[0] / xy[1], 1.0, (1 - xy[0] - xy[1]) / xy[1]))

    def xyz(numbers: Sequence[float]) -> np.ndarray:
        columns = np.stack([white(numbers[i : i + 2]) for i in (0, 2, 4)], 1)
        return columns * np.linalg.solve(columns, white(numbers[6:8]))

    ratio = (_BRADFORD @ white(_REC709[6:8])) / (_BRADFORD @ white(chromaticities[6:8]))
    adapted = np.linalg.solve(_BRADFORD, ratio[:, None] * _BRADFORD)
    return np.array(c.REC709_FROM_XYZ) @ adapted @ xyz(chromaticities)


def _picture(path: Path) -> tuple[str, np.ndarray, Mapping[str, Any]]:
    """The layer's name, its pixels (H, W) or (H, W, 3 or 4), and the header of its part."""
    import OpenEXR

    try:
        with OpenEXR.File(str(path), header_only=True) as file:
            _refuse_large(path, [part.header for part in file.parts])
        with OpenEXR.File(str(path)) as file:
            layers = {
                name: (np.asarray(channel.pixels), dict(part.header))
                for part in file.parts
                for name, channel in part.channels.items()
            }
    except (OSError, RuntimeError, ValueError, TypeError, MemoryError) as error:
        remedy = "Save it again."
        raise VibeError(f"{path.name} is no EXR that can be read, or is damaged.", remedy) from error
    name = _best(layers)
    if name is None:
        remedy = "Save the render itself, the layer Combined."
        raise VibeError(f"{path.name} holds no layer with colors.", remedy)
    return name, *layers[name]


def _refuse_large(path: Path, headers: Sequence[Mapping[str, Any]]) -> None:
    size = 0
    for header in headers:
        low, high = header["dataWindow"]
        size += 4 * len(header["channels"]) * int(high[0] - low[0] + 1) * int(high[1] - low[1] + 1)
    if size > _LARGEST:
        remedy = "Save only its layer Combined, or a smaller picture."
        raise VibeError(f"{path.name} would fill {size / 1e9:.0f} GB of memory.", remedy)


def _best(layers: Mapping[str, tuple[np.ndarray, Mapping[str, Any]]]) -> str | None:
    """The layer that is the picture: plain RGB, Blender's Combined, or plain gray."""
    colors = [name for name, (pixels, _) in layers.items() if pixels.ndim == 3 and pixels.shape[2] >= 3]
    ranked = [name for name in colors if name in ("RGBA", "RGB")]
    ranked += [name for name in colors if name.rpartition(".")[2] == "Combined"]
    ranked += [name for name in colors if name.rpartition(".")[2] in ("RGBA", "RGB", "rgba", "rgb", "beauty")]
    ranked += [name for name, (pixels, _) in layers.items() if name == "Y" and pixels.ndim == 2]
    return next(iter(ranked), colors[0] if len(colors) == 1 else None)


_SIZE = re.compile(rb"\n([-+])Y (\d+) ([-+])X (\d+)\n")
_MOST = 2 * 10**8


def read_radiance(path: Path) -> FileContents:
    """Reads an RGBE picture, run-length encoded or not. Raises VibeError if it is damaged, too large, XYZ or turned."""
    data = path.read_bytes()
    size = _SIZE.search(data)
    if size is None or b"32-bit_rle_xyze" in data[: size.start()]:
        raise VibeError(f"{path.name} is an odd Radiance picture.", "Save it as EXR.")
    height, width = int(size[2]), int(size[4])
    if not 0 < height * width <= _MOST:
        raise VibeError(f"{path.name} says that it has {width} × {height} pixels.", "Save a smaller one.")
    try:
        bytes_ = _scanlines(data[size.end() :], width, height)
    except (IndexError, ValueError) as error:
        raise VibeError(f"{path.name} is damaged or ends too early.", "Download it again.") from error
    bytes_ = bytes_[:: 1 if size[1] == b"-" else -1, :: 1 if size[3] == b"+" else -1]
    exponent = bytes_[..., 3:].astype(np.int32)
    color = np.where(exponent > 0, np.ldexp(bytes_[..., :3] + np.float32(0.5), exponent - 136), 0.0)
    notes = () if max(width, height) <= LONGEST else (f"It was reduced from {width} × {height} pixels.",)
    small, _ = shrunk_linear(color.astype(np.float32), np.ones((height, width), np.float32))
    return FileContents(small, None, linear=True, panorama=False, notes=notes)


def _scanlines(data: bytes, width: int, height: int) -> np.ndarray:
    """Mantissas and exponents, uint8 (H, W, 4)."""
    start = bytes((2, 2, width >> 8, width & 255)) if 8 <= width < 1 << 15 else b""
    if not start or not data.startswith(start):
        flat = np.frombuffer(data, np.uint8, 4 * width * height).reshape(height, width, 4)
        if (flat[..., :3] == 1).all(-1).any():
            raise ValueError("run lengths of before 1991")
        return flat
    lines, at = np.empty((height, 4, width), np.uint8), 0
    for line in lines:
        if data[at : at + 4] != start:
            raise ValueError("a scanline has another length")
        at = _decode(data, at + 4, line)
    return lines.transpose(0, 2, 1)


def _decode(data: bytes, at: int, line: np.ndarray) -> int:
    """Fills the four channels of one scanline (4, W) from their runs; returns where the next one begins."""
    for channel in line:
        filled = 0
        while filled < len(channel):
            count = data[at]
            if count > 128:
                count -= 128
                run = np.frombuffer(data, np.uint8, 1, at + 1)
                at += 2
            else:
                run = np.frombuffer(data, np.uint8, count, at + 1)
                at += 1 + count
            if count == 0 or filled + count > len(channel):
                raise ValueError("a run is too long")
            channel[filled : filled + count] = run
            filled += count
    return at
