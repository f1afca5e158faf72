# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts that panels share: wrapped text, durations and sizes in words, icons of images and colors, timers."""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Callable, Sequence
from pathlib import Path

import bpy
import bpy.utils.previews
import numpy as np

from ..looks.library import Look

GROUP_ICONS = {
    "camera": "OUTLINER_OB_CAMERA",
    "light": "OUTLINER_OB_LIGHT",
    "world": "WORLD",
    "material": "MATERIAL",
    "volume": "OUTLINER_OB_VOLUME",
    "film": "COLOR",
}
_PLACES = {"VIEW_3D": "UI", "PREFERENCES": "WINDOW"}  # areas that have panels of Vibe Render -> their regions
_GAP = 6  # pixels between two images in one icon
_CAPTIONS = ("Before", "After, as predicted")

_Version = tuple[tuple[Path, int], ...]  # each image file with its modification time (ns)
# Icons in use. Key: a color, or (True if cropped to a square, image files). Value: the files' versions, the icon.
_slots: dict[tuple[bool, tuple[Path, ...]] | str, tuple[_Version, bpy.utils.previews.ImagePreviewCollection]] = {}
_timers: set[Callable[[], float | None]] = set()  # those that `begin` has registered
HEX_COLOR = re.compile(r"(#[0-9a-f]{6})")


def paragraph(
    layout: bpy.types.UILayout, context: bpy.types.Context, text: str, icon: str = "NONE", faint: bool = False,
    letters: int = 0,
) -> None:  # fmt: skip
    """Draws wrapped text with at most `letters` characters a line; 0 for as many as fit into the region."""
    column = layout.column(align=True)
    column.scale_y, column.active = 0.8, not faint
    width = (letters or columns(context)) - (3 if icon != "NONE" else 0)
    lines = textwrap.wrap(text, width, break_on_hyphens=False)
    for number, line in enumerate(lines):
        column.label(text=line, icon="BLANK1" if number and icon != "NONE" else icon)


def see_rendered(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draws a button that switches the viewport to Rendered, unless it is Rendered already."""
    space = context.space_data
    if space and space.type == "VIEW_3D" and space.shading.type != "RENDERED":
        layout.prop_enum(space.shading, "type", "RENDERED", text="Rendered View")


def columns(context: bpy.types.Context) -> int:
    """The approximate number of characters that fit into a line of the region; at least 16."""
    return max(16, int(context.region.width / (7.0 * context.preferences.system.ui_scale)) - 5)


def duration(seconds: float) -> str:
    """Seconds in words: "40 s", "12 min", "3 h"."""
    if seconds >= 5400:
        return f"{seconds / 3600:.0f} h"
    return f"{seconds / 60:.0f} min" if seconds >= 90 else f"{max(seconds, 1):.0f} s"


def size(count: float) -> str:
    """Bytes in words: "12 bytes", "3.4 MB"."""
    for unit in ("bytes", "kB", "MB"):
        if count < 1000:
            return f"{count:.0f} {unit}" if unit == "bytes" else f"{count:.1f} {unit}"
        count /= 1000
    return f"{count:.1f} GB"


def redraw() -> None:
    """Redraws the regions that have panels of Vibe Render, and no others."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            for region in area.regions:
                if region.type == _PLACES.get(area.type):
                    region.tag_redraw()


def begin(timer: Callable[[], float | None], after: float, persistent: bool = False) -> None:
    """Registers a timer function, unless it is registered already; Blender first calls it in `after` seconds.

    It returns the seconds until its next call, or None to end. If `persistent`, it goes on when a file is opened.
    """
    _timers.add(timer)
    if not bpy.app.timers.is_registered(timer):
        bpy.app.timers.register(timer, first_interval=after, persistent=persistent)


def end_timers() -> None:
    """Ends the timers of `begin`, when the add-on is switched off."""
    for timer in filter(bpy.app.timers.is_registered, _timers):
        bpy.app.timers.unregister(timer)
    _timers.clear()


def look_icon(look: Look) -> int:
    """The icon number of a preset's image for `layout.template_icon`; one of Blender's own icons if it has none."""
    if look.picture.is_file():
        return icon(look.picture)
    names = bpy.types.UILayout.bl_rna.functions["prop"].parameters["icon"].enum_items
    return names["ERROR" if look.problem else "IMAGE_DATA"].value


def icon(*pictures: Path | None, square: bool = False) -> int:
    """The number of an icon that shows all image files that exist; 0 if none does.

    Several images are side by side or, if wide, one above the other. With `square`, the icon is the middle square.
    """
    there = tuple(p for p in pictures if p is not None and p.is_file())
    if not there:
        return 0
    version = tuple((path, path.stat().st_mtime_ns) for path in there)
    slot = square, there
    shown, collection = _slots.get(slot, (None, None))
    if collection is None:
        collection = bpy.utils.previews.new()
    if version != shown:  # one of the files is new or has changed
        collection.clear()
        parts = [collection.load(str(path), str(path), "IMAGE") for path in there]
        for part in parts:
            part.image_size[:]  # reads the file now; else a job would read it, and the panel would flicker
        if len(parts) > 1 or square:
            images = [_pixels(part) for part in parts]
            # All get the size of the largest: the first images of a search are smaller than the later ones.
            height, width = max((image.shape for image in images), key=math.prod)
            wide = width >= height
            gap = np.zeros((_GAP, width) if wide else (height, _GAP), np.int32)
            ordered = images[::-1] if wide else images  # row 0 is at the bottom
            pieces = [piece for image in ordered for piece in (resized(image, height, width), gap)][:-1]
            whole = np.concatenate(pieces, axis=0 if wide else 1)
            if square:
                side = min(whole.shape)
                bottom, left = ((count - side) // 2 for count in whole.shape)
                whole = whole[bottom : bottom + side, left : left + side]
            shown_part = collection.new("vibe")
            shown_part.image_size = whole.shape[::-1]
            shown_part.image_pixels.foreach_set(whole.ravel())
        _slots[slot] = version, collection
    return collection["vibe" if "vibe" in collection else str(there[0])].icon_id


def before_after(
    layout: bpy.types.UILayout,
    before: Path | None,
    after: Path | None,
    scale: float,
    captions: Sequence[str] = _CAPTIONS,
) -> None:
    """Draws those of two image files that exist as one icon, `scale` buttons high, with their captions."""
    pairs = zip((before, after), captions, strict=True)
    there = [(path, name) for path, name in pairs if path and path.is_file()]
    if not there:
        return
    paths = tuple(path for path, _ in there)
    number = icon(*paths)
    width, height = _slots[False, paths][1][str(paths[0])].image_size
    stacked, column = width >= height, layout.column(align=True)
    if stacked and len(there) > 1:
        caption(column, there.pop(0)[1], 0.7)
    column.template_icon(icon_value=number, scale=scale)
    row = column.row()
    for _, name in there:
        caption(row, name, 0.7)


def caption(layout: bpy.types.UILayout, text: str, scale: float = 1.0) -> None:
    """Draws a faint, centered line of text, `scale` buttons high."""
    row = layout.row()
    row.active, row.alignment, row.scale_y = False, "CENTER", scale
    row.label(text=text)


def colored(layout: bpy.types.UILayout, text: str) -> None:
    """Draws a line of text in which each color, such as #c8102e, is replaced by a swatch."""
    row = layout.row(align=True)
    row.alignment, row.scale_y = "LEFT", 0.8
    row.label(icon="BLANK1")
    for number, part in enumerate(HEX_COLOR.split(text)):
        if number % 2 == 0:
            row.label(text=part)
            continue
        if part not in _slots:
            _slots[part] = (), bpy.utils.previews.new()
            swatch = _slots[part][1].new("vibe")
            swatch.icon_size = 16, 16
            swatch.icon_pixels_float.foreach_set([*(c / 255 for c in bytes.fromhex(part[1:])), 1.0] * 256)
        row.label(icon_value=_slots[part][1]["vibe"].icon_id)


def free_icons() -> None:
    """Frees the icons of all images and colors."""
    for _, collection in _slots.values():
        bpy.utils.previews.remove(collection)
    _slots.clear()


def _pixels(part: bpy.types.ImagePreview) -> np.ndarray:
    """The pixels of a preview: (H, W) int32, each four 8-bit channels, row 0 at the bottom."""
    width, height = part.image_size
    pixels = np.empty(width * height, np.int32)
    part.image_pixels.foreach_get(pixels)
    return pixels.reshape(height, width)


def resized(pixels: np.ndarray, height: int, width: int) -> np.ndarray:
    """Pixels (H, W) int32, each four 8-bit channels, resized bilinearly to (height, width)."""
    channels = pixels.view(np.uint8).reshape(*pixels.shape, 4).astype(np.float32)
    for axis, count in enumerate((height, width)):
        place = np.linspace(0.0, channels.shape[axis] - 1.0, count)
        low = place.astype(int)
        high = np.minimum(low + 1, channels.shape[axis] - 1)
        part = (place - low).reshape([-1 if axis == a else 1 for a in range(3)])
        channels = channels.take(low, axis) * (1.0 - part) + channels.take(high, axis) * part
    return np.ascontiguousarray((channels + 0.5).astype(np.uint8)).view(np.int32)[..., 0]
