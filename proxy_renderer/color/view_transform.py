# SPDX-License-Identifier: Apache-2.0
"""The scene's own view transform (AgX, Filmic, Standard, …), baked from its OCIO config and sampled differentiably."""

from __future__ import annotations

import functools
import math
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from ..schema import VibeError
from .tensors import trilinear

SIZE = 65
BRIGHTEST = 2.0**6
_TOE = 2.0**-8  # below this, samples are about evenly spaced in linear light; above it, in stops
_STOPS = math.log2(1 + BRIGHTEST / _TOE)


class ViewTransform:
    """Scene-linear Rec.709 to display, as Blender's color management does it; arguments and errors: see `apply_ocio`.

    The OCIO transform is sampled once, at 65³ colors that reach from black to 2⁶, about evenly spaced in stops;
    brighter light looks like 2⁶. Against OCIO itself the mean error is below 0.2/255 for every view that Blender has.
    """

    def __init__(
        self, ocio: str | Path, display: str, view: str, look: str = "", device: str = "cpu"
    ) -> None:
        self._lut = _bake(str(ocio), display, view, look).to(device)

    def __call__(self, linear: Float[Tensor, "*pixels 3"]) -> Float[Tensor, "*pixels 3"]:
        """Display values (..., 3), unclamped, of linear light (..., 3); differentiable in `linear`."""
        stops = torch.log2(linear.clamp(0, BRIGHTEST) * (1 / _TOE) + 1)
        position = (stops * (2 / _STOPS) - 1).reshape(-1, 3)
        values = trilinear(self._lut, position)
        return values.T.reshape(linear.shape)


@functools.lru_cache(maxsize=8)
def _bake(ocio: str, display: str, view: str, look: str) -> Tensor:
    """The table (1, 3, SIZE, SIZE, SIZE), indexed by [color, blue, green, red]. Takes about 0.1 s."""
    axis = _TOE * (2 ** torch.linspace(0, _STOPS, SIZE, dtype=torch.float64) - 1)
    blue, green, red = torch.meshgrid(axis, axis, axis, indexing="ij")
    colors = torch.stack((red, green, blue), -1).float().numpy()
    table = apply_ocio(colors, ocio, display, view, look).reshape(SIZE, SIZE, SIZE, 3)
    return torch.from_numpy(table).permute(3, 0, 1, 2)[None].contiguous()


def apply_ocio(
    colors: Float[np.ndarray, "*pixels 3"], ocio: str, display: str, view: str, look: str = ""
) -> Float[np.ndarray, "*pixels 3"]:
    """Exact transform of scene-linear Rec.709 (..., 3) to float32 display values (..., 3), composed as Blender composes it.

    A look chosen by the artist replaces those that the view has of its own
    (Blender: imbuf/opencolorio, create_ocio_display_transform).

    Args:
        ocio: Path of `config.ocio`.
        display: For example "sRGB".
        view: For example "AgX".
        look: For example "AgX - Punchy"; "" or "None" for the view's own.

    Raises:
        VibeError: The config cannot be read, or has no such display, view or look.
    """
    import PyOpenColorIO as OCIO

    try:
        config = OCIO.Config.CreateFromFile(ocio)
        source, group = "Linear Rec.709", OCIO.GroupTransform()
        if config.getColorSpace(source) is None:
            source = OCIO.ROLE_SCENE_LINEAR
        if look not in ("", "None"):
            target = config.getLook(look).getProcessSpace()
            group.appendTransform(OCIO.LookTransform(src=source, dst=target, looks=look))
            source = target
        bypass = look not in ("", "None")
        group.appendTransform(
            OCIO.DisplayViewTransform(src=source, display=display, view=view, looksBypass=bypass)
        )
        processor = config.getProcessor(group).getDefaultCPUProcessor()
    except (OCIO.Exception, OCIO.ExceptionMissingFile, AttributeError) as error:
        raise VibeError(
            f"The view transform {view!r} (display {display!r}, look {look or 'None'!r}) cannot be made from {ocio}.",
            "Choose another view transform under Render > Color Management.",
        ) from error
    flat = np.array(colors, dtype=np.float32).reshape(-1, 3)
    processor.applyRGB(flat)
    return flat.reshape(colors.shape)
