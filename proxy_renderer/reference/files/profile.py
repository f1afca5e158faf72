# SPDX-License-Identifier: Apache-2.0
"""Colors of a picture brought to sRGB by the profile that the file carries."""

from __future__ import annotations

import io

import numpy as np
from PIL import Image, ImageCms

from .contents import counted

_FLAGS = ImageCms.Flags.BLACKPOINTCOMPENSATION


def to_srgb(picture: Image.Image, icc: bytes) -> tuple[np.ndarray, np.ndarray | None, list[str]]:
    """sRGB of a picture in any mode that its profile fits.

    Args:
        picture: Small already; L, RGB, CMYK, LAB, YCbCr or HSV, the first two also with alpha.
        icc: The profile; b"" for none.

    Returns:
        Colors (H, W, 3) in [0, 1], alpha (H, W) or None, and what was done, a sentence each.
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
