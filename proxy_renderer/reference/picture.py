# SPDX-License-Identifier: Apache-2.0
"""The picture that an artist gives as the words, whatever file it is in."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..color.arrays import srgb_from_linear
from ..inputs import check
from ..schema import VibeError
from .files import read_encoded, read_exr, read_radiance

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
    return ReferencePicture(
        display=display.astype(np.float32),
        linear=linear,
        alpha=contents.alpha,
        panorama=contents.panorama or _wraps(display),
        note=" ".join(contents.notes),
    )


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
