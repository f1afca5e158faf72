# SPDX-License-Identifier: Apache-2.0
"""Reading the picture that a look is taken from."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image, UnidentifiedImageError

from ..schema import VibeError


@dataclass(frozen=True)
class ReferencePicture:
    """A picture whose look is wanted.

    Attributes:
        display: (H, W, 3) float32 as shown, sRGB-encoded in [0, 1].
        linear: (H, W, 3) float32 scene-linear Rec.709; None where the file has only what is shown.
        alpha: (H, W) float32 coverage; None where all is opaque.
        panorama: Whether it shows all directions, as an HDRI does.
    """

    display: np.ndarray
    linear: np.ndarray | None = None
    alpha: np.ndarray | None = None
    panorama: bool = False


def read_reference(path: Path) -> ReferencePicture:
    """Reads a picture.

    Args:
        path: Of the file.

    Raises:
        VibeError: It cannot be read as a picture.
    """
    try:
        with Image.open(path) as image:
            return ReferencePicture(np.asarray(image.convert("RGB"), np.float32) / 255.0)
    except (OSError, UnidentifiedImageError) as error:
        raise VibeError(f"{path.name} is not a picture that can be read.", "Use a PNG or a JPEG.") from error
