# SPDX-License-Identifier: Apache-2.0
"""u and back: exact for what nothing moved, differentiable, and never outside of a box."""

import math

import pytest
import torch

from proxy_renderer.optimize.vector import ParameterVector, nearest_turn, opened, project, start_point
from proxy_renderer.planning.types import Plan, PlanEntry
from proxy_renderer.schema import FAMILIES, PARAMETERS, Instance


def instance(family, value, owner="", **more):
    parameter = FAMILIES[family]
    values = tuple(value) if isinstance(value, (tuple, list)) else (value,) * parameter.components
    return Instance(parameter, owner, values, **more)


def vector_of(*instances):
    return ParameterVector({i.key: i for i in instances})


def everything(where):
    """One instance of every family, at a share `where` of its range."""
    made = [Instance(p, "X", (p.default,) * p.components, 2.0 if p.reference else 1.0) for p in PARAMETERS]
    scale = [(i, i.parameter.scale.from_unit(where, i.lower[0], i.upper[0])) for i in made]
    return {i.key: Instance(i.parameter, "X", (v,) * len(i.value), i.reference) for i, v in scale}


@pytest.mark.parametrize("where", [0.0, 0.3, 1.0])
def test_values_that_nothing_moved_are_the_very_same_floats(where):
    instances = everything(where)
    vector = ParameterVector(instances)
    assert vector.values(vector.encode({})) == {k: i.value for k, i in instances.items()}


@pytest.mark.parametrize("where", [0.01, 0.5, 0.99])
def test_decode_agrees_with_the_schema(where):
    vector = ParameterVector(everything(0.4))
    decoded = vector.decode(torch.full((vector.size,), where, dtype=torch.float64))
    for key, i in vector.instances.items():
        expected = [i.parameter.scale.from_unit(where, a, b) for a, b in zip(i.lower, i.upper, strict=True)]
        torch.testing.assert_close(decoded[key], torch.tensor(expected), rtol=1e-4, atol=1e-6)


def test_gradient_is_the_slope_of_the_scale():
    vector = ParameterVector(everything(0.4))
    u = torch.full((vector.size,), 0.6, dtype=torch.float64, requires_grad=True)
    sum(v.double().sum() for v in vector.decode(u).values()).backward()
    plus, minus = (vector.plain(u.detach() + d) for d in (1e-6, -1e-6))
    slopes = [(a - b) / 2e-6 for k in plus for a, b in zip(plus[k], minus[k], strict=True)]
    torch.testing.assert_close(u.grad, torch.tensor(slopes, dtype=torch.float64), rtol=1e-3, atol=1e-4)


def test_a_fog_of_density_zero_can_grow():
    vector = vector_of(instance("volume/density", 0.0))
    u = torch.zeros(1, dtype=torch.float64, requires_grad=True)
    value = vector.decode(u)["volume/density"]
    value.sum().backward()
    assert value.item() == 0.0
    assert u.grad.item() > 0.0


def test_projection_stays_in_plan_hard_bounds_and_locks():
    free = instance("material/roughness", 0.9, "Body")
    locked = instance("material/metallic", 0.25, "Body", locked="keyframed")
    color = instance("material/base_color", (0.5, 0.5, 0.5), "Body")
    vector = vector_of(free, locked, color)
    ranges = {free.key: ((0.1,), (0.3,)), locked.key: ((0.8,), (1.0,)), color.key: ((0.0, 0.2, -5.0), (0.1, 0.6, 9.0))}
    lower, upper = vector.bounds(ranges)
    values = vector.values(project(vector.encode({}), lower, upper))
    assert values[free.key] == pytest.approx((0.3,))
    assert values[locked.key] == (0.25,)
    assert values[color.key] == pytest.approx((0.1, 0.5, 0.5))
    far = vector.plain(project(torch.full((vector.size,), 7.0, dtype=torch.float64), lower, upper))
    assert far[color.key] == pytest.approx((0.1, 0.6, 1.0))


def test_colors_take_three_components_and_are_marked_together():
    vector = vector_of(instance("film/contrast", 1.0), instance("film/gain", 1.0))
    assert vector.size == 4
    assert vector.mark(["film/gain"]).tolist() == [False, True, True, True]


@pytest.mark.parametrize(
    ("value", "range_", "expected"),
    [
        (-170.0, (180.0, 200.0), (-180.0, -160.0)),
        (10.0, (0.0, 20.0), (0.0, 20.0)),
        (170.0, (-200.0, -150.0), (160.0, 210.0)),
    ],
)
def test_an_azimuth_takes_the_short_way(value, range_, expected):
    sun = instance("light/azimuth", value, "Sun")
    low, high = nearest_turn(sun, (range_[0],), (range_[1],), (value,))
    assert (low[0], high[0]) == expected


def test_a_range_never_turns_out_of_the_hard_bounds():
    sun = instance("light/azimuth", -350.0, "Sun")
    low, high = nearest_turn(sun, (-200.0,), (-150.0,), (-350.0,))
    assert sun.lower[0] <= low[0] <= high[0] <= sun.upper[0]
    hue = instance("film/hue", 80.0)
    assert nearest_turn(hue, (-90.0,), (-80.0,), (80.0,)) == ((-90.0,), (-80.0,))


def test_wider_ranges_stay_within_the_hard_bounds_and_leave_others_alone():
    lower, upper = (torch.tensor(x, dtype=torch.float64) for x in ([0.1, 0.4, 0.4, 0.5], [0.5, 0.6, 0.6, 0.5]))
    low, high = opened(lower, upper, torch.tensor([0.5, 0.5, 0.0, 0.5]), lower)
    torch.testing.assert_close(low, torch.tensor([0.0, 0.3, 0.4, 0.425], dtype=torch.float64))
    torch.testing.assert_close(
        high, torch.tensor([0.7, 0.7, 0.6, 0.575], dtype=torch.float64)
    )  # a single value opens too


def test_a_range_opens_no_farther_than_to_the_artists_value():
    lower, upper, own = (
        torch.tensor(x, dtype=torch.float64) for x in ([0.5, 0.5, 0.5], [0.7, 0.7, 0.7], [0.45, 0.9, 0.6])
    )
    low, high = opened(lower, upper, torch.tensor([math.inf, math.inf, 0.5]), own)
    torch.testing.assert_close(low, torch.tensor([0.45, 0.0, 0.4], dtype=torch.float64))
    torch.testing.assert_close(high, torch.tensor([1.0, 0.9, 0.8], dtype=torch.float64))


def test_what_words_name_begins_where_they_say_and_the_rest_at_home():
    painted = instance("material/base_color", (0.2, 0.2, 0.2), "Body")
    other = instance("material/base_color", (0.7, 0.1, 0.1), "Wall")
    vector = vector_of(painted, other)
    teal, ends = (0.0, 0.3, 0.3), ((0.0, 0.1, 0.1), (0.1, 0.6, 0.6))
    plan = Plan({painted.key: PlanEntry(*ends, 1, "'teal'", start=teal), other.key: PlanEntry(*ends, 2, "")})
    values = vector.values(start_point(vector, plan, vector.encode({})))
    assert values[painted.key] == pytest.approx(teal, abs=1e-6)
    assert values[other.key] == other.value
