# SPDX-License-Identifier: Apache-2.0
"""Pictures that Cycles has rendered for the engine: multilayer EXRs, as linear Rec.709."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from ...scene import FilmSettings
from ...schema import VibeError

_REC709 = "Linear Rec.709"
_BRIGHTEST = 1e4
_ROUNDING = 1e-3
"""Share of a pixel below which what no group accounts for is taken for rounding."""


@dataclass(frozen=True)
class CyclesPicture:
    """A picture, and whose light it is made of.

    Attributes:
        whole: (H, W, 3) linear Rec.709, finite, at least 0.
        parts: Owner, "light/NAME" or "world", to the noisy picture (H, W, 3) of its light alone.
        rest: (H, W, 3) noisy, the light that no part holds.
        denoised: Whether the whole is free of noise.
    """

    whole: Tensor
    parts: Mapping[str, Tensor]
    rest: Tensor
    denoised: bool = True

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        return self.whole.shape[1], self.whole.shape[0]

    @staticmethod
    def load(path: Path | str, groups: Mapping[str, str], film: FilmSettings) -> CyclesPicture:
        """Reads what the add-on's `anchoring.render_anchor` has written.

        Args:
            groups: Name of a light group to its owner, as `render_anchor` returns them.
            film: Of the scene, for its working color space.

        Raises:
            VibeError: The file cannot be read, or lacks a picture.
        """
        layers = _layers(Path(path))
        denoised = "Noisy Image" in layers  # some builds of Blender have no denoiser
        layers.setdefault("Noisy Image", layers.get("Combined", np.empty(0)))
        wanted = {"Combined": "", "Noisy Image": "", **{f"Combined_{g}": o for g, o in groups.items()}}
        if missing := sorted(set(wanted) - set(layers)):
            raise _unreadable(f"it has no layer {missing[0]!r}")
        pictures = {name: _rec709(layers[name], film) for name in wanted}
        whole, noisy = pictures.pop("Combined"), pictures.pop("Noisy Image")
        parts = {wanted[name]: picture for name, picture in pictures.items()}
        rest = noisy - sum(parts.values(), torch.zeros_like(noisy))
        rest = torch.where(rest > _ROUNDING * noisy, rest, torch.zeros_like(rest))
        return CyclesPicture(whole, parts, rest, denoised)


def _layers(path: Path) -> dict[str, np.ndarray]:
    """Pass name to its colors (H, W, 3); Blender 4 writes them into one part, Blender 5 into one each."""
    import OpenEXR

    try:
        with OpenEXR.File(str(path)) as file:
            channels = [pair for part in file.parts for pair in part.channels.items()]
            passes = {name.partition(".")[2]: np.array(c.pixels, np.float32) for name, c in channels}
    except (OSError, RuntimeError, ValueError, TypeError) as error:
        raise _unreadable(str(error)) from error
    return {name: p[..., :3] for name, p in passes.items() if p.ndim == 3 and p.shape[2] >= 3}


def _unreadable(reason: str) -> VibeError:
    return VibeError(f"Cycles' picture cannot be read: {reason}.", "Try again.")


def _rec709(picture: np.ndarray, film: FilmSettings) -> Tensor:
    """Finite linear Rec.709 (H, W, 3), at least 0, of a picture in the scene's working space."""
    picture = np.nan_to_num(picture, nan=0.0, posinf=_BRIGHTEST, neginf=0.0)
    if film.working_space != _REC709:
        picture = _convert(picture, film)
    return torch.from_numpy(np.ascontiguousarray(picture.clip(0.0, _BRIGHTEST)))


def _convert(picture: np.ndarray, film: FilmSettings) -> np.ndarray:
    import PyOpenColorIO as OCIO

    try:
        config = OCIO.Config.CreateFromFile(film.ocio)
        processor = config.getProcessor(film.working_space, _REC709).getDefaultCPUProcessor()
    except (OCIO.Exception, OCIO.ExceptionMissingFile) as error:
        raise VibeError(
            f"Colors cannot be converted from {film.working_space!r}: {error}.",
            "Choose another working space.",
        ) from error
    flat = np.ascontiguousarray(picture, np.float32).reshape(-1, 3)
    processor.applyRGB(flat)
    return flat.reshape(picture.shape)
