# SPDX-License-Identifier: Apache-2.0
"""Colors as people name them: sRGB, linear Rec.709, CIE Lab, and the basic color that a shade belongs to."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..schema import Values

Lab = tuple[float, float, float]
"""CIE L*a*b* under D65: L in [0, 100]."""

_WHITE = (0.95047, 1.0, 1.08883)  # D65
_TO_XYZ = (
    (0.4124564, 0.3575761, 0.1804375),
    (0.2126729, 0.7151522, 0.0721750),
    (0.0193339, 0.1191920, 0.9503041),
)
_TO_RGB = (
    (3.2404542, -1.5371385, -0.4985314),
    (-0.9692660, 1.8760108, 0.0415560),
    (0.0556434, -0.2040259, 1.0572252),
)
TO_CONES = (
    (0.4122215, 0.5363325, 0.0514460),
    (0.2119035, 0.6806995, 0.1073970),
    (0.0883025, 0.2817188, 0.6299787),
)
_FROM_CONES = (
    (4.0767417, -3.3077116, 0.2309699),
    (-1.2684380, 2.6097574, -0.3413194),
    (-0.0041961, -0.7034186, 1.7076147),
)
_GRAYISH = 20.0  # chroma below which a hue says little
TO_OKLAB = (
    (0.2104543, 0.7936178, -0.0040720),
    (1.9779985, -2.4285922, 0.4505937),
    (0.0259040, 0.7827718, -0.8086758),
)
_FROM_OKLAB = ((1.0, 0.3963378, 0.2158038), (1.0, -0.1055613, -0.0638542), (1.0, -0.0894842, -1.2914855))

# Several typical shades for each basic color: the nearest one decides.
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


def from_hex(text: str) -> Values:
    """sRGB in [0, 1] of "#rrggbb"."""
    return tuple(int(text[i : i + 2], 16) / 255 for i in (1, 3, 5))


def to_linear(srgb: Sequence[float]) -> Values:
    """Linear Rec.709 of sRGB-encoded components in [0, 1] (IEC 61966-2-1)."""
    return tuple(v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in srgb)


def to_srgb(linear: Sequence[float]) -> Values:
    """Inverse of `to_linear`; the result is clamped to [0, 1]."""
    clamped = (min(max(v, 0.0), 1.0) for v in linear)
    return tuple(12.92 * v if v <= 0.0031308 else 1.055 * v ** (1 / 2.4) - 0.055 for v in clamped)


def luminance(linear: Sequence[float]) -> float:
    """Rec.709 luminance of a linear color."""
    return sum(w * v for w, v in zip((0.2126, 0.7152, 0.0722), linear, strict=True))


def to_lab(srgb: Sequence[float]) -> Lab:
    """CIE L*a*b* (D65) of sRGB in [0, 1]."""
    linear = to_linear(srgb)
    xyz = (
        sum(m * v for m, v in zip(row, linear, strict=True)) / w
        for row, w in zip(_TO_XYZ, _WHITE, strict=True)
    )
    x, y, z = (t ** (1 / 3) if t > 216 / 24389 else t * 841 / 108 + 4 / 29 for t in xyz)
    return 116 * y - 16, 500 * (x - y), 200 * (y - z)


def from_lab(lab: Lab) -> Values:
    """sRGB of CIE L*a*b*, clamped to the gamut."""
    y = (lab[0] + 16) / 116
    curve = (y + lab[1] / 500, y, y - lab[2] / 200)
    xyz = [w * (t**3 if t > 6 / 29 else (t - 4 / 29) * 108 / 841) for t, w in zip(curve, _WHITE, strict=True)]
    return to_srgb([sum(m * v for m, v in zip(row, xyz, strict=True)) for row in _TO_RGB])


def to_oklab(srgb: Sequence[float]) -> Lab:
    """OKLab (Ottosson 2020): its hues stay put when a blue is lightened, where CIE Lab turns it purple."""
    cone = (sum(m * v for m, v in zip(row, to_linear(srgb), strict=True)) ** (1 / 3) for row in TO_CONES)
    return _apply(TO_OKLAB, tuple(cone))


def _from_oklab(lab: Lab) -> Values:
    cones = tuple(v**3 for v in _apply(_FROM_OKLAB, lab))
    return to_srgb(_apply(_FROM_CONES, cones))


def _apply(matrix: Sequence[Lab], vector: Sequence[float]) -> Lab:
    x, y, z = (sum(m * v for m, v in zip(row, vector, strict=True)) for row in matrix)
    return x, y, z


def shade(
    srgb: Values, lightness: float = 1.0, chroma: float = 1.0, towards: float = 60.0, warmth: float = 0.0
) -> Values:
    """A shade of a color.

    Args:
        srgb: In [0, 1].
        lightness: 1 keeps the lightness, 0 moves it to `towards`.
        chroma: Multiplies the distance from gray.
        towards: L* in [0, 100].
        warmth: Moves the hue of grayish colors to orange (+) or blue (-); in units of b*.
    """
    light, a, b = to_oklab(srgb)
    warmth *= max(0.0, 1 - math.hypot(a, b) / 0.15)
    goal = (towards + 16) / 116  # of a gray of that L*
    return _from_oklab(
        (goal + (light - goal) * lightness, a * chroma + warmth / 1200, b * chroma + warmth / 330)
    )


def mix(first: Values, second: Values, share: float) -> Values:
    """A color between two, in sRGB, with that share of the second."""
    pairs = zip(to_oklab(first), to_oklab(second), strict=True)
    light, a, b = ((1 - share) * p + share * q for p, q in pairs)
    return _from_oklab((light, a, b))


def chroma(lab: Lab) -> float:
    """Distance from gray."""
    return math.hypot(lab[1], lab[2])


def hue_apart(one: Values, other: Values) -> float:
    """Degrees between the Lab hues of two sRGB colors; 0 where one of them is grayish."""
    labs = to_lab(one), to_lab(other)
    if min(map(chroma, labs)) < _GRAYISH:
        return 0.0
    hues = [math.degrees(math.atan2(b, a)) for _, a, b in labs]
    return abs((hues[0] - hues[1] + 180) % 360 - 180)


def basic(srgb: Sequence[float]) -> str:
    """The basic color (see `attributes.COLORS`) that a person would call this one."""
    lab = to_lab(srgb)
    if chroma(lab) < 8:
        return "black" if lab[0] < 18 else "white" if lab[0] > 85 else "grey"
    # Hue decides more than lightness does.
    distances = {
        name: min(
            0.5 * abs(lab[0] - s[0]) + math.dist(lab[1:], s[1:]) for s in map(to_lab, map(from_hex, shades))
        )
        for name, shades in _SHADES.items()
    }
    return min(distances, key=distances.__getitem__)
