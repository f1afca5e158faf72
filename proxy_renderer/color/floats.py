# SPDX-License-Identifier: Apache-2.0
"""Conversions of single colors as plain floats, without torch and numpy: sRGB, linear Rec.709, CIE Lab, OKLab."""

import math
import re
from collections.abc import Sequence

from ..schema import Values
from . import constants as c
from .constants import Lab


def is_hex(text: str) -> bool:
    """True if a text is a color as "#rrggbb"."""
    return bool(re.fullmatch("#[0-9a-fA-F]{6}", text))


def srgb_from_hex(text: str) -> Values:
    """sRGB in [0, 1] of "#rrggbb"."""
    return tuple(int(text[i : i + 2], 16) / 255 for i in (1, 3, 5))


def hex_from_srgb(srgb: Sequence[float]) -> str:
    """ "#rrggbb" of sRGB in [0, 1]."""
    return "#" + "".join(f"{round(255 * v):02x}" for v in srgb)


def decode(encoded: float) -> float:
    """Linear light of one sRGB-encoded component (IEC 61966-2-1)."""
    if encoded <= c.SRGB_ENCODED_END:
        return encoded / c.SRGB_SLOPE
    return ((encoded + c.SRGB_OFFSET) / c.SRGB_SCALE) ** c.SRGB_EXPONENT


def encode(linear: float) -> float:
    """sRGB-encoded value of one linear component, also above 1; the inverse of `decode`."""
    if linear <= c.SRGB_LINEAR_END:
        return c.SRGB_SLOPE * linear
    return c.SRGB_SCALE * linear ** (1 / c.SRGB_EXPONENT) - c.SRGB_OFFSET


def linear_from_srgb(srgb: Sequence[float]) -> Values:
    """Linear Rec.709 of sRGB in [0, 1]."""
    return tuple(map(decode, srgb))


def mixed(one: Sequence[float], other: Sequence[float], share: float) -> Values:
    """sRGB mixture of two sRGB colors, mixed in linear light; `share` in [0, 1] is that of `other`."""
    pairs = zip(linear_from_srgb(one), linear_from_srgb(other), strict=True)
    return srgb_from_linear([a + share * (b - a) for a, b in pairs])


def srgb_from_linear(linear: Sequence[float]) -> Values:
    """sRGB of linear Rec.709, clamped to [0, 1]."""
    return tuple(encode(min(max(v, 0.0), 1.0)) for v in linear)


def luminance(linear: Sequence[float]) -> float:
    """Luminance of linear Rec.709."""
    return sum(w * v for w, v in zip(c.LUMINANCE_WEIGHTS, linear, strict=True))


def lab_from_srgb(srgb: Sequence[float]) -> Lab:
    """CIE Lab of sRGB in [0, 1]."""
    xyz = _apply(c.XYZ_FROM_REC709, linear_from_srgb(srgb))
    curved = []
    for value, white in zip(xyz, c.WHITE, strict=True):
        ratio = value / white
        line = ratio * c.LAB_RISE / c.LAB_RUN + c.LAB_OFFSET
        curved.append(ratio ** (1 / 3) if ratio > c.LAB_DELTA**3 else line)
    x, y, z = curved
    return 116 * y - 16, 500 * (x - y), 200 * (y - z)


def srgb_from_lab(lab: Lab) -> Values:
    """sRGB of CIE Lab, clamped to the gamut."""
    y = (lab[0] + 16) / 116
    curved = (y + lab[1] / 500, y, y - lab[2] / 200)
    ratios = (v**3 if v > c.LAB_DELTA else (v - c.LAB_OFFSET) * c.LAB_RUN / c.LAB_RISE for v in curved)
    xyz = [white * ratio for ratio, white in zip(ratios, c.WHITE, strict=True)]
    return srgb_from_linear(_apply(c.REC709_FROM_XYZ, xyz))


def oklab_from_srgb(srgb: Sequence[float]) -> Lab:
    """OKLab (Ottosson 2020) of sRGB in [0, 1]. A lightened blue keeps its hue in OKLab, but turns purple in CIE Lab."""
    cones = _apply(c.CONES_FROM_REC709, linear_from_srgb(srgb))
    return _apply(c.OKLAB_FROM_CONES, [v ** (1 / 3) for v in cones])


def srgb_from_oklab(lab: Lab) -> Values:
    """sRGB of OKLab, clamped to the gamut; the inverse of `oklab_from_srgb`."""
    cones = [v**3 for v in _apply(c.CONES_FROM_OKLAB, lab)]
    return srgb_from_linear(_apply(c.REC709_FROM_CONES, cones))


def chroma(lab: Lab) -> float:
    """Chroma of a Lab or OKLab color: its distance from gray."""
    return math.hypot(lab[1], lab[2])


def _apply(matrix: c.ColorMatrix, vector: Sequence[float]) -> Lab:
    x, y, z = (sum(m * v for m, v in zip(row, vector, strict=True)) for row in matrix)
    return x, y, z
