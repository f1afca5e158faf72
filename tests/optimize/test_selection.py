# SPDX-License-Identifier: Apache-2.0
"""S_K: what serves the claims most, and each only once."""

import math

import pytest
import torch

from lab.methods.parts import WithoutSharing
from proxy_renderer.optimize.least_squares import Assessment, LinearModel
from proxy_renderer.optimize.rounds import selection
from proxy_renderer.optimize.rounds.selection import choose, needed
from proxy_renderer.planning.types import Plan, PlanEntry


def doubles(values):
    return torch.tensor(values, dtype=torch.float64)


def chosen(priorities, slopes, misses, k=8, gains=None, high=1.0):
    """Of parameters a, b, c, …, one for each priority, by what they do to claims that are missed by so much from below."""
    names = "abcdefgh"[: len(priorities)]
    plan = Plan({n: PlanEntry((0.0,), (1.0,), p, "because", 0.0) for n, p in zip(names, priorities, strict=True)})
    values = doubles([-m for m in misses])
    here = Assessment(
        values,
        torch.zeros_like(values),
        torch.full_like(values, math.inf),
        torch.arange(len(misses)),
        doubles(0.0),
        None,
    )
    rest = -doubles(gains) if gains else torch.zeros(len(names), dtype=torch.float64)
    rows = doubles(slopes) if len(misses) else torch.zeros((0, len(names)), dtype=torch.float64)
    model = LinearModel(here, rows, rest, torch.diag(torch.zeros_like(rest)), 1.0)
    parts = {name: slice(i, i + 1) for i, name in enumerate(names)}
    low, up = torch.zeros_like(rest), torch.full_like(rest, high)
    return choose(plan, k, model, parts, low, up)


def test_the_most_important_come_first_where_nothing_tells_them_apart():
    assert chosen([3, 0, 7], [], [])[0] == ["b", "a", "c"]
    assert chosen([3, 0, 7], [], [], k=1)[0] == ["b"]


def test_gain_decides_among_equals_and_what_gains_little_makes_room():
    assert chosen([1, 1, 0], [], [], gains=[0.5, 0.6, 0.6])[0] == ["c", "b", "a"]
    assert chosen([0, 5, 9], [], [], k=2, gains=[1e-6, 0.3, 0.2])[0] == ["b", "c"]
    assert chosen([0, 5, 9], [], [], k=2, gains=[0.1, 0.3, 0.2])[0] == ["a", "b"]


def test_what_serves_a_claim_that_is_missed_comes_before_what_serves_none():
    assert chosen([2, 2], [[0.0, 9.0]], [6.0], k=1)[0] == ["b"]


def test_of_two_that_do_the_same_one_is_held_for_the_other(monkeypatch):
    """Exposure and power do the same to all claims; the third parameter parts the claims."""
    slopes = [[9.0, 18.0, 0.0], [4.0, 8.0, 5.0], [2.0, 4.0, -3.0]]
    keys, shared = chosen([1, 0, 4], slopes, [5.0, 4.0, 1.0])
    assert keys == ["b", "c"]
    assert shared == {"a": "b"}
    monkeypatch.setattr(selection, "ALIKE", selection.ALIKE)
    WithoutSharing()
    keys, shared = chosen([1, 0, 4], slopes, [5.0, 4.0, 1.0])
    assert sorted(keys) == ["a", "b", "c"]
    assert shared == {}


def test_one_that_does_the_same_helps_where_the_other_has_no_room_left():
    slopes = [[9.0, 18.0, 0.0], [4.0, 8.0, 5.0], [2.0, 4.0, -3.0]]
    keys, shared = chosen([1, 0, 4], slopes, [50.0, 40.0, 1.0], high=0.5)
    assert "a" in keys
    assert shared == {}


def test_few_values_tell_no_two_parameters_apart():
    assert chosen([1, 0], [[9.0, 18.0]], [5.0])[1] == {}


@pytest.mark.parametrize("k", [1, 2, 3])
def test_never_more_than_k(k):
    assert len(chosen([0, 1, 2, 3], [[1.0, 2.0, 3.0, 4.0]], [9.0], k=k)[0]) == k


@pytest.mark.parametrize(("reach", "kept"), [(1.0, ["named"]), (0.1, ["named", "support"])])
def test_what_supports_the_words_moves_only_where_they_cannot_do_it_alone(reach, kept):
    plan = Plan({"named": entry(0.0), "support": entry(0.5)})
    here = Assessment(*map(doubles, ([-5.0], [0.0], [math.inf])), torch.tensor([0]), doubles(0.0), None)
    rest = torch.zeros(2, dtype=torch.float64)
    model = LinearModel(here, doubles([[9.0, 9.0]]), rest, torch.diag(rest), 1.0)
    parts = {"named": slice(0, 1), "support": slice(1, 2)}
    low, high = rest, doubles([reach, 1.0])
    assert sorted(needed(plan, model, parts, low, high)) == kept


def entry(prior):
    return PlanEntry((0.0,), (1.0,), 1, "because", prior)
