# SPDX-License-Identifier: Apache-2.0
"""Radiance pictures (.hdr), as most HDRIs come: nothing that is installed with the product reads them.

Source of the format: Greg Ward, "Real Pixels", Graphics Gems II, 1991, and Radiance's color.c.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ...schema import VibeError
from ..encoded_files import LONGEST, FileContents, shrunk_linear

_SIZE = re.compile(rb"\n([-+])Y (\d+) ([-+])X (\d+)\n")
_MOST = 2 * 10**8


def read_radiance(path: Path) -> FileContents:
    """Reads an RGBE picture, run-length encoded or not.

    Raises:
        VibeError: It is damaged, too large, or holds XYZ or turned pixels.
    """
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
