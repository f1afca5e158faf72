# SPDX-License-Identifier: Apache-2.0
"""A color with another's tinge, as people name it: "greenish blue" is a dark cyan, not a paler blue."""

from __future__ import annotations

import math
from itertools import pairwise

from ..schema import Values
from .floats import oklab_from_srgb, srgb_from_hex, srgb_from_oklab

_UNIQUE = ("#c40233", "#ffd300", "#009f6b", "#0087bd")
"""Red, yellow, green and blue that have nothing of each other: the elementary colors of the Natural Color System."""
_GRAYISH = 0.04
"""OKLab chroma below which a color has no hue to give or to keep."""
_WIDEST, _MOST = 124.0, 1.5
"""Degrees, and steps between elementary colors, by which two hues differ at most that mix: green and blue do, by 122 and 1.45."""
_TO_GRAY, _FROM_GRAY = 0.75, 0.2
"""Share of its chroma that a color loses to a gray tinge, and that a gray takes from its tinge."""


def tinged(base: Values, tinge: Values, share: float) -> Values:
    """A color that has something of another.

    Hues turn the shorter way, by equal parts of the way from one elementary color to the next, because names do: half
    way from green to blue is a teal, although OKLab's blues fill half of that way.

    Args:
        base: sRGB in [0, 1].
        share: Of the tinge, in [0, 1].
    """
    (light, chroma, hue), (light2, chroma2, hue2) = _polar(base), _polar(tinge)
    if chroma < _GRAYISH <= chroma2:
        return _srgb(light, chroma + _FROM_GRAY * (chroma2 - chroma), hue2)
    light += share * (light2 - light)
    if chroma2 < _GRAYISH:
        return _srgb(light, chroma + _TO_GRAY * (chroma2 - chroma), hue)
    step, step2 = _step(hue), _step(hue2)
    turned = step + share * ((step2 - step + 2) % 4 - 2)
    return _srgb(light, _sum(chroma, chroma2, hue2 - hue, share), _hue(turned))


def mixable(one: Values, other: Values) -> bool:
    """Whether one color can have something of both sRGB colors: a teal can, nothing is both red and green."""
    (_, chroma, hue), (_, chroma2, hue2) = _polar(one), _polar(other)
    if min(chroma, chroma2) < _GRAYISH:
        return True
    apart, steps = abs((hue - hue2 + 180) % 360 - 180), abs((_step(hue) - _step(hue2) + 2) % 4 - 2)
    return apart < _WIDEST and steps < _MOST


def _sum(chroma: float, chroma2: float, turn: float, share: float) -> float:
    """Chroma of the sum of two colors, which is the less, the farther apart their hues are (degrees)."""
    along = math.cos(math.radians(turn))
    own, added = (1 - share) * chroma, share * chroma2
    return math.sqrt(own**2 + added**2 + 2 * own * added * along)


def _polar(srgb: Values) -> tuple[float, float, float]:
    """OKLab lightness, chroma, and hue in degrees."""
    light, a, b = oklab_from_srgb(srgb)
    return light, math.hypot(a, b), math.degrees(math.atan2(b, a)) % 360


def _srgb(light: float, chroma: float, hue: float) -> Values:
    turn = math.radians(hue)
    return srgb_from_oklab((light, chroma * math.cos(turn), chroma * math.sin(turn)))


_HUES = [_polar(srgb_from_hex(code))[2] for code in _UNIQUE]
_CIRCLE = [*_HUES, _HUES[0] + 360]


def _step(hue: float) -> float:
    """Where a hue (degrees) lies on the circle of elementary colors: 0 red, 1 yellow, 2 green, 3 blue, 4 red again."""
    hue = (hue - _CIRCLE[0]) % 360 + _CIRCLE[0]
    arc = next(i for i in range(4) if hue <= _CIRCLE[i + 1])
    return arc + (hue - _CIRCLE[arc]) / (_CIRCLE[arc + 1] - _CIRCLE[arc])


def _hue(step: float) -> float:
    """The inverse of `_step`, for any number of turns."""
    arc, part = divmod(step % 4, 1)
    low, high = list(pairwise(_CIRCLE))[int(arc)]
    return low + part * (high - low)
