# SPDX-License-Identifier: Apache-2.0
"""Reads a reference image: JPEG, PNG, WebP, TIFF and similar formats, OpenEXR and Radiance (.hdr)."""

import io
import re
import warnings
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image, ImageCms, ImageOps, UnidentifiedImageError

from ..color import constants as c
from ..color.arrays import srgb_from_linear
from ..inputs import check
from ..schema import VibeError

LONGEST = 1024  # pixels of the longer side; more say nothing about a look

Pixels = tuple[np.ndarray, np.ndarray, bool]
"""Colors (H, W, 3), sRGB in [0, 1] or linear Rec.709 of at least 0; alpha (H, W) in [0, 1]; True for linear colors."""


def small_size(width: int, height: int, longest: int = LONGEST) -> tuple[int, int]:
    """Width and height, scaled down so that the longer one is at most `longest`; neither becomes less than 1."""
    factor = min(1.0, longest / max(width, height))
    return max(1, round(width * factor)), max(1, round(height * factor))


def shrunk_linear(color: np.ndarray, alpha: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A linear image (H, W, 3) and its alpha (H, W), averaged over areas to `small_size`; alpha weights the colors."""
    size = small_size(color.shape[1], color.shape[0])
    channels = [alpha, *(color[..., c] * alpha for c in range(3))]
    planes = [Image.fromarray(np.ascontiguousarray(channel, np.float32)) for channel in channels]
    weight, *sums = (np.asarray(plane.resize(size, Image.Resampling.BOX)) for plane in planes)
    return np.stack(sums, -1) / np.maximum(weight, 1e-6)[..., None], weight


def to_srgb(picture: Image.Image, icc: bytes) -> Pixels:
    """The pixels of a small image in sRGB; `icc` is its color profile, b"" for none."""
    alpha: np.ndarray = np.ones((picture.height, picture.width), np.float32)
    if picture.getbands()[-1] in ("A", "a"):
        straight = picture.convert(picture.mode.upper())
        alpha = np.asarray(straight.getchannel("A"), np.float32) / 255
        picture = straight.convert(straight.mode[:-1])
    # Without a usable profile, RGB counts as sRGB, and Pillow converts other modes such as CMYK.
    shown = picture.convert("RGB")
    if icc:
        with suppress(ImageCms.PyCMSError, OSError, ValueError):
            source, target = ImageCms.ImageCmsProfile(io.BytesIO(icc)), ImageCms.createProfile("sRGB")
            intent, flags = ImageCms.Intent.RELATIVE_COLORIMETRIC, ImageCms.Flags.BLACKPOINTCOMPENSATION
            made = ImageCms.profileToProfile(picture, source, target, intent, outputMode="RGB", flags=flags)
            shown = made or shown
    return np.asarray(shown, np.float32) / 255, alpha, False


_FORMATS = ("JPEG", "PNG", "WEBP", "TIFF", "BMP", "GIF", "AVIF", "JPEG2000", "PPM", "TGA", "QOI")  # flat images
_RAW = re.compile(r"\.(3fr|arw|cr[23w]|dng|erf|iiq|kdc|nef|nrw|orf|pef|raf|raw|rw2|srw|x3f)")


def read_encoded(path: Path) -> Pixels:
    """Reads an image, or the first of its frames or pages. Raises VibeError if it is no image, damaged or too large."""
    if _RAW.fullmatch(path.suffix.lower()):  # such a file is a TIFF with a thumbnail in it
        remedy = "Develop it, and save it as JPEG or TIFF."
        raise VibeError(f"{path.name} is a camera's raw picture, which has no look yet.", remedy)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a hundred megapixels are welcome, odd metadata is no matter
        try:
            with Image.open(path, formats=_FORMATS) as picture:
                return _pixels(picture)
        except UnidentifiedImageError as error:
            remedy = "Save it as PNG, JPEG, TIFF or EXR."
            raise VibeError(f"{path.name} is not a picture that can be read.", remedy) from error
        except Image.DecompressionBombError as error:
            problem = f"{path.name} has more than {2 * (Image.MAX_IMAGE_PIXELS or 0) // 10**6} megapixels."
            raise VibeError(problem, f"Scale it down; {LONGEST} pixels are enough.") from error
        except Exception as error:  # Pillow raises errors of a dozen classes for broken files
            remedy = "Save or download it again."
            raise VibeError(f"{path.name} is damaged or ends too early ({error}).", remedy) from error


def _pixels(picture: Image.Image) -> Pixels:
    icc = picture.info.get("icc_profile", b"")
    picture.draft(None, (LONGEST, LONGEST))  # a JPEG is decoded at an eighth, if that is large enough
    upright = ImageOps.exif_transpose(picture)
    if upright.mode == "F":  # gray floating-point numbers
        gray = np.asarray(upright, np.float32)
        good = np.isfinite(gray)
        color = np.repeat(np.where(good, gray, 0.0).clip(0.0)[..., None], 3, -1)
        return *shrunk_linear(color, good.astype(np.float32)), True
    # Modes whose pixels can be averaged
    if upright.mode.startswith("I"):  # of up to 16 bits
        values = np.asarray(upright).astype(np.float32) / 257.0
        upright = Image.fromarray(values.round().clip(0.0, 255.0).astype(np.uint8))
    elif upright.mode in ("P", "PA"):
        upright = upright.convert("RGBA")
    elif upright.mode == "1":
        upright = upright.convert("L")
    elif upright.mode in ("L", "RGB") and "transparency" in upright.info:
        upright = upright.convert("LA" if upright.mode == "L" else "RGBA")
    return to_srgb(upright.resize(small_size(*upright.size), Image.Resampling.BOX), icc)


_REC709 = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290)
_BRADFORD = np.array(((0.8951, 0.2664, -0.1614), (-0.7502, 1.7135, 0.0367), (0.0389, -0.0685, 1.0296)))
"""Matrix from XYZ to cone responses, for adaptation to another white (Lindbloom, "Chromatic Adaptation")."""


def read_exr(path: Path) -> Pixels:
    """Reads the main layer of an EXR, see `_layer`. Raises VibeError if the file is damaged or has no colors."""
    pixels, header = _layer(path)
    if pixels.ndim == 2:
        pixels = np.repeat(pixels[..., None], 3, -1)
    good = np.isfinite(pixels).all(-1)
    pixels = np.where(good[..., None], pixels, 0.0).astype(np.float32)
    color, alpha = pixels[..., :3], good.astype(np.float32)
    if pixels.shape[2] == 4:  # EXR holds colors that are multiplied by alpha
        alpha = alpha * pixels[..., 3].clip(0.0, 1.0)
        color = color / np.maximum(alpha, 1e-4)[..., None]
    primaries = header.get("chromaticities")
    if primaries is not None and not np.allclose(primaries, _REC709, atol=2e-3):
        color = color @ rec709_from(primaries).T.astype(np.float32)
    return *shrunk_linear(color.clip(0.0), alpha), True


def rec709_from(chromaticities: Sequence[float]) -> np.ndarray:
    """Matrix (3, 3) to linear Rec.709 from RGB with these CIE x, y of red, green, blue and white (adapted to D65)."""

    def xyz(x: float, y: float) -> np.ndarray:
        return np.array((x / y, 1.0, (1 - x - y) / y))

    *primaries, white = (xyz(*chromaticities[i : i + 2]) for i in (0, 2, 4, 6))
    columns = np.stack(primaries, 1)
    to_xyz = columns * np.linalg.solve(columns, white)
    ratio = (_BRADFORD @ xyz(*_REC709[6:8])) / (_BRADFORD @ white)
    adapted = np.linalg.solve(_BRADFORD, ratio[:, None] * _BRADFORD)
    return np.array(c.REC709_FROM_XYZ) @ adapted @ to_xyz


def _layer(path: Path) -> tuple[np.ndarray, Mapping[str, Any]]:
    """The pixels (H, W) or (H, W, 3 or 4) of the main layer, and the header of its part.

    The main layer is plain RGB, Blender's Combined, plain gray, or the only one with colors.
    """
    import OpenEXR

    try:
        with OpenEXR.File(str(path)) as file:
            layers = {
                name: (np.asarray(channel.pixels), dict(part.header))
                for part in file.parts
                for name, channel in part.channels.items()
            }
    except (OSError, RuntimeError, ValueError, TypeError, MemoryError) as error:
        raise VibeError(f"{path.name} is no EXR that can be read, or is damaged.", "Save it again.") from error
    colors = [name for name, (pixels, _) in layers.items() if pixels.ndim == 3 and pixels.shape[2] >= 3]
    ranked = [name for name in colors if name in ("RGBA", "RGB")]
    ranked += [name for name in colors if name.rpartition(".")[2] == "Combined"]
    ranked += [name for name in colors if name.rpartition(".")[2] in ("RGBA", "RGB", "rgba", "rgb", "beauty")]
    ranked += [name for name, (pixels, _) in layers.items() if name == "Y" and pixels.ndim == 2]
    ranked += colors if len(colors) == 1 else []
    if not ranked:
        raise VibeError(f"{path.name} holds no layer with colors.", "Save the render itself, the layer Combined.")
    return layers[ranked[0]]


def read_radiance(path: Path) -> Pixels:
    """Reads an RGBE image, run-length encoded or not. Raises VibeError if it is damaged, XYZE, or flipped or rotated."""
    data = path.read_bytes()
    size = re.search(rb"\n-Y (\d+) \+X (\d+)\n", data)
    if size is None or b"32-bit_rle_xyze" in data[: size.start()]:
        raise VibeError(f"{path.name} is an odd Radiance picture.", "Save it as EXR.")
    height, width = int(size[1]), int(size[2])
    try:
        bytes_ = _scanlines(data[size.end() :], width, height)
    except (IndexError, ValueError, MemoryError) as error:
        raise VibeError(f"{path.name} is damaged or ends too early.", "Download it again.") from error
    exponent = bytes_[..., 3:].astype(np.int32)
    color = np.where(exponent > 0, np.ldexp(bytes_[..., :3] + np.float32(0.5), exponent - 136), 0.0)
    return *shrunk_linear(color.astype(np.float32), np.ones((height, width), np.float32)), True


def _scanlines(data: bytes, width: int, height: int) -> np.ndarray:
    """The decoded pixels of an RGBE file: three mantissas and an exponent, uint8 (H, W, 4)."""
    start = bytes((2, 2, width >> 8, width & 255)) if 8 <= width < 1 << 15 else b""
    if not start or not data.startswith(start):
        return np.frombuffer(data, np.uint8, 4 * width * height).reshape(height, width, 4)
    lines, at = np.empty((height, 4, width), np.uint8), 0
    for line in lines:
        if data[at : at + 4] != start:
            raise ValueError("a scanline has another length")
        at += 4
        for channel in line:  # each is a sequence of runs of one byte, and of bytes as they are
            runs = bytearray()
            while len(runs) < width:
                count = data[at]
                if count > 128:
                    runs += data[at + 1 : at + 2] * (count - 128)
                    at += 2
                else:
                    runs += data[at + 1 : at + 1 + count]
                    at += 1 + count
            channel[:] = np.frombuffer(runs, np.uint8)  # raises ValueError for a run that is too long
    return lines.transpose(0, 2, 1)


@dataclass(frozen=True)
class ReferencePicture:
    """A reference image, read and reduced."""

    # (H, W, 3) float32, sRGB-encoded, in [0, 1]. For a linear image, this is `linear` with the sRGB curve, clipped at
    # white; `Reference.of` replaces it by `linear` with the scene's view transform
    display: np.ndarray
    linear: np.ndarray | None = None  # (H, W, 3) float32 linear Rec.709, at least 0; None for display colors
    alpha: np.ndarray | None = None  # (H, W) in [0, 1], how much each pixel counts; None if all count
    panorama: bool = False  # True for an equirectangular image of all directions


def read_reference(path: Path | str) -> ReferencePicture:
    """Reads an image, reduced to at most 1024 pixels a side. Raises VibeError for a missing or unreadable file."""
    found = check.file(str(path), "picture")
    with found.open("rb") as file:
        head = file.read(10)  # names can be wrong
    if head.startswith(b"\x76\x2f\x31\x01"):
        color, alpha, is_linear = read_exr(found)
    elif head.startswith((b"#?RADIANCE", b"#?RGBE")):
        color, alpha, is_linear = read_radiance(found)
    else:
        color, alpha, is_linear = read_encoded(found)
    if alpha.max() < 1 / 255:
        raise VibeError(f"Nothing is to be seen in {found.name}: all of it is transparent.", "Use another picture.")
    display = (srgb_from_linear(color).clip(0.0, 1.0) if is_linear else color).astype(np.float32)
    opaque = alpha.min() >= 1.0 - 0.5 / 255
    counts = None if opaque else alpha.astype(np.float32).clip(0.0, 1.0)
    return ReferencePicture(display, color if is_linear else None, counts, _wraps(display))


def _wraps(display: np.ndarray) -> bool:
    """True for a panorama: twice as wide as high, left and right edges alike, top row and bottom row of even color."""
    height, width = display.shape[:2]
    if height < 64 or abs(width - 2 * height) > 2:
        return False
    neighbors = np.abs(np.diff(display, axis=1)).mean()
    seam = np.abs(display[:, 0] - display[:, -1]).mean()
    # The first and the last row are one point each.
    poles, even = max(display[0].std(0).max(), display[-1].std(0).max()), 0.06
    return bool(seam <= 2.5 * neighbors + 1 / 255 and poles < even < display.std())
