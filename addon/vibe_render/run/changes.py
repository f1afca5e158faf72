# SPDX-License-Identifier: GPL-3.0-or-later
"""An old and a new value as text, and the values between them. No bpy here."""

from __future__ import annotations

import math
import re

from ..core.schema_import import labels, schema


def arrow(key: str, before: schema.Values, after: schema.Values) -> str:
    """The old and the new value, the unit once: "400 → 160 W"."""
    return f"{labels.bare(key, before)} → {labels.text(key, after)}"


def cause(reason: str) -> str:
    """A reason in short, the word that it quotes: "'night' (dark night scene)" is “night”."""
    quoted = re.match(r"'(.+?)'(?!\w)", reason)
    return f"“{quoted[1]}”" if quoted else reason


def blend(key: str, before: schema.Values, after: schema.Values, strength: float) -> schema.Values:
    """A value between two others, in steps that look even: along the parameter's perceptual scale.

    Args:
        key: The parameter's key.
        before: The value at strength 0.
        after: The value at strength 1.
        strength: 0 to 1; at both ends the result is exact.
    """
    scale = labels.parameter(key).scale
    return tuple(_between(scale, a, b, strength) for a, b in zip(before, after, strict=True))


def _between(scale: schema.Scale, a: float, b: float, t: float) -> float:
    if t in (0.0, 1.0):  # exactly what was there
        return b if t else a
    if scale.name == "log" and a > 0 and b > 0:
        return a * math.pow(b / a, t)
    if scale.name == "power" and a >= 0 and b >= 0:
        root = 1.0 / scale.exponent
        return ((1 - t) * a**root + t * b**root) ** scale.exponent
    return (1 - t) * a + t * b
