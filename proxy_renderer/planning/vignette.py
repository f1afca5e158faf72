# SPDX-License-Identifier: Apache-2.0
"""Vignettes that are seen as much on any surroundings."""

from __future__ import annotations

from .display import lightness, radiance
from .sources import Range

_GRAY = 50.0  # L* of the surroundings that a vignette's range is meant for


def seen_vignette(ends: Range, around: float | None, view: str) -> Range:
    """A vignette that is seen as much on surroundings of this L* as the range is on mid-gray ones.

    The view swallows what darkens highlights, and dark corners soon are black.
    """
    light = min(max(around, 10.0), 92.0) if around is not None else _GRAY
    seen = []
    for ((amount,),) in zip(ends, strict=True):
        drop = _GRAY - lightness(radiance(_GRAY, view) * (1 - amount), view)
        goal = light - drop * min(light / _GRAY, 1.0)
        seen.append((1 - radiance(goal, view) / radiance(light, view) if amount > 0.02 else amount,))
    return seen[0], seen[1]
