# SPDX-License-Identifier: GPL-3.0-or-later
"""PNG files as icons for panels, loaded again whenever a file has changed."""

from __future__ import annotations

import math
from pathlib import Path

import bpy.utils.previews
import numpy as np

_GAP = 6  # pixels between two pictures

_Version = tuple[tuple[Path, int], ...]
_slots: dict[tuple[bool, tuple[Path, ...]], tuple[_Version, bpy.utils.previews.ImagePreviewCollection]] = {}


def icon(*pictures: Path | None, square: bool = False) -> int:
    """The icon number of pictures for `layout.template_icon`.

    Args:
        pictures: Paths. Several become one icon: wide ones one above the other, others side by side.
        square: Whether only the square in the middle is shown.

    Returns:
        0 if none of the files exists yet.
    """
    there = tuple(p for p in pictures if p is not None and p.is_file())
    if not there:
        return 0
    version = tuple((path, path.stat().st_mtime_ns) for path in there)
    slot = square, there
    shown, collection = _slots.get(slot, (None, None))
    if collection is None:
        collection = bpy.utils.previews.new()
    if version != shown:
        collection.clear()
        parts = [_load(collection, path) for path in there]
        if len(parts) > 1 or square:
            whole = _composed([_pixels(part) for part in parts])
            _put(collection.new("vibe"), _middle(whole) if square else whole)
        _slots[slot] = version, collection
    return collection["vibe" if "vibe" in collection else str(there[0])].icon_id


def _load(collection: bpy.utils.previews.ImagePreviewCollection, path: Path) -> bpy.types.ImagePreview:
    loaded = collection.load(str(path), str(path), "IMAGE")
    loaded.image_size[:]  # reads the file now; else a job would read it, and the panel would flicker
    return loaded


def _pixels(part: bpy.types.ImagePreview) -> np.ndarray:
    """(H, W) int32: the four bytes of each pixel; row 0 is the bottom."""
    width, height = part.image_size
    pixels = np.empty(width * height, np.int32)
    part.image_pixels.foreach_get(pixels)
    return pixels.reshape(height, width)


def _put(target: bpy.types.ImagePreview, pixels: np.ndarray) -> None:
    target.image_size = pixels.shape[::-1]
    target.image_pixels.foreach_set(pixels.ravel())


def _middle(pixels: np.ndarray) -> np.ndarray:
    """The square in the middle."""
    height, width = pixels.shape
    side = min(height, width)
    bottom, left = (height - side) // 2, (width - side) // 2
    return pixels[bottom : bottom + side, left : left + side]


def _composed(parts: list[np.ndarray]) -> np.ndarray:
    """Several pictures as one, each as large as the largest of them; the first is at the top or at the left."""
    height, width = max((part.shape for part in parts), key=math.prod)
    fitting = [resized(part, height, width) for part in parts]
    wide = width >= height
    gap = np.zeros((_GAP, width) if wide else (height, _GAP), np.int32)
    ordered = fitting[::-1] if wide else fitting
    pieces = [piece for part in ordered for piece in (part, gap)][:-1]
    return np.concatenate(pieces, axis=0 if wide else 1)


def resized(pixels: np.ndarray, height: int, width: int) -> np.ndarray:
    """Pixels at another size, bilinear: the engine's first pictures are smaller than its last.

    Args:
        pixels: (H, W) int32, four 8-bit channels each.

    Returns:
        (height, width) int32.
    """
    channels = pixels.view(np.uint8).reshape(*pixels.shape, 4).astype(np.float32)
    for axis, count in enumerate((height, width)):
        place = np.linspace(0.0, channels.shape[axis] - 1.0, count)
        low = place.astype(int)
        high = np.minimum(low + 1, channels.shape[axis] - 1)
        part = (place - low).reshape([-1 if axis == a else 1 for a in range(3)])
        channels = channels.take(low, axis) * (1.0 - part) + channels.take(high, axis) * part
    return np.ascontiguousarray((channels + 0.5).astype(np.uint8)).view(np.int32)[..., 0]


def free() -> None:
    """Frees the pictures."""
    for _, collection in _slots.values():
        bpy.utils.previews.remove(collection)
    _slots.clear()
