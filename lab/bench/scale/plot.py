# SPDX-License-Identifier: Apache-2.0
"""A plot of costs by size, both logarithmic, as SVG."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

_WIDTH, _HEIGHT, _GAP = 190, 170, 56
_COLORS = ("#4477aa", "#66ccee", "#228833", "#ccbb44", "#ee6677")
"""Paul Tol's bright scheme: told apart by people who see few colors too."""

Curve = Sequence[tuple[float, float]]


def plot(axes: Mapping[str, Mapping[str, Curve]]) -> str:
    """Draws one panel for each axis, with a line for each phase and, dotted, a slope of one.

    Args:
        axes: Axis to phase to its points (size, seconds), all positive.
    """
    seconds = [y for curves in axes.values() for curve in curves.values() for _, y in curve]
    low, high = math.floor(math.log10(min(seconds))), math.floor(math.log10(max(seconds))) + 1
    width, height = len(axes) * (_WIDTH + _GAP) + 10, _HEIGHT + 90
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="11">',
        f'<rect width="{width}" height="{height}" fill="white"/>',
    ]
    for i, (axis, curves) in enumerate(axes.items()):
        parts.append(f'<g transform="translate({_GAP + i * (_WIDTH + _GAP)},30)">')
        parts += _panel(axis, curves, low, high)
        parts.append("</g>")
    for i, phase in enumerate(next(iter(axes.values()))):
        x, color = _GAP + 110 * i, _COLORS[i % len(_COLORS)]
        parts.append(f'<path d="M{x},{height - 12}h20" stroke="{color}" stroke-width="2"/>')
        parts.append(f'<text x="{x + 26}" y="{height - 8}">{phase}</text>')
    return "\n".join([*parts, "</svg>", ""])


def _panel(axis: str, curves: Mapping[str, Curve], low: int, high: int) -> list[str]:
    sizes = sorted({x for curve in curves.values() for x, _ in curve})
    first, last = math.log10(sizes[0]), math.log10(max(sizes[-1], 10 * sizes[0]))

    def at(x: float, y: float) -> str:
        right = (math.log10(x) - first) / (last - first) * _WIDTH
        down = (high - math.log10(y)) / (high - low) * _HEIGHT
        return f"{right:.1f},{down:.1f}"

    parts = [f'<rect width="{_WIDTH}" height="{_HEIGHT}" fill="none" stroke="#999"/>']
    parts.append(f'<text x="{_WIDTH / 2}" y="-10" text-anchor="middle">processor seconds by {axis}</text>')
    for power in range(low, high + 1):
        y = at(sizes[0], 10.0**power).split(",")[1]
        parts.append(f'<path d="M0,{y}h{_WIDTH}" stroke="#ddd"/>')
        parts.append(f'<text x="-6" y="{float(y) + 4}" text-anchor="end">{10.0**power:g}</text>')
    for x in sizes:
        place = at(x, 10.0**low).split(",")[0]
        parts.append(f'<text x="{place}" y="{_HEIGHT + 16}" text-anchor="middle">{_short(x)}</text>')
    reach = min(last - first, high - low)
    one = f"M{at(sizes[0], 10.0**low)}L{at(10 ** (first + reach), 10.0 ** (low + reach))}"
    parts.append(f'<path d="{one}" stroke="#999" stroke-dasharray="2,4"/>')
    for i, curve in enumerate(curves.values()):
        color = _COLORS[i % len(_COLORS)]
        line = "L".join(at(x, y) for x, y in curve)
        parts.append(f'<path d="M{line}" fill="none" stroke="{color}" stroke-width="2"/>')
    return parts


def _short(number: float) -> str:
    """A number in few letters: 1k, 10M."""
    for unit, letter in ((1e6, "M"), (1e3, "k")):
        if number >= unit:
            return f"{number / unit:.0f}{letter}"
    return f"{number:.0f}"
