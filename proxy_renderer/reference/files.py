# SPDX-License-Identifier: Apache-2.0
"""The picture that an artist gives as the words: JPEG, PNG, WebP, TIFF and their like, OpenEXR and Radiance (.hdr)."""

import io
import re
import struct
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image, ImageCms, ImageOps, UnidentifiedImageError

from ..color import constants as c
from ..color.arrays import srgb_from_linear
from ..inputs import check
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


def small_size(width: int, height: int, longest: int = LONGEST) -> tuple[int, int]:
    """Width and height with the longer one at most `longest`, and none below 1."""
    factor = min(1.0, longest / max(width, height))
    return max(1, round(width * factor)), max(1, round(height * factor))


def shrunk_linear(color: np.ndarray, alpha: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Means of areas of a linear image (H, W, 3), weighted by alpha (H, W) in [0, 1], and of the alpha, at `small_size`."""
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
    """sRGB (H, W, 3) in [0, 1] of a small picture by its profile (b"" for none), alpha (H, W) or None, and notes in sentences."""
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


_SEAM = 2.5  # how many times as much as neighbors the first and the last column of a panorama may differ
_POLE = 0.06  # greatest deviation along the first and the last row of a panorama, each of which is one point
_LEAST_PANORAMA = 64


@dataclass(frozen=True)
class ReferencePicture:
    """A picture as everything else takes it."""

    # (H, W, 3) float32, sRGB-encoded, in [0, 1]. Of linear light it is the plain sRGB curve, cut off at white, until
    # a scene is known, whose view shows `linear`
    display: np.ndarray
    linear: np.ndarray | None = None  # (H, W, 3) float32 linear Rec.709, at least 0; None for display colors
    alpha: np.ndarray | None = None  # (H, W) in [0, 1], how much each pixel counts; None if all count
    panorama: bool = False  # whether it shows all directions, the longitude from left to right
    note: str = ""  # what was done to it, in sentences; "" if nothing


def read_reference(path: Path | str) -> ReferencePicture:
    """Reads a picture, at most 1024 pixels long. Raises VibeError if there is none, or it cannot be read."""
    found = check.file(str(path), "picture")
    contents = _reader(found)(found)
    if contents.alpha is not None and contents.alpha.max() < 1 / 255:
        remedy = "Use another picture."
        raise VibeError(f"Nothing is to be seen in {found.name}: all of it is transparent.", remedy)
    linear = contents.color if contents.linear else None
    display = contents.color if linear is None else srgb_from_linear(linear).clip(0.0, 1.0)
    panorama, note = contents.panorama or _wraps(display), " ".join(contents.notes)
    return ReferencePicture(display.astype(np.float32), linear, contents.alpha, panorama, note)


def _reader(path: Path):
    """The reader of a file, by its first bytes: names lie."""
    with path.open("rb") as file:
        head = file.read(10)
    if head.startswith(b"\x76\x2f\x31\x01"):
        return read_exr
    if head.startswith((b"#?RADIANCE", b"#?RGBE")):
        return read_radiance
    return read_encoded


def _wraps(display: np.ndarray) -> bool:
    """True if a picture is twice as wide as high, goes on beyond its sides, and ends in one point above and below."""
    height, width = display.shape[:2]
    if height < _LEAST_PANORAMA or abs(width - 2 * height) > 2:
        return False
    neighbors = np.abs(np.diff(display, axis=1)).mean()
    seam = np.abs(display[:, 0] - display[:, -1]).mean()
    poles = (display[0].std(0).max(), display[-1].std(0).max())
    return bool(seam <= _SEAM * neighbors + 1 / 255 and max(poles) < _POLE and display.std() > _POLE)
