# SPDX-License-Identifier: Apache-2.0
"""All values of a scene as one vector u in [0, 1]^N, on which equal steps look alike."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from copy import copy

import torch
from torch import Tensor

from ..planning.types import Plan
from ..schema import Instance, Values

_FLATTEST = 0.05
_STRIDE, _FLAT_STRIDE = 0.01, 0.15  # moves of u for a slope: usual, and near the flat end of a scale
_FLAT_FROM, _FLAT_BELOW = 2.5, 0.25  # exponent of such a scale, and where that end ends
_TURN = 360.0
_NARROW = 0.15  # of a whole scale: how wide a range counts at least where it opens


class ParameterVector:
    """The map between {key: values} and u, component by component (colors take three).

    u is float64, so that a value that nothing moved survives the round trip; decoded values are
    float32, as the renderer wants them.
    """

    def __init__(self, instances: Mapping[str, Instance]) -> None:
        self.instances = dict(instances)  # the instances by key, in the order of the vector
        self.slices: dict[str, slice] = {}  # where each key's components are
        self.size = 0  # N
        for key, instance in self.instances.items():
            self.slices[key] = slice(self.size, self.size + instance.parameter.components)
            self.size += instance.parameter.components
        each = [i for i in self.instances.values() for _ in range(i.parameter.components)]
        self._lower = _stack(i.lower for i in self.instances.values())
        self._upper = _stack(i.upper for i in self.instances.values())
        self._log = torch.tensor([i.parameter.scale.name == "log" for i in each])
        self._exponent = torch.tensor([i.parameter.scale.exponent for i in each], dtype=torch.float64)
        # keys whose values are written though nothing has moved them: lights that are added, and in a further
        # shot values that the words name and the first shot has already
        self.taken: frozenset[str] = frozenset()
        self.links: tuple[str, ...] = ()  # keys of light links, which are written with every change
        self._home = torch.zeros(self.size, dtype=torch.float64)
        self._home = self.encode({key: instance.value for key, instance in self.instances.items()})

    def view(self, names: Mapping[str, str]) -> ParameterVector:
        """The same u for one of several shots, which calls some of its parameters by names of its own."""
        shown = copy(self)
        shown.instances = {own: self.instances[key] for own, key in names.items()}
        shown.slices = {own: self.slices[key] for own, key in names.items()}
        shown.taken = frozenset()
        return shown

    def taking(self, keys: Iterable[str]) -> ParameterVector:
        """The same u, with these keys among the taken."""
        other = copy(self)
        other.taken = self.taken.union(keys)
        return other

    def encode(self, values: Mapping[str, Sequence[float]]) -> Tensor:
        """u (N,) float64 in [0, 1] of values in schema units, by key; keys that are missing take the artist's value."""
        u = self._home.clone()
        for key in values.keys() & self.slices.keys():
            instance = self.instances[key]
            scale = instance.parameter.scale
            bounds = zip(values[key], instance.lower, instance.upper, strict=True)
            place = [scale.to_unit(float(v), low, high) if high > low else 0.0 for v, low, high in bounds]
            u[self.slices[key]] = torch.tensor(place, dtype=torch.float64)
        return u

    def decode(self, u: Tensor) -> dict[str, Tensor]:
        """Key -> (C,) float32 values of u (N,) in schema units, differentiable in u.

        A power scale is flat at its lower end, where a fog of density zero could never grow:
        there the gradient takes the slope of a twentieth of the way up.
        """
        return self.along(u, u - u.detach())

    def along(self, u: Tensor, move: Tensor) -> dict[str, Tensor]:
        """Values at a move (N,) from u (N,), as the slopes at u have it; otherwise as `decode`."""
        x = u.detach().clamp(0.0, 1.0)
        span = self._upper - self._lower
        ratio = (self._upper / self._lower.clamp_min(1e-30)).clamp_min(1e-30)
        log_value = self._lower * ratio**x
        power_value = self._lower + span * x**self._exponent
        power_slope = span * self._exponent * x.clamp_min(_FLATTEST) ** (self._exponent - 1.0)
        value = torch.where(self._log, log_value, power_value)
        slope = torch.where(self._log, log_value * ratio.log(), power_slope)
        linked = (value + slope * move).float()
        return {key: linked[part] for key, part in self.slices.items()}

    def strides(self, u: Tensor) -> Tensor:
        """(N,) moves of u (N,) by which a picture changes a little; longer where a power scale is flat."""
        flat = (self._exponent >= _FLAT_FROM) & (u < _FLAT_BELOW)
        return torch.where(flat, _FLAT_STRIDE, _STRIDE).to(u)

    def values(self, u: Tensor) -> dict[str, Values]:
        """Key -> values of u (N,) in schema units, to six digits; values where the artist had them keep the same float."""
        moved, raw = (u.detach() - self._home).abs() > 1e-9, self.plain(u)
        out: dict[str, Values] = {}
        for key, part in self.slices.items():
            instance = self.instances[key]
            limits = raw[key], instance.lower, instance.upper
            new = [min(max(float(f"{v:.6g}"), low), high) for v, low, high in zip(*limits, strict=True)]
            components = zip(new, instance.value, moved[part].tolist(), strict=True)
            out[key] = tuple(v if m else old for v, old, m in components)
        return out

    def changes(self, u: Tensor) -> dict[str, Values]:
        """Values of u (N,) that differ from the artist's, those that are taken, and links of lights."""
        values = self.values(u)
        changed = {k: v for k, v in values.items() if k in self.taken or v != self.instances[k].value}
        return changed | dict.fromkeys(self.links, (1.0,))

    def plain(self, u: Tensor) -> dict[str, Values]:
        """Values of u (N,) as plain numbers, without regard to the artist's."""
        rows = {}
        for key, part in self.slices.items():
            i = self.instances[key]
            bounds = zip(u[part].tolist(), i.lower, i.upper, strict=True)
            rows[key] = tuple(i.parameter.scale.from_unit(x, low, high) for x, low, high in bounds)
        return rows

    def mark(self, keys: Iterable[str]) -> Tensor:
        """(N,) bool: the components of these keys."""
        marked = torch.zeros(self.size, dtype=torch.bool)
        for key in keys:
            marked[self.slices[key]] = True
        return marked

    def bounds(self, ranges: Mapping[str, tuple[Values, Values]]) -> tuple[Tensor, Tensor]:
        """The feasible box in u: plan ∩ hard bounds ∩ locks, each corner (N,).

        A key without a range may go anywhere within its hard bounds, and a locked one stays at the artist's value. A range outside of
        the hard bounds becomes their nearest end.
        """
        lower, upper = {}, {}
        for key, instance in self.instances.items():
            low, high = ranges.get(key, (instance.lower, instance.upper))
            lower[key], upper[key] = (instance.value, instance.value) if instance.locked else (low, high)
        u_lower, u_upper = self.encode(lower), self.encode(upper)
        return torch.minimum(u_lower, u_upper), torch.maximum(u_lower, u_upper)


def project(u: Tensor, lower: Tensor, upper: Tensor) -> Tensor:
    """Π: the nearest point to u (N,) in the feasible box (Algorithm 1, lines 7 and 14)."""
    return torch.minimum(torch.maximum(u, lower), upper)


def start_point(vector: ParameterVector, plan: Plan, u: Tensor) -> Tensor:
    """The artist's point u (N,), with the values where words have the search begin, see `PlanEntry.start`."""
    starts = {key: entry.start for key, entry in plan.items() if entry.start is not None}
    return torch.where(vector.mark(starts), vector.encode(starts), u)


def around(u: Tensor, lower: Tensor, upper: Tensor, share: float) -> tuple[Tensor, Tensor]:
    """The corners, each (N,), of the part of a box around u's nearest point in it: a share of each range on either side."""
    middle, reach = project(u, lower, upper), share * (upper - lower)
    return torch.maximum(lower, middle - reach), torch.minimum(upper, middle + reach)


def opened(lower: Tensor, upper: Tensor, share: Tensor, own: Tensor) -> tuple[Tensor, Tensor]:
    """The corners, each (N,), of a box with ranges wider by a share on either side, within the hard bounds; infinite is all there is.

    A narrow range is widened as one of `_NARROW` is. None opens farther than to the artist's value (N,): more contrast never comes
    to less of it.
    """
    margin = torch.where(share > 0.0, share * (upper - lower).clamp_min(_NARROW), 0.0)
    low = torch.where(own < lower, torch.maximum(lower - margin, own), lower - margin)
    high = torch.where(own > upper, torch.minimum(upper + margin, own), upper + margin)
    return low.clamp_min(0.0).minimum(lower), high.clamp_max(1.0).maximum(upper)


def feasible_ranges(
    plan: Plan, instances: Mapping[str, Instance], values: Mapping[str, Values]
) -> dict[str, tuple[Values, Values]]:
    """Key -> (lower, upper) of the plan, azimuths turned to where the values are now; the artist's where missing."""
    return {
        key: nearest_turn(instances[key], entry.lower, entry.upper, values.get(key, instances[key].value))
        for key, entry in plan.items()
    }


def nearest_turn(instance: Instance, lower: Values, upper: Values, value: Values) -> tuple[Values, Values]:
    """The range of an angle, turned by whole circles to lie nearest to the value: -170 is ten degrees from the range [180, 200]."""
    if instance.parameter.unit != "deg" or instance.parameter.upper - instance.parameter.lower < 2 * _TURN:
        return lower, upper

    def distance(shift: float) -> float:
        low, high = lower[0] + shift, upper[0] + shift
        outside = low < instance.lower[0] - 1e-6 or high > instance.upper[0] + 1e-6
        return math.inf if outside else max(low - value[0], value[0] - high, 0.0)

    shift = min((0.0, -_TURN, _TURN), key=distance)
    return (lower[0] + shift,), (upper[0] + shift,)


def _stack(rows: Iterable[Values]) -> Tensor:
    return torch.tensor([v for row in rows for v in row], dtype=torch.float64)
