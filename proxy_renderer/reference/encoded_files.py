# SPDX-License-Identifier: Apache-2.0
"""Pictures as cameras, browsers and paint programs write them: JPEG, PNG, WebP, TIFF and their like."""

import io
import re
import struct
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image, ImageCms, ImageOps, UnidentifiedImageError

from ..schema import VibeError

LONGEST = 1024  # longer side in pixels beyond which a picture tells nothing more of a look


@dataclass(frozen=True)
class FileContents:
    """The pixels of a file, at most `LONGEST` long."""

    color: np.ndarray  # (H, W, 3) float32: sRGB in [0, 1], or linear Rec.709, finite and at least 0
    alpha: np.ndarray | None  # (H, W) in [0, 1]; None if every pixel counts wholly
    linear: bool  # whether the colors are linear light
    panorama: bool  # whether the file itself says that it shows all directions
    notes: tuple[str, ...]  # what was done to it, a sentence each


def small_size(width: int, height: int) -> tuple[int, int]:
    """Width and height with the longer one at most `LONGEST`, and none below 1."""
    factor = min(1.0, LONGEST / max(width, height))
    return max(1, round(width * factor)), max(1, round(height * factor))


def shrunk_linear(color: np.ndarray, alpha: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Means of areas of a linear image (H, W, 3), each pixel weighted by its alpha (H, W) in [0, 1]: both at `small_size`.

    The color is 0 where the alpha is.
    """
    size = small_size(color.shape[1], color.shape[0])
    weight = _mean(alpha, size)
    sums = np.stack([_mean(color[..., c] * alpha, size) for c in range(3)], -1)
    return sums / np.maximum(weight, 1e-6)[..., None], weight


def counted(alpha: np.ndarray) -> np.ndarray | None:
    """The alpha as it is kept: None where all pixels count."""
    return None if alpha.min() >= 1.0 - 0.5 / 255 else alpha.astype(np.float32).clip(0.0, 1.0)


def _mean(channel: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    picture = Image.fromarray(np.ascontiguousarray(channel, np.float32))
    return np.asarray(picture.resize(size, Image.Resampling.BOX))


_FLAGS = ImageCms.Flags.BLACKPOINTCOMPENSATION


def to_srgb(picture: Image.Image, icc: bytes) -> tuple[np.ndarray, np.ndarray | None, list[str]]:
    """sRGB (H, W, 3) in [0, 1] of a small picture, alpha (H, W) or None, and what was done, a sentence each.

    It may be L, RGB, CMYK, LAB, YCbCr or HSV, the first two also with alpha, as its profile (b"" for none) fits.
    """
    alpha = None
    if picture.mode in ("LA", "RGBA", "La", "RGBa"):
        straight = picture.convert("RGBA") if picture.mode in ("RGBA", "RGBa") else picture.convert("LA")
        alpha = np.asarray(straight.getchannel("A"), np.float32) / 255
        picture = straight.convert(straight.mode[:-1])
    rgb, notes = _converted(picture, icc)
    if alpha is not None and counted(alpha) is not None:
        notes.append("Its transparent pixels do not count.")
    color = np.asarray(rgb, np.float32) / 255
    return color, None if alpha is None else counted(alpha), notes


def _converted(picture: Image.Image, icc: bytes) -> tuple[Image.Image, list[str]]:
    if not icc and picture.mode == "CMYK":
        return picture.convert("RGB"), ["Its inks have no color profile: their colors are guessed."]
    if not icc:
        return _plain(picture), []
    try:
        source = ImageCms.ImageCmsProfile(io.BytesIO(icc))
        name = (ImageCms.getProfileDescription(source) or "its color profile").strip()
        target = ImageCms.createProfile("sRGB")
        intent = ImageCms.Intent.RELATIVE_COLORIMETRIC
        made = ImageCms.profileToProfile(picture, source, target, intent, outputMode="RGB", flags=_FLAGS)
    except (ImageCms.PyCMSError, OSError, ValueError):
        return _plain(picture), ["Its color profile cannot be used: it was taken for sRGB."]
    assert made is not None
    return made, [] if "srgb" in name.lower() else [f"Its colors were brought from {name} to sRGB."]


def _plain(picture: Image.Image) -> Image.Image:
    """RGB of a picture without a profile, as Pillow has it."""
    if picture.mode == "LAB":
        lab, srgb = ImageCms.createProfile("LAB"), ImageCms.createProfile("sRGB")
        made = ImageCms.profileToProfile(picture, ImageCms.ImageCmsProfile(lab), srgb, outputMode="RGB")
        assert made is not None
        return made
    return picture.convert("RGB")


FORMATS = ("JPEG", "PNG", "WEBP", "TIFF", "BMP", "GIF", "AVIF", "JPEG2000", "PPM", "TGA", "QOI")
"""Of Pillow's, those that hold one flat picture."""

_RAW = re.compile(r"\.(3fr|arw|cr[23w]|dng|erf|iiq|kdc|nef|nrw|orf|pef|raf|raw|rw2|srw|x3f)")
_FAULTS = (OSError, SyntaxError, ValueError, TypeError, KeyError, IndexError, EOFError, OverflowError)
"""Errors that Pillow raises for broken files."""
_PANORAMA = re.compile(rb"ProjectionType\W{1,3}equirectangular")


def read_encoded(path: Path) -> FileContents:
    """Reads a picture; of several frames or pages the first. Raises VibeError if it is none, damaged or too large."""
    _refuse_unread_kinds(path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a hundred megapixels are welcome, odd metadata is no matter
        try:
            with Image.open(path, formats=FORMATS) as picture:
                return _contents(picture, path)
        except UnidentifiedImageError as error:
            remedy = "Save it as PNG, JPEG, TIFF or EXR."
            raise VibeError(f"{path.name} is not a picture that can be read.", remedy) from error
        except Image.DecompressionBombError as error:
            problem = f"{path.name} has more than {2 * (Image.MAX_IMAGE_PIXELS or 0) // 10**6} megapixels."
            raise VibeError(problem, f"Scale it down; {LONGEST} pixels are enough.") from error
        except (*_FAULTS, struct.error, MemoryError) as error:
            remedy = "Save or download it again."
            raise VibeError(f"{path.name} is damaged or ends too early ({error}).", remedy) from error


def _refuse_unread_kinds(path: Path) -> None:
    with path.open("rb") as file:
        head = file.read(12)
    if head[4:8] == b"ftyp" and head[8:12] in (b"heic", b"heix", b"hevc", b"heim", b"heis", b"mif1", b"msf1"):
        raise VibeError(f"{path.name} is a HEIC picture, which is not read.", "Export it as JPEG or PNG.")
    if _RAW.fullmatch(path.suffix.lower()):
        remedy = "Develop it, and save it as JPEG or TIFF."
        raise VibeError(f"{path.name} is a camera's raw picture, which has no look yet.", remedy)


def _contents(picture: Image.Image, path: Path) -> FileContents:
    notes = []
    if (count := getattr(picture, "n_frames", 1)) > 1 and picture.format != "MPO":
        notes.append(f"The first of its {count} frames or pages was read.")
    packet = picture.info.get("xmp") or picture.info.get("XML:com.adobe.xmp") or b""  # of XMP
    panorama = bool(_PANORAMA.search(packet.encode() if isinstance(packet, str) else packet))
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
    color, alpha, more = to_srgb(_small(upright), icc)
    return FileContents(color, alpha, linear=False, panorama=panorama, notes=(*notes, *more))


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
