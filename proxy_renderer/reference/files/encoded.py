# SPDX-License-Identifier: Apache-2.0
"""Pictures as cameras, browsers and paint programs write them: JPEG, PNG, WebP, TIFF and their like."""

from __future__ import annotations

import re
import struct
import warnings
from pathlib import Path

import numpy as np
from PIL import Image, ImageOps, UnidentifiedImageError

from ...schema import VibeError
from .profile import to_srgb
from .contents import LONGEST, FileContents, counted, shrunk_linear, small_size

FORMATS = ("JPEG", "PNG", "WEBP", "TIFF", "BMP", "GIF", "AVIF", "JPEG2000", "PPM", "TGA", "QOI")
"""Of Pillow's, those that hold one flat picture."""

_RAW = frozenset(
    [
        ".3fr",
        ".arw",
        ".cr2",
        ".cr3",
        ".crw",
        ".dng",
        ".erf",
        ".iiq",
        ".kdc",
        ".nef",
        ".nrw",
        ".orf",
        ".pef",
        ".raf",
        ".raw",
        ".rw2",
        ".srw",
        ".x3f",
    ]
)
_FAULTS = (OSError, SyntaxError, ValueError, TypeError, KeyError, IndexError, EOFError, OverflowError)
"""What Pillow raises at files whose inside is wrong."""
_PANORAMA = re.compile(rb"ProjectionType\W{1,3}equirectangular")


def read_encoded(path: Path) -> FileContents:
    """Reads a picture; of several frames or pages the first.

    Raises:
        VibeError: It is none, damaged, too large, or of a kind that nothing here reads.
    """
    _refuse_unread_kinds(path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a hundred megapixels are welcome, odd metadata is no matter
        try:
            with Image.open(path, formats=FORMATS) as picture:
                return _contents(picture, path)
        except UnidentifiedImageError as error:
            raise VibeError(
                f"{path.name} is not a picture that can be read.", "Save it as PNG, JPEG, TIFF or EXR."
            ) from error
        except Image.DecompressionBombError as error:
            raise VibeError(
                f"{path.name} has more than {2 * (Image.MAX_IMAGE_PIXELS or 0) // 10**6} megapixels.",
                f"Scale it down; {LONGEST} pixels are enough.",
            ) from error
        except (*_FAULTS, struct.error, MemoryError) as error:
            raise VibeError(
                f"{path.name} is damaged or ends too early ({error}).", "Save or download it again."
            ) from error


def _refuse_unread_kinds(path: Path) -> None:
    with path.open("rb") as file:
        head = file.read(12)
    if head[4:8] == b"ftyp" and head[8:12] in (b"heic", b"heix", b"hevc", b"heim", b"heis", b"mif1", b"msf1"):
        raise VibeError(f"{path.name} is a HEIC picture, which is not read.", "Export it as JPEG or PNG.")
    if path.suffix.lower() in _RAW:
        raise VibeError(
            f"{path.name} is a camera's raw picture, which has no look yet.",
            "Develop it, and save it as JPEG or TIFF.",
        )


def _contents(picture: Image.Image, path: Path) -> FileContents:
    notes = []
    if (count := getattr(picture, "n_frames", 1)) > 1 and picture.format != "MPO":
        notes.append(f"The first of its {count} frames or pages was read.")
    panorama = bool(_PANORAMA.search(_metadata(picture)))
    icc = picture.info.get("icc_profile", b"")
    full = picture.size
    picture.draft(None, (LONGEST, LONGEST))  # a JPEG is decoded at an eighth, if that is large enough
    turned = picture.getexif().get(0x0112, 1) != 1  # Pillow turns a TIFF itself, and then says nothing of it
    picture.load()
    upright = ImageOps.exif_transpose(picture)
    if turned:
        notes.append("It was turned upright, as its EXIF data say.")
    if max(full) > LONGEST:
        notes.append(f"It was reduced from {full[0]} × {full[1]} pixels.")
    if upright.mode == "F":
        return _floats(upright, panorama, notes)
    color, alpha, told = to_srgb(_small(upright), icc)
    return FileContents(color, alpha, linear=False, panorama=panorama, notes=(*notes, *told))


def _metadata(picture: Image.Image) -> bytes:
    """The XMP packet, where panoramas are told; b"" if there is none."""
    packet = picture.info.get("xmp") or picture.info.get("XML:com.adobe.xmp") or b""
    return packet.encode() if isinstance(packet, str) else packet


def _small(picture: Image.Image) -> Image.Image:
    """The picture in a mode whose pixels can be averaged, at `small_size`."""
    if picture.mode.startswith("I"):  # of up to 16 bits
        values = np.asarray(picture).astype(np.float32) / 257.0
        picture = Image.fromarray(values.round().clip(0.0, 255.0).astype(np.uint8))
    elif picture.mode in ("P", "PA"):
        clear = picture.mode == "PA" or "transparency" in picture.info
        picture = picture.convert("RGBA" if clear else "RGB")
    elif picture.mode == "1":
        picture = picture.convert("L")
    elif picture.mode in ("L", "RGB") and "transparency" in picture.info:
        picture = picture.convert("LA" if picture.mode == "L" else "RGBA")
    return picture.resize(small_size(*picture.size), Image.Resampling.BOX)


def _floats(picture: Image.Image, panorama: bool, notes: list[str]) -> FileContents:
    """A gray picture of floating-point numbers, which are linear light."""
    gray = np.asarray(picture, np.float32)
    good = np.isfinite(gray)
    color = np.repeat(np.where(good, gray, 0.0).clip(0.0)[..., None], 3, -1)
    small, alpha = shrunk_linear(color, good.astype(np.float32))
    return FileContents(small, counted(alpha), linear=True, panorama=panorama, notes=tuple(notes))
