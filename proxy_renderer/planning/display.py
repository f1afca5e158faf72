# SPDX-License-Identifier: Apache-2.0
"""What a scene-linear value looks like after the view transform, and what it takes to look like something."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from itertools import product
from math import exp, log, sqrt
from pathlib import Path

from ..color.floats import chroma, lab_from_srgb, linear_from_srgb, luminance, srgb_from_linear
from ..schema import Values

# L* on an sRGB display of scene-linear grays, measured on Blender's own OCIO config; the rest as AgX.
_GRAYS = (0.005, 0.01, 0.02, 0.05, 0.1, 0.18, 0.3, 0.5, 0.8, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 10.0)
_LIGHTNESS = {
    "AgX": (2.4, 5.7, 12.2, 24.4, 36.9, 49.5, 60.3, 69.5, 76.5, 79.4, 83.9, 86.8, 90.2, 92.3, 95.0, 97.8),
    "Filmic": (4.6, 9.2, 16.4, 29.6, 42.0, 53.4, 63.2, 72.3, 79.6, 82.7, 87.6, 90.4, 93.7, 95.5, 97.5, 99.1),
    "Standard": (
        4.5,
        9.0,
        15.5,
        26.7,
        37.8,
        49.5,
        61.7,
        76.1,
        91.7,
        99.0,
        99.2,
        99.4,
        99.6,
        99.7,
        99.8,
        99.9,
    ),
    "Khronos PBR Neutral": (
        0.1,
        0.6,
        2.3,
        13.2,
        29.5,
        44.4,
        58.2,
        73.8,
        89.5,
        94.4,
        97.5,
        98.4,
        99.1,
        99.3,
        99.6,
        99.8,
    ),
}

_BLEACHED = 1.6  # exponent that gives pale colors about the saturation that highlights lose
_PALE = (20.0, 60.0)  # chroma below which a light color is pale, and above which it is not
_DIMMED, _DIMMEST = 0.92, 0.05  # steps in which a color's light is lowered, and their end
_LIGHT = (70.0, 84.0)  # L* above which a color can be pale, and above which it is


def radiance(lightness: float, view: str) -> float:
    """The scene-linear gray that is displayed with L* = `lightness` (clamped to [0.5, 98])."""
    curve = _LIGHTNESS.get(view, _LIGHTNESS["AgX"])
    lightness = min(max(lightness, 0.5), 98.0)
    if lightness <= curve[0]:
        return _GRAYS[0] * lightness / curve[0]
    if lightness >= curve[-1]:
        return _GRAYS[-1]
    i = bisect_left(curve, lightness)
    t = (lightness - curve[i - 1]) / (curve[i] - curve[i - 1])
    return exp(log(_GRAYS[i - 1]) + t * (log(_GRAYS[i]) - log(_GRAYS[i - 1])))


def lightness(gray: float, view: str) -> float:
    """Inverse of `radiance`: L* of a scene-linear gray."""
    low, high = 0.5, 98.0
    for _ in range(20):
        middle = (low + high) / 2
        low, high = (middle, high) if radiance(middle, view) < gray else (low, middle)
    return low


VIEW_COLORS = Path(__file__).with_name("view_colors.txt")


@cache
def _tables() -> dict[str, list[Values]]:
    tables: dict[str, list[Values]] = {}
    rows: list[Values] = []
    for line in VIEW_COLORS.read_text("utf-8").splitlines():
        if line.startswith("["):
            rows = tables.setdefault(line.strip("[]"), [])
        elif not line.startswith("#"):
            r, g, b = map(float, line.split())
            rows.append((r, g, b))
    return tables


def scene_color(srgb: Sequence[float], view: str) -> Values:
    """The scene-linear color that a view shows as `srgb`, or as near as it can; above 1 for light colors.

    Views that bleach highlights show no pale color exactly: only something garish would come near, which colors all
    around it. Pale colors keep their own hue and saturation instead, at the radiance that has their lightness.
    """
    return _blended(srgb, view, _paleness(srgb, view))


def reachable(srgb: Values, view: str, limit: float) -> Values:
    """`scene_color`, of the same color in less light where a component would exceed `limit`."""
    pale = _paleness(srgb, view)
    found = (_blended(dimmed, view, pale) for dimmed in dimming(srgb, _DIMMEST))
    return first_within(found, limit)


def dimming(srgb: Values, least: float) -> Iterator[Values]:
    """The same color in less and less light, down to a share of it."""
    light = 1.0
    yield srgb
    while light > least:
        light *= _DIMMED
        yield srgb_from_linear(tuple(light * v for v in linear_from_srgb(srgb)))


def first_within(colors: Iterable[Values], limit: float) -> Values:
    """The first color of which no component exceeds a limit, or else the last."""
    color: Values = ()
    for color in colors:
        if max(color) <= limit:
            break
    return color


def _paleness(srgb: Sequence[float], view: str) -> float:
    """0 for a dark or a saturated color, 1 for a pale one, where the view bleaches such."""
    if view not in _tables():
        return 0.0
    lab = lab_from_srgb(srgb)
    faint = (_PALE[1] - chroma(lab)) / (_PALE[1] - _PALE[0])
    light = (lab[0] - _LIGHT[0]) / (_LIGHT[1] - _LIGHT[0])
    return max(min(faint, light, 1.0), 0.0)


def _blended(srgb: Sequence[float], view: str, pale: float) -> Values:
    """What is shown as a color, or, as far as it is pale, what is of its saturation and shown as lightly."""
    exact = _inverse(srgb, view)
    if not pale:
        return exact
    linear = tuple(v**_BLEACHED for v in linear_from_srgb(srgb))
    level = radiance(lab_from_srgb(srgb)[0], view) / max(luminance(linear), 1e-6)
    return tuple(
        exp(pale * log(max(level * v, 1e-5)) + (1 - pale) * log(max(e, 1e-5)))
        for v, e in zip(linear, exact, strict=True)
    )


def _inverse(srgb: Sequence[float], view: str) -> Values:
    """The nearest color by the view's table; between its rows square roots are closer to straight lines than logarithms."""
    lab = lab_from_srgb(srgb)
    if chroma(lab) < 4:
        return (radiance(lab[0], view),) * 3
    table = _tables().get(view)
    if table is None:
        return linear_from_srgb(srgb)
    steps = round(len(table) ** (1 / 3))
    places = [min(max(v, 0.0), 1.0) * (steps - 1) for v in srgb]
    corners = [min(int(p), steps - 2) for p in places]
    sums = [0.0, 0.0, 0.0]
    for offsets in product((0, 1), repeat=3):
        weight, index = 1.0, 0
        for place, corner, offset in zip(places, corners, offsets, strict=True):
            weight *= (place - corner) if offset else 1 - (place - corner)
            index = index * steps + corner + offset
        sums = [s + weight * sqrt(v) for s, v in zip(sums, table[index], strict=True)]
    return tuple(s**2 for s in sums)
