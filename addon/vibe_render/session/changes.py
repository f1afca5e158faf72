# SPDX-License-Identifier: GPL-3.0-or-later
"""What lies between an old and a new value: how it reads, and what is part of the way. No bpy here."""

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
    """The value `strength` of the way from before (0) to after (1), in even steps to the eye."""
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
