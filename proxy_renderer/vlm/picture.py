# SPDX-License-Identifier: Apache-2.0
"""Pictures as models take them."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image

if TYPE_CHECKING:
    from torch import Tensor

_SMALLEST, _LARGEST = 384, 1536  # pixels of the longer side: what models cut into patches well


def jpeg_of(picture: Tensor | Image.Image) -> bytes:
    """A small JPEG of a display picture (H, W, 3) in [0, 1], or of an image."""
    if not isinstance(picture, Image.Image):
        data = (picture.detach().cpu().numpy().clip(0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)
        picture = Image.fromarray(data)
    longest = max(picture.size)
    factor = min(max(longest, _SMALLEST), _LARGEST) / longest
    size = tuple(max(round(n * factor), 1) for n in picture.size)
    if size != picture.size:
        picture = picture.resize((size[0], size[1]), Image.Resampling.LANCZOS)
    file = io.BytesIO()
    picture.convert("RGB").save(file, "JPEG", quality=90)
    return file.getvalue()
