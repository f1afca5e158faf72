# SPDX-License-Identifier: Apache-2.0
"""Tints in words."""

from __future__ import annotations

import math

_GRAY = 4.0  # C* below which a tint is none
_SLIGHT = 10.0  # C* below which it is a slight one
_HUES = (
    (20.0, "pink"),
    (48.0, "red"),
    (72.0, "orange"),
    (105.0, "yellow"),
    (165.0, "green"),
    (225.0, "teal"),
    (255.0, "cyan-blue"),
    (300.0, "blue"),
    (335.0, "violet"),
    (360.0, "pink"),
)
"""Hue angles in CIE Lab, degrees, up to which a hue is called so."""


def hue(a: float, b: float) -> str:
    """What people call a tint: "teal", "slightly orange", "neutral"."""
    strength = math.hypot(a, b)
    if strength < _GRAY:
        return "neutral"
    angle = math.degrees(math.atan2(b, a)) % 360
    name = next(name for end, name in _HUES if angle <= end)
    return f"slightly {name}" if strength < _SLIGHT else name
