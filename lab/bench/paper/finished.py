# SPDX-License-Identifier: Apache-2.0
"""A finished picture as it is measured: its colors, where the subject is, and what the camera sees there."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from PIL import Image
from scipy import ndimage

from proxy_renderer.claims.measures.picture import MeasuredPicture
from proxy_renderer.color import tensors
from proxy_renderer.engine.pictures import load_picture
from proxy_renderer.render.surface.view_cache import GBuffer

FloatArray = NDArray[np.float64]
_BORDER = 1  # pixels on either side of an outline that belong to neither


@dataclass(frozen=True)
class FinishedPicture:
    """One picture of Cycles.

    Attributes:
        display: (H, W, 3) sRGB-encoded, in [0, 1].
        mask: (H, W) in [0, 1], how much of a pixel the subject covers.
        normal: (H, W, 3) in the camera's space: x to the right, y up, z towards it; zero for nothing.
        material: (H, W), number in `materials`, -1 for nothing.
        materials: Names.
        clear: The same picture without fog; None where nobody asked for it.
    """

    display: FloatArray
    mask: FloatArray
    normal: FloatArray = field(default_factory=lambda: np.zeros((0, 0, 3)))
    material: NDArray[np.int64] = field(default_factory=lambda: np.zeros((0, 0), np.int64))
    materials: tuple[str, ...] = ()
    clear: FloatArray | None = None

    @property
    def measured(self) -> MeasuredPicture:
        """As the measures of claims take it; what is not known is how much air is in between, and what textures do."""
        mask = torch.from_numpy(self.mask)
        seen = GBuffer(
            subject=mask,
            material=torch.from_numpy(self.material),
            materials=self.materials,
            normal=torch.from_numpy(self.normal),
            transmittance=torch.ones_like(mask),
            pattern=torch.ones_like(mask),
        )
        return MeasuredPicture(torch.from_numpy(self.display), seen)

    @property
    def lab(self) -> FloatArray:
        """(H, W, 3) CIE Lab."""
        return tensors.lab_from_srgb(torch.from_numpy(self.display)).numpy()

    @property
    def luminance(self) -> FloatArray:
        """(H, W) linear."""
        return luminance(self.display)

    def region(self, name: str) -> NDArray[np.bool_]:
        """(H, W): the pixels that lie wholly in a region.

        Args:
            name: "subject", "surroundings", "picture", or a material's name.

        Raises:
            KeyError: There is no such material.
        """
        if name == "picture":
            return np.ones(self.mask.shape, bool)
        if name == "subject":
            return _inner(self.mask > 0.9)
        if name == "surroundings":
            return _inner(self.mask < 0.05)
        if name not in self.materials:
            raise KeyError(name)
        return _inner(self.material == self.materials.index(name))


def luminance(display: FloatArray) -> FloatArray:
    """Linear luminance (H, W) of an sRGB-encoded picture (H, W, 3)."""
    return tensors.luminance(tensors.linear_from_srgb(torch.from_numpy(display)))[..., 0].numpy()


def load(folder: Path, which: str) -> FinishedPicture:
    """Reads a run's picture with everything that it is measured by.

    Args:
        which: "before" for the artist's, "after" for the result.
    """
    mask = {"before": "mask_before.png", "after": "mask.png"}[which]
    clear = folder / "clear.png" if which == "after" else None
    return read(folder / f"{which}.png", folder / mask, folder / f"{which}.npz", clear)


def read(picture: Path, mask: Path, sight: Path, clear: Path | None = None) -> FinishedPicture:
    """Reads a picture from its files.

    Args:
        sight: What the camera sees, an .npz of Blender's side (`camera_hits.py`).
        clear: The same picture without fog; it need not be there.
    """
    with Image.open(mask) as image:
        covered = np.asarray(image.convert("L"), float) / 255.0
    with np.load(sight) as seen:
        return FinishedPicture(
            display=load_picture(picture).astype(float),
            mask=covered,
            normal=_spread(seen["normal"].astype(float), covered.shape),
            material=_spread(seen["material"].astype(np.int64), covered.shape),
            materials=tuple(seen["materials"].tolist()),
            clear=load_picture(clear).astype(float) if clear and clear.is_file() else None,
        )


def _inner(where: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """A region without its outline; the whole of it where it is all outline, as wires are."""
    inside = ndimage.binary_erosion(where, iterations=_BORDER, border_value=1)
    return inside if inside.sum() >= 0.25 * where.sum() else where


def _spread(grid: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    """A grid (N, N, ...) at a picture's height and width, by nearest cell."""
    rows, columns = (((np.arange(n) + 0.5) * m / n).astype(int) for n, m in zip(shape, grid.shape, strict=False))
    return grid[rows[:, None], columns]
