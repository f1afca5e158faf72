# SPDX-License-Identifier: Apache-2.0
"""Operations on colors as people name them: shades, tinges, mixtures, and the basic color that a color belongs to."""

import math
from collections.abc import Sequence
from itertools import pairwise

from ..schema import Values
from .floats import chroma, lab_from_srgb, oklab_from_srgb, srgb_from_hex, srgb_from_oklab

WARM = (0.5, 1.0)  # weights of a* and b* in warmth, see `claims.measures.color.warmth`
_GRAYISH_LAB = 20.0  # CIE Lab chroma below which a hue is unreliable

# Typical shades of each basic color; `basic` returns the color of the nearest shade.
_SHADES = {
    "black": ("#000000", "#1a1a1a", "#0c1014"),
    "grey": ("#808080", "#555555", "#aaaaaa", "#708090"),
    "white": ("#ffffff", "#f2efe6"),
    "brown": ("#6f4420", "#8b4513", "#a0703c", "#4a2508"),
    "red": ("#e00000", "#a00010", "#ff3b2f", "#650012"),
    "orange": ("#ff7c0a", "#ffa040", "#d2601a"),
    "yellow": ("#ffdd00", "#ffff60", "#d4b300", "#fff2a0"),
    "green": ("#15a020", "#0a4a0c", "#7fd858", "#6e750e", "#80f9ad", "#b0ff20"),
    "teal": ("#008080", "#30b8b0", "#00d8e8", "#06c2ac", "#055458"),
    "blue": ("#0a3ee0", "#01153e", "#3f80d0", "#90c0f8", "#1030a0"),
    "purple": ("#7e1e9c", "#9a0eea", "#c8a0f0", "#40085a", "#580f41"),
    "pink": ("#ff7eb6", "#e6007e", "#ffc0d0", "#fc8eac"),
}
_UNIQUE = ("#c40233", "#ffd300", "#009f6b", "#0087bd")  # red, yellow, green, blue of the Natural Color System
_GRAYISH_OKLAB = 0.04  # OKLab chroma below which a color counts as gray, without a hue
_WIDEST, _MOST = 124.0, 1.5
"""Differences below which two hues mix: in degrees, and in steps of `_step`. Green and blue differ by 122 and 1.45."""
_TO_GRAY, _FROM_GRAY = 0.75, 0.2  # share of the way to the tinge's chroma: to a gray tinge; from a gray base


def shade(
    srgb: Values, lightness: float = 1.0, chroma: float = 1.0, towards: float = 60.0, warmth: float = 0.0
) -> Values:
    """A shade of an sRGB color, clamped to the gamut.

    A `lightness` of 1 keeps the color's lightness, 0 replaces it by `towards`, a CIE L* in [0, 100]; between, it is
    interpolated. `chroma` is a factor of the OKLab chroma. `warmth`, in units of CIE b*, moves grayish colors to orange
    (above 0) or blue (below 0).
    """
    light, a, b = oklab_from_srgb(srgb)
    warmth *= max(0.0, 1 - math.hypot(a, b) / 0.15)
    goal = (towards + 16) / 116  # OKLab lightness of a gray of that L*
    light = goal + (light - goal) * lightness
    return srgb_from_oklab((light, a * chroma + warmth / 1200, b * chroma + warmth / 330))


def hue_apart(one: Values, other: Values) -> float:
    """Difference in degrees, [0, 180], of the CIE Lab hues of two sRGB colors; 0 if one of the colors is grayish."""
    labs = lab_from_srgb(one), lab_from_srgb(other)
    if min(map(chroma, labs)) < _GRAYISH_LAB:
        return 0.0
    hues = [math.degrees(math.atan2(b, a)) for _, a, b in labs]
    return abs((hues[0] - hues[1] + 180) % 360 - 180)


def warm(a: float, b: float) -> float:
    """Warmth in [-1, 1] of a tint (a*, b*): its cosine with the direction from blue (-1) to orange (1); 0 for gray."""
    return (WARM[0] * a + WARM[1] * b) / (math.hypot(*WARM) * max(math.hypot(a, b), 1e-6))


def relative_shade(srgb: Values, lighter: float, chroma: float, strength: float = 1.0) -> Values:
    """A lighter or darker shade of an sRGB color, with its chroma multiplied by a factor.

    `lighter` in [-1, 1] is the share of the way to white or, below 0, to black. `chroma` is the factor. `strength`,
    above 1 for "very" and below 1 for "slightly", changes both to `lighter` * `strength` and `chroma` ** `strength`.
    """
    way = min(abs(lighter * strength), 1.0)
    return shade(srgb, 1.0 - way, chroma**strength, 100.0 * (lighter > 0))


def basic(srgb: Sequence[float]) -> str:
    """Name that a person would give to an sRGB color, of the basic colors `words.lexicon.quantities.COLORS`."""
    lab = lab_from_srgb(srgb)
    if chroma(lab) < 8:
        return "black" if lab[0] < 18 else "white" if lab[0] > 85 else "grey"
    # Hue decides more than lightness does.
    distances = {
        name: min(
            0.5 * abs(lab[0] - s[0]) + math.dist(lab[1:], s[1:]) for s in map(lab_from_srgb, map(srgb_from_hex, shades))
        )
        for name, shades in _SHADES.items()
    }
    return min(distances, key=distances.__getitem__)


def tinged(base: Values, tinge: Values, share: float) -> Values:
    """The sRGB color `base`, moved by a share in [0, 1] toward the sRGB color `tinge`.

    The hue turns the shorter way around the circle of `_step`: red, yellow, green, blue are equally spaced there, as in
    color names. Half way from green to blue is a teal, although blues fill half of that arc in OKLab. A gray `base`
    takes the hue of `tinge` and keeps its own lightness; a gray `tinge` changes lightness and chroma only.
    """
    (light, chroma, hue), (light2, chroma2, hue2) = _polar(base), _polar(tinge)
    if chroma < _GRAYISH_OKLAB <= chroma2:
        return _srgb(light, chroma + _FROM_GRAY * (chroma2 - chroma), hue2)
    light += share * (light2 - light)
    if chroma2 < _GRAYISH_OKLAB:
        return _srgb(light, chroma + _TO_GRAY * (chroma2 - chroma), hue)
    step, step2 = _step(hue), _step(hue2)
    turned = step + share * ((step2 - step + 2) % 4 - 2)
    # as of a sum of vectors: the farther apart the hues are, the smaller the chroma
    along = math.cos(math.radians(hue2 - hue))
    own, added = (1 - share) * chroma, share * chroma2
    return _srgb(light, math.sqrt(own**2 + added**2 + 2 * own * added * along), _hue(turned))


def mixable(one: Values, other: Values) -> bool:
    """True if a mixture of two sRGB colors resembles both, as teal does green and blue; also if one color is gray."""
    (_, chroma, hue), (_, chroma2, hue2) = _polar(one), _polar(other)
    if min(chroma, chroma2) < _GRAYISH_OKLAB:
        return True
    apart, steps = abs((hue - hue2 + 180) % 360 - 180), abs((_step(hue) - _step(hue2) + 2) % 4 - 2)
    return apart < _WIDEST and steps < _MOST


def _polar(srgb: Values) -> tuple[float, float, float]:
    light, a, b = oklab_from_srgb(srgb)
    return light, math.hypot(a, b), math.degrees(math.atan2(b, a)) % 360


def _srgb(light: float, chroma: float, hue: float) -> Values:
    turn = math.radians(hue)
    return srgb_from_oklab((light, chroma * math.cos(turn), chroma * math.sin(turn)))


_HUES = [_polar(srgb_from_hex(code))[2] for code in _UNIQUE]
_CIRCLE = [*_HUES, _HUES[0] + 360]


def _step(hue: float) -> float:
    """Position of a hue (degrees) on the circle of elementary colors: 0 red, 1 yellow, 2 green, 3 blue, 4 red again."""
    hue = (hue - _CIRCLE[0]) % 360 + _CIRCLE[0]
    arc = next(i for i in range(4) if hue <= _CIRCLE[i + 1])
    return arc + (hue - _CIRCLE[arc]) / (_CIRCLE[arc + 1] - _CIRCLE[arc])


def _hue(step: float) -> float:
    """Hue in degrees at a position on the circle of `_step`, which repeats every 4; the inverse of `_step`."""
    arc, part = divmod(step % 4, 1)
    low, high = list(pairwise(_CIRCLE))[int(arc)]
    return low + part * (high - low)
