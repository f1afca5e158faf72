# SPDX-License-Identifier: Apache-2.0
"""The grays that views show: how much light it takes for a gray of some lightness."""

from __future__ import annotations

from bisect import bisect_left
from math import exp, log

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
