# SPDX-License-Identifier: Apache-2.0
"""Measures of finished pictures: those of the claims, and two that only a benchmark can take.

None of them knows the parameters that made the picture.
"""

from __future__ import annotations

import numpy as np
import torch

from lab.bench.paper.finished import FinishedPicture, FloatArray, luminance
from proxy_renderer.claims import measures
from proxy_renderer.color.tensors import ciede2000

_FLOOR = 0.004
"""Linear luminance below which differences are not seen on a display in a lit room."""

FOG = "fog"
"""The measure that needs the same picture without its fog."""

UNITS = {**{name: m.unit for name, m in measures.MEASURES.items()}, FOG: ""}
NOTICES = {**{name: m.notice for name, m in measures.MEASURES.items()}, FOG: 0.04}
SAYS = {**{name: m.says for name, m in measures.MEASURES.items()}, FOG: "share of local contrast that fog takes away"}
"""By name, as `traits.toml` has them: unit, the least difference that people notice, and what it is."""


def taken(name: str, shot: FinishedPicture, region: str) -> float:
    """A measure of one number of a region.

    Args:
        name: A key of `SAYS`.
        region: See `FinishedPicture.region`.
    """
    if name == FOG:
        return fog(shot, region)
    where = torch.from_numpy(shot.region(region))
    return float(measures.MEASURES[name].take(shot.measured, where)[0])


def color_error(shot: FinishedPicture, region: str, lab: tuple[float, float, float]) -> float:
    """Distance of most of a region from a named color: CIEDE2000, lightness counting half as in textiles (2:1:1).

    It is the median over pixels: highlights, shadows and a pattern's lesser part do not decide.

    Args:
        region: See `FinishedPicture.region`.
        lab: The color that was asked for.
    """
    pixels = torch.from_numpy(shot.lab[shot.region(region)])
    if not len(pixels):
        return 100.0
    named = torch.tensor(lab, dtype=pixels.dtype).expand_as(pixels)
    square = ciede2000(pixels, named).square()
    middle = ((pixels[:, 0] + named[:, 0]) / 2 - 50).square()
    weight = 1 + 0.015 * middle / (20 + middle).sqrt()  # S_L
    lightness = ((pixels[:, 0] - named[:, 0]) / weight).square()
    return float((square - 0.75 * lightness).clamp_min(0).sqrt().median())


def fog(shot: FinishedPicture, region: str) -> float:
    """The share of local contrast that fog takes away.

    Contrast is that of the logarithm of luminance between neighbors, against the same picture without its fog. A
    flat grade, haze painted onto a wall or darkness are no fog.

    Args:
        region: See `FinishedPicture.region`.

    Returns:
        0 for no fog, 1 when nothing is left.
    """
    if shot.clear is None:
        return 0.0
    detail, clear = (_detail(luminance(p), shot.region(region)) for p in (shot.display, shot.clear))
    return 1.0 - detail / clear if clear > 1e-4 else 0.0


def _detail(light: FloatArray, where: np.ndarray) -> float:
    """Mean gradient of log2 luminance in a region, stops per pixel."""
    rows, columns = np.gradient(np.log2(np.maximum(light, 0) + _FLOOR))
    return float(np.hypot(rows, columns)[where].mean())
