# SPDX-License-Identifier: Apache-2.0
"""Modes and numbers of effects: which ones a parameter can have."""

from __future__ import annotations

from ...schema import Values
from ...schema.spec import Parameter

_COUNTS = {"plus": 1, "camera": 1, "sides": 1, "lightness": 1, "share": 1, "shade": 2}
"""Mode -> how many numbers an end of a range has; of other modes one, or as many as the parameter has components."""
_LARGEST = 1e9
_BRIGHT = ("power", "strength")
"""Parameters that say how much light there is."""


def misfit(parameter: Parameter, mode: str, lower: Values, upper: Values) -> str:
    """The remedy for an effect whose mode or numbers its parameter cannot have; "" for one that fits.

    Args:
        mode: One of `entries.RANGE_MODES` or `entries.COLOR_MODES`.
        lower: Of its range; empty for colors.
    """
    if not _has(parameter, mode):
        return f"'{mode}' is no mode of {parameter.family}: use another, or none."
    if not lower:
        return ""
    counts = sorted({_COUNTS[mode]} if mode in _COUNTS else {1, parameter.components})
    if len(lower) not in counts:
        return f"Write {' or '.join(map(str, counts))} numbers at each end, with commas between them."
    if not all(abs(v) <= _LARGEST for v in (*lower, *upper)):
        return f"Write finite numbers, at most {_LARGEST:g}."
    least = min(lower)
    if mode == "times" and least < 0.0:
        return "Write no negative multiples."
    if mode == "" and parameter.scale.name == "log" and least <= 0.0:
        return "Write numbers above 0."
    return ""


def _has(parameter: Parameter, mode: str) -> bool:
    """Whether a mode says something of a parameter."""
    color, light = (
        parameter.kind == "color",
        parameter.name in _BRIGHT and parameter.group in ("light", "world"),
    )
    fits = {
        "": True,
        "times": True,
        "plus": not color,
        "shade": color,
        "camera": parameter.name == "azimuth",
        "sides": parameter.name == "azimuth",
        "lightness": color or light,
        "share": light,
        "shown": color or light,
    }
    return fits.get(mode, color)
