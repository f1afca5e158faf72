# SPDX-License-Identifier: Apache-2.0
"""Measures of finished pictures. Each takes a picture and a region and gives one number.

None of them knows the parameters that made the picture.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import torch
from scipy import ndimage

from ...color.differences import ciede2000
from .finished import FinishedPicture, FloatArray, luminance

_FLOOR = 0.004
"""Linear luminance below which differences are not seen on a display in a lit room."""

_HIGHLIGHTS = (0.03, 0.06)
"""How far the sides of a highlight are, in roots of a region's area."""

_BEND = 0.5
"""Cosine between normals beyond which two places do not lie on one surface, but on both sides of an edge."""

_SPOT = 0.002
"""The share of a region that the sharpest highlight fills at least."""

_RINGS = (0.35, 0.62, 0.82)
"""Of a vignette, in half diagonals: the middle lies between the first two, the corners beyond the third."""

_GRAIN = 192
"""Gradients are given per pixel of a picture of this size."""


def color_error(shot: FinishedPicture, region: str, lab: tuple[float, float, float]) -> float:
    """How far most of a region is from a named color: CIEDE2000, lightness counting half as in textiles (2:1:1).

    It is the median over pixels: highlights, shadows and a pattern's lesser part do not decide.

    Args:
        shot: The picture.
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


def gloss(shot: FinishedPicture, region: str) -> float:
    """Contrast of highlights: how far the brightest small spots and streaks rise above both of their sides, in L*.

    What people call glossy has highlights of high contrast and sharpness (Marlow, Kim and Anderson 2012); both
    raise it, for the sides are near. Light that only grows towards an outline has one side, and is none.

    Args:
        shot: The picture.
        region: See `FinishedPicture.region`.

    Returns:
        L*; 0 for a region of fewer than 16 pixels.
    """
    where = shot.region(region)
    if where.sum() < 16:
        return 0.0
    light = ndimage.gaussian_filter(shot.lab[..., 0], 0.5)
    rise = np.zeros(where.shape)
    for share in _HIGHLIGHTS:
        away = max(1, round(share * math.sqrt(where.sum())))
        for row, column in ((0, away), (away, 0), (away, away), (away, -away)):
            sides = [_beside(shot, light, where, step) for step in ((row, column), (-row, -column))]
            rise = np.maximum(rise, light - np.maximum(*sides))
    spots = np.sort(rise[where])
    return float(spots[-max(4, round(_SPOT * len(spots))) :].mean())


def _beside(shot: FinishedPicture, light: FloatArray, where: np.ndarray, step: tuple[int, int]) -> FloatArray:
    """The light a step away; infinite where that is out of the region, of another material, or around a corner."""

    def moved(field: np.ndarray, outside: float) -> np.ndarray:
        reach = max(map(abs, step))
        margin = [(reach, reach)] * 2 + [(0, 0)] * (field.ndim - 2)
        rows, columns = (slice(reach + by, reach + by + n) for by, n in zip(step, light.shape, strict=True))
        return np.pad(field, margin, constant_values=outside)[rows, columns]

    same = moved(shot.material, -2) == shot.material
    bent = (moved(shot.normal, 0.0) * shot.normal).sum(-1) < _BEND
    return np.where(moved(where, False) & same & ~bent, moved(light, np.inf), np.inf)


def fog(shot: FinishedPicture, region: str) -> float:
    """The share of local contrast that fog takes away.

    Contrast is that of the logarithm of luminance between neighbors, against the same picture without its fog. A
    flat grade, haze painted onto a wall or darkness are no fog.

    Args:
        shot: The picture.
        region: See `FinishedPicture.region`.

    Returns:
        0 for no fog, 1 when nothing is left.
    """
    if shot.clear is None:
        return 0.0
    detail, clear = (_detail(luminance(p), shot.region(region)) for p in (shot.display, shot.clear))
    return 1.0 - detail / clear if clear > 1e-4 else 0.0


def _detail(light: FloatArray, where: np.ndarray) -> float:
    return float(_slope(light)[where].mean())


def _slope(light: FloatArray) -> FloatArray:
    """Gradient of log2 luminance, stops per pixel."""
    rows, columns = np.gradient(np.log2(np.maximum(light, 0) + _FLOOR))
    return np.hypot(rows, columns)


def vignette(shot: FinishedPicture, region: str) -> float:
    """How much darker the corners are than the middle ring, in the second least darkened corner.

    All four count, because light from one side darkens two of them. The subject is left out.

    Args:
        shot: The picture.
        region: Not read: it is a measure of the whole picture.

    Returns:
        L*; 0 if no corner can be measured.
    """
    height, width = shot.mask.shape
    y, x = np.mgrid[:height, :width]
    y, x = (y + 0.5) / height * 2 - 1, (x + 0.5) / width * 2 - 1
    radius = np.hypot(x * width, y * height) / math.hypot(width, height)
    light, free = shot.lab[..., 0], shot.region("surroundings")
    falloffs = []
    for up in (y < 0, y >= 0):
        for left in (x < 0, x >= 0):
            here = up & left & free
            middle = here & (radius > _RINGS[0]) & (radius < _RINGS[1])
            corner = here & (radius > _RINGS[2])
            if middle.sum() > 8 and corner.sum() > 8:
                falloffs.append(float(light[middle].mean() - light[corner].mean()))
    return sorted(falloffs)[min(1, len(falloffs) - 1)] if falloffs else 0.0


def _shading(shot: FinishedPicture, region: str) -> np.ndarray:
    """Unit vector towards which a region is lit, in the camera's space; zero if that cannot be told.

    A least-squares fit of a + b . n to luminance over the normals; the brightest percent, highlights, is left out.
    """
    where = shot.region(region) & (np.linalg.norm(shot.normal, axis=-1) > 0.5)
    light, normals = shot.luminance[where], shot.normal[where]
    keep = light <= np.quantile(light, 0.99) if len(light) else np.zeros(0, bool)
    if keep.sum() < 32 or normals[keep].std(0).max() < 0.1:
        return np.zeros(3)
    light, normals = light[keep] / max(light.mean(), 1e-6), normals[keep]
    matrix = np.concatenate([normals, np.ones((len(light), 1))], 1)
    scale = 1e-2 * len(light) * np.diag([1.0, 1.0, 1.0, 0.0])
    slope = np.linalg.solve(matrix.T @ matrix + scale, matrix.T @ light)[:3]
    length = np.linalg.norm(slope)
    return slope / length * min(length / 0.3, 1.0)


def light_right(shot: FinishedPicture, region: str) -> float:
    """How far the light comes from the right.

    Args:
        shot: The picture.
        region: See `FinishedPicture.region`.

    Returns:
        -1 (from the left) to 1 (from the right), in the camera's space.
    """
    return float(_shading(shot, region)[0])


def light_up(shot: FinishedPicture, region: str) -> float:
    """How far the light comes from above.

    Args:
        shot: The picture.
        region: See `FinishedPicture.region`.

    Returns:
        -1 (from below) to 1 (from above), in the camera's space.
    """
    return float(_shading(shot, region)[1])


def hardness(shot: FinishedPicture, region: str) -> float:
    """The steepest slope of light where surfaces are smooth and of one material: edges of shadows.

    Highlights, too, have steep slopes under small lamps.

    Args:
        shot: The picture.
        region: See `FinishedPicture.region`.

    Returns:
        Stops per pixel of a picture of 192; 0 if fewer than 32 pixels can be measured.
    """
    turn = np.linalg.norm(np.stack([*np.gradient(shot.normal, axis=(0, 1))]), axis=(0, -1))
    same = ndimage.maximum_filter(shot.material, 5) == ndimage.minimum_filter(shot.material, 5)
    outline = ndimage.maximum_filter(shot.mask, 5) - ndimage.minimum_filter(shot.mask, 5) > 0.1
    where = (
        shot.region(region)
        & same
        & ~outline
        & (ndimage.maximum_filter(turn, 3) < 0.15)
        & (shot.material >= 0)
    )
    if where.sum() < 32:
        return 0.0
    return float(np.quantile(_slope(shot.luminance)[where], 0.99)) * max(shot.mask.shape) / _GRAIN


def warmth(shot: FinishedPicture, region: str) -> float:
    """How far a region's mean color lies towards orange.

    Args:
        shot: The picture.
        region: See `FinishedPicture.region`.

    Returns:
        b* and half of a*, in Lab.
    """
    _, a, b = shot.lab[shot.region(region)].mean(0)
    return float(b + 0.5 * a)


def lightness(shot: FinishedPicture, region: str) -> float:
    """Mean lightness.

    Args:
        shot: The picture.
        region: See `FinishedPicture.region`.

    Returns:
        L*.
    """
    return float(shot.lab[shot.region(region)][:, 0].mean())


def spread(shot: FinishedPicture, region: str) -> float:
    """From the darkest to the lightest twentieth.

    Args:
        shot: The picture.
        region: See `FinishedPicture.region`.

    Returns:
        L*.
    """
    low, high = np.quantile(shot.lab[shot.region(region)][:, 0], [0.05, 0.95])
    return float(high - low)


def chroma(shot: FinishedPicture, region: str) -> float:
    """Mean distance from gray.

    Args:
        shot: The picture.
        region: See `FinishedPicture.region`.

    Returns:
        Lab.
    """
    _, a, b = shot.lab[shot.region(region)].T
    return float(np.hypot(a, b).mean())


def hue_spread(shot: FinishedPicture, region: str) -> float:
    """How far colors lie from the one line of brown tints that a sepia print has.

    Args:
        shot: The picture.
        region: See `FinishedPicture.region`.

    Returns:
        Lab; gray is 5 away.
    """
    _, a, b = shot.lab[shot.region(region)].T
    along = np.array([0.34, 0.94])  # hue of sepia, 70 degrees
    brown = a * along[0] + b * along[1]
    across = np.abs(b * along[0] - a * along[1])
    return float(np.hypot(across, np.maximum(5.0 - brown, 0.0)).mean())


def silhouette(shot: FinishedPicture, region: str) -> float:
    """How much darker the subject is than the surroundings, less half of its own spread of light.

    Args:
        shot: The picture.
        region: Not read: it is a measure of the whole picture.

    Returns:
        L*.
    """
    light = shot.lab[..., 0]
    own = light[shot.region("subject")]
    low, high = np.quantile(own, [0.1, 0.9])
    return float(np.median(light[shot.region("surroundings")]) - np.median(own) - 0.5 * (high - low))


def glow(shot: FinishedPicture, region: str) -> float:
    """How much lighter a region is than the surroundings, by their medians.

    Args:
        shot: The picture.
        region: See `FinishedPicture.region`.

    Returns:
        L*.
    """
    light = shot.lab[..., 0]
    return float(np.median(light[shot.region(region)]) - np.median(light[shot.region("surroundings")]))


@dataclass(frozen=True)
class Measure:
    """How to get a number off a picture.

    Attributes:
        take: The function.
        unit: For the report.
        notice: The least difference between two pictures that people notice side by side.
        says: What it is, for the report.
    """

    take: Callable[[FinishedPicture, str], float]
    unit: str
    notice: float
    says: str


MEASURES: dict[str, Measure] = {
    "gloss": Measure(gloss, "L*", 1.5, "contrast of highlights"),
    "fog": Measure(fog, "", 0.04, "share of local contrast that fog takes away"),
    "vignette": Measure(vignette, "L*", 1.5, "how much darker the corners are"),
    "light_right": Measure(light_right, "", 0.1, "where the shading says that light comes from: right"),
    "light_up": Measure(light_up, "", 0.1, "where the shading says that light comes from: above"),
    "hardness": Measure(hardness, "stops/px", 0.05, "steepness of shadow edges"),
    "warmth": Measure(warmth, "b*", 1.5, "towards orange, or blue"),
    "lightness": Measure(lightness, "L*", 2.0, "mean lightness"),
    "spread": Measure(spread, "L*", 3.0, "from darkest to lightest"),
    "chroma": Measure(chroma, "C*", 2.0, "mean chroma"),
    "hue_spread": Measure(hue_spread, "ab", 1.5, "distance from tints of brown"),
    "silhouette": Measure(silhouette, "L*", 3.0, "a dark, even subject before a lighter ground"),
    "glow": Measure(glow, "L*", 3.0, "lighter than what lies around"),
}
"""By name; `traits.toml` refers to them."""
