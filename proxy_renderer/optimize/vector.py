# SPDX-License-Identifier: Apache-2.0
"""All values of a scene as one vector u in [0, 1]^N, on which steps of equal length look about equally large."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from copy import copy
from dataclasses import replace

import torch
from torch import Tensor

from ..color.tensors import luminance
from ..planning.types import Plan
from ..schema import Instance, Values

_FLATTEST = 0.05  # least u at which the slope of a power scale is taken
_STRIDE, _FLAT_STRIDE = 0.01, 0.15  # moves of u for a difference: usual; at the flat end of a power scale
_FLAT_FROM, _FLAT_BELOW = 2.5, 0.25  # exponent from which a power scale has a flat end; u where it stops
_TURN = 360.0  # degrees
_NARROW = 0.15  # in u: a narrower range opens as one of this width does


class ParameterVector:
    """The map between {key: values in schema units} and u (N,), component by component (a color has three).

    u is float64, so that values that did not move survive the round trip. Decoded values are float32, as the renderer expects.
    """

    def __init__(self, instances: Mapping[str, Instance]) -> None:
        self.instances = dict(instances)  # the instances by key, in the order of the vector
        self.slices: dict[str, slice] = {}  # key -> its components in u
        self.size = 0  # N
        for key, instance in self.instances.items():
            self.slices[key] = slice(self.size, self.size + instance.parameter.components)
            self.size += instance.parameter.components
        each = [(i, n) for i in self.instances.values() for n in range(i.parameter.components)]
        self._lower = torch.tensor([i.lower[n] for i, n in each], dtype=torch.float64)
        self._upper = torch.tensor([i.upper[n] for i, n in each], dtype=torch.float64)
        self._log = torch.tensor([i.parameter.scale.name == "log" for i, _ in each])
        self._exponent = torch.tensor([i.parameter.scale.exponent for i, _ in each], dtype=torch.float64)
        # keys whose values are written even if they did not move: those of added lights and, in a further shot,
        # values that the plan lets move and in which its scene differs from the first shot
        self.taken: frozenset[str] = frozenset()
        self.links: tuple[str, ...] = ()  # keys of light links, which are written with every change
        self._home = torch.zeros(self.size, dtype=torch.float64)
        self._home = self.encode({key: instance.value for key, instance in self.instances.items()})

    def view(self, names: Mapping[str, str]) -> ParameterVector:
        """The same vector under the keys of one of several shots; `names`: key of the shot -> key of this vector."""
        shown = copy(self)
        shown.instances = {own: self.instances[key] for own, key in names.items()}
        shown.slices = {own: self.slices[key] for own, key in names.items()}
        shown.taken = frozenset()
        return shown

    def taking(self, keys: Iterable[str], links: Iterable[str] | None = None) -> ParameterVector:
        """The same vector with these keys added to `taken`, and with other light links if they are given."""
        other = copy(self)
        other.taken = self.taken.union(keys)
        other.links = self.links if links is None else tuple(links)
        return other

    def encode(self, values: Mapping[str, Sequence[float]]) -> Tensor:
        """u (N,) float64 in [0, 1]; `values`: key -> value in schema units; keys that are missing take the artist's."""
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

        A power scale is flat at its lower end, so that fog of density zero could never grow. The gradient for u < 0.05
        is therefore the slope at 0.05.
        """
        return self.along(u, u - u.detach())

    def along(self, u: Tensor, move: Tensor) -> dict[str, Tensor]:
        """Key -> (C,) float32 values at u + move, each (N,), extrapolated linearly from u with the slopes of `decode`."""
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
        """Moves (N,) of u (N,) for finite differences, which change an image a little; longer where a scale is flat."""
        flat = (self._exponent >= _FLAT_FROM) & (u < _FLAT_BELOW)
        return torch.where(flat, _FLAT_STRIDE, _STRIDE).to(u)

    def values(self, u: Tensor) -> dict[str, Values]:
        """Key -> values of u (N,) in schema units, to six digits; values that did not move are exactly the artist's."""
        moved, raw = (u.detach() - self._home).abs() > 1e-9, self.plain(u)
        out: dict[str, Values] = {}
        for key, part in self.slices.items():
            i = self.instances[key]
            rows = zip(raw[key], i.lower, i.upper, i.value, moved[part].tolist(), strict=True)
            out[key] = tuple(min(max(float(f"{v:.6g}"), low), high) if m else own for v, low, high, own, m in rows)
        return out

    def changes(self, u: Tensor) -> dict[str, Values]:
        """Key -> values of u (N,) that have to be written: those that differ from the artist's, `taken` ones, and light links."""
        values = self.values(u)
        changed = {k: v for k, v in values.items() if k in self.taken or v != self.instances[k].value}
        return changed | dict.fromkeys(self.links, (1.0,))

    def plain(self, u: Tensor) -> dict[str, Values]:
        """Key -> values of u (N,) in schema units as floats, without rounding."""
        rows = {}
        for key, part in self.slices.items():
            i = self.instances[key]
            rows[key] = tuple(map(i.parameter.scale.from_unit, u[part].tolist(), i.lower, i.upper))
        return rows

    def mark(self, keys: Iterable[str]) -> Tensor:
        """(N,) bool, True for the components of these keys."""
        marked = torch.zeros(self.size, dtype=torch.bool)
        for key in keys:
            marked[self.slices[key]] = True
        return marked

    def bounds(self, ranges: Mapping[str, tuple[Values, Values]]) -> tuple[Tensor, Tensor]:
        """The lower and upper corner, each (N,), of the feasible box; `ranges`: key -> (lower, upper).

        Keys without a range get their hard bounds, locked keys the artist's values.
        """
        free = {key: instance for key, instance in self.instances.items() if not instance.locked}
        own = {key: ranges.get(key, (instance.lower, instance.upper)) for key, instance in free.items()}
        lower, upper = (self.encode({key: ends[side] for key, ends in own.items()}) for side in (0, 1))
        return torch.minimum(lower, upper), torch.maximum(lower, upper)


def project(u: Tensor, lower: Tensor, upper: Tensor) -> Tensor:
    """Π: the nearest point to u (N,) in the feasible box (Algorithm 1, lines 7 and 14)."""
    return torch.minimum(torch.maximum(u, lower), upper)


def start_point(vector: ParameterVector, plan: Plan, u: Tensor) -> Tensor:
    """The point u (N,), moved to the start values of those plan entries that have some, see `PlanEntry.start`."""
    starts = {key: entry.start for key, entry in plan.items() if entry.start is not None}
    return torch.where(vector.mark(starts), vector.encode(starts), u)


def around(u: Tensor, lower: Tensor, upper: Tensor, share: float) -> tuple[Tensor, Tensor]:
    """The corners, each (N,), of the part of a box within `share` of each range from u (N,), projected into the box."""
    middle, reach = project(u, lower, upper), share * (upper - lower)
    return torch.maximum(lower, middle - reach), torch.minimum(upper, middle + reach)


def opened(lower: Tensor, upper: Tensor, share: Tensor, own: Tensor) -> tuple[Tensor, Tensor]:
    """The corners, each (N,), of a box whose ranges open at both ends by `share` (N,) of their width, within [0, 1].

    A range narrower than `_NARROW` opens as if it had that width. If the artist's point `own` (N,) lies outside a
    range, the range does not open beyond it: "more contrast" never becomes less than the artist's.
    """
    margin = torch.where(share > 0.0, share * (upper - lower).clamp_min(_NARROW), 0.0)
    low = torch.where(own < lower, torch.maximum(lower - margin, own), lower - margin)
    high = torch.where(own > upper, torch.minimum(upper + margin, own), upper + margin)
    return low.clamp_min(0.0).minimum(lower), high.clamp_max(1.0).maximum(upper)


def feasible_ranges(
    plan: Plan, instances: Mapping[str, Instance], values: Mapping[str, Values]
) -> dict[str, tuple[Values, Values]]:
    """Key -> (lower, upper) of the plan's range; azimuths are turned by a whole circle if that is nearer to `values`.

    Keys that `values` lacks are compared with the artist's values.
    """
    return {
        key: nearest_turn(instances[key], entry.lower, entry.upper, values.get(key, instances[key].value))
        for key, entry in plan.items()
    }


def nearest_turn(instance: Instance, lower: Values, upper: Values, value: Values) -> tuple[Values, Values]:
    """The range of an angle, turned by a whole circle if that is nearer to the value: for -170, [180, 200] becomes [-180, -160]."""
    if instance.parameter.unit != "deg" or instance.parameter.upper - instance.parameter.lower < 2 * _TURN:
        return lower, upper

    def distance(shift: float) -> float:
        low, high = lower[0] + shift, upper[0] + shift
        outside = low < instance.lower[0] - 1e-6 or high > instance.upper[0] + 1e-6
        return math.inf if outside else max(low - value[0], value[0] - high, 0.0)

    shift = min((0.0, -_TURN, _TURN), key=distance)
    return (lower[0] + shift,), (upper[0] + shift,)


DENSITY, EXPOSURE = "volume/density", "film/exposure"
_BRIGHTEST, _AROUND = 5.0, 1.0  # stops: the largest correction, and how far the search may go from it, up or down


def exposed_through_air(plan: Plan, vector: ParameterVector, linear: Callable[[Tensor], Tensor]) -> Plan:
    """The plan, with a start for the exposure at which the image through its fog is as light as without fog.

    Cycles' fog takes most of a sun's light. The plan stays the same if words do not name the fog, if they name the
    exposure, or if the exposure may not change. `linear` renders the scene-linear image (H, W, 3) of a point u (N,).
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
        roots = (luminance(linear(point)).clamp_min(1e-5).pow(1 / 3) for point in (clear, filled))
        light, left = (float(root.mean()) for root in roots)
    stops = 3.0 * math.log2(light / left)
    if stops < 0.25:
        return plan
    start = vector.instances[EXPOSURE].value[0] + min(stops, _BRIGHTEST)
    lower, upper = min(film.lower[0], start - _AROUND), max(film.upper[0], start + _AROUND)
    why = "supports the words: fog takes light"
    exposed = replace(film, lower=(lower,), upper=(upper,), start=(start,), reason=why)
    return Plan({**plan, EXPOSURE: exposed}, plan.notes)
