# SPDX-License-Identifier: Apache-2.0
"""The exposure of a picture through fog that the words bring: Cycles' air takes most of a sun's light on its long way through it."""

import math
from collections.abc import Callable
from dataclasses import replace

import torch
from torch import Tensor

from ..color.tensors import luminance
from ..planning.types import Plan
from .vector import ParameterVector, feasible_ranges, project, start_point

DENSITY, EXPOSURE = "volume/density", "film/exposure"
_MOST, _AROUND = 5.0, 1.0  # stops: that exposure makes up for, and that the search may go from there
_LEAST = 0.25  # stops that nobody sees
_BLACK = 1e-5


def exposed_through_air(plan: Plan, vector: ParameterVector, linear: Callable[[Tensor], Tensor]) -> Plan:
    """The plan, with the exposure to begin with at which its air leaves the picture as light as clear air would.

    Args:
        linear: Scene-linear picture (H, W, 3) of a point u (N,).
    """
    air, film = plan.get(DENSITY), plan.get(EXPOSURE)
    if not (air and film) or not air.is_named or film.priority is None or film.is_named:
        return plan
    (own,), (low,), (high,) = vector.instances[DENSITY].value, air.lower, air.upper
    if own < low and air.start is None:
        plan = Plan({**plan, DENSITY: replace(air, start=(math.sqrt(low * high),))}, plan.notes)
    home = vector.encode({})
    bounds = vector.bounds(feasible_ranges(plan, vector.instances, vector.values(home)))
    filled = project(start_point(vector, plan, home), *bounds)
    clear = torch.where(vector.mark([DENSITY]), home, filled)
    with torch.no_grad():
        light, left = (_lightness(linear(point)) for point in (clear, filled))
    stops = 3.0 * math.log2(light / left)
    if stops < _LEAST:
        return plan
    (own,), (low,), (high,) = vector.instances[EXPOSURE].value, film.lower, film.upper
    start = own + min(stops, _MOST)
    ends = (min(low, start - _AROUND),), (max(high, start + _AROUND),)
    why = "supports the words: the air takes light"
    return Plan(
        {**plan, EXPOSURE: replace(film, lower=ends[0], upper=ends[1], start=(start,), reason=why)},
        plan.notes,
    )


def _lightness(linear: Tensor) -> float:
    """Mean lightness of a picture, in which a few bright pixels count little: the cube root of its luminance."""
    return float(luminance(linear).clamp_min(_BLACK).pow(1 / 3).mean())
