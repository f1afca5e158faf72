# SPDX-License-Identifier: Apache-2.0
"""The exposure for fog that words add: Cycles' fog takes most of a sun's light on its long way through the volume."""

import math
from collections.abc import Callable
from dataclasses import replace

import torch
from torch import Tensor

from ..color.tensors import luminance
from ..planning.types import Plan
from .vector import ParameterVector, feasible_ranges, project, start_point

DENSITY, EXPOSURE = "volume/density", "film/exposure"
_MOST, _AROUND = 5.0, 1.0  # stops: the largest correction, and how far the search may go from it, up or down
_LEAST = 0.25  # stops below which nothing is corrected
_BLACK = 1e-5  # least linear luminance that is counted


def exposed_through_air(plan: Plan, vector: ParameterVector, linear: Callable[[Tensor], Tensor]) -> Plan:
    """The plan, with a start for the exposure at which the image through its fog is as light as without fog.

    The plan stays the same if words do not name the fog, if they name the exposure, or if the exposure may not change. `linear`
    renders the scene-linear image (H, W, 3) of a point u (N,).
    """
    air, film = plan.get(DENSITY), plan.get(EXPOSURE)
    if not (air and film) or not air.is_named or film.priority is None or film.is_named:
        return plan
    home = vector.encode({})
    bounds = vector.bounds(feasible_ranges(plan, vector.instances, vector.values(home)))
    filled = project(start_point(vector, plan, home), *bounds)
    clear = torch.where(vector.mark([DENSITY]), home, filled)
    with torch.no_grad():
        # The mean cube root of luminance is a lightness in which a few bright pixels count little.
        roots = (luminance(linear(point)).clamp_min(_BLACK).pow(1 / 3) for point in (clear, filled))
        light, left = (float(root.mean()) for root in roots)
    stops = 3.0 * math.log2(light / left)
    if stops < _LEAST:
        return plan
    start = vector.instances[EXPOSURE].value[0] + min(stops, _MOST)
    lower, upper = min(film.lower[0], start - _AROUND), max(film.upper[0], start + _AROUND)
    why = "supports the words: fog takes light"
    exposed = replace(film, lower=(lower,), upper=(upper,), start=(start,), reason=why)
    return Plan({**plan, EXPOSURE: exposed}, plan.notes)
