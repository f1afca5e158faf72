# SPDX-License-Identifier: Apache-2.0
"""Least squares in the box, on functions whose answers are known."""

import math

import pytest
import torch

from proxy_renderer.optimize.least_squares import Assessment, solve
from proxy_renderer.optimize.objective import backward_slopes, difference_slopes


def doubles(values):
    return torch.tensor(values, dtype=torch.float64)


class Claims:
    """Values that a function of u gives, what is wanted of them, and a rest."""

    claim_weight = 1.0

    def __init__(self, values, lower, upper, claim=None, rest=lambda u: u.sum() * 0, stride=None):
        self.values, self.rest, self.stride = values, rest, stride
        self.lower, self.upper = doubles(lower), doubles(upper)
        self.claim = torch.tensor(claim or range(len(lower)))
        self.slopes_taken, self.seen = 0, []

    def stiffness(self, chosen):
        return torch.zeros((int(chosen.sum()),) * 2, dtype=torch.float64)

    def assess(self, u):
        self.slopes_taken += u.requires_grad
        self.seen.append(u.detach().clone())
        return Assessment(self.values(u), self.lower, self.upper, self.claim, self.rest(u), None)

    def slopes(self, u, chosen):
        if self.stride is None:
            return backward_slopes(self.assess, u, chosen)
        return difference_slopes(self.assess, u, chosen, torch.full_like(u, self.stride))


def run(claims, start, low=0.0, high=1.0, chosen=None, steps=12, end=lambda step: False):
    u = doubles(start)
    chosen = torch.ones(len(u), dtype=torch.bool) if chosen is None else torch.tensor(chosen)
    lower, upper = (torch.as_tensor(x, dtype=torch.float64).expand(len(u)).clone() for x in (low, high))
    return solve(claims, u, chosen, lower, upper, steps, lambda step, loss, picture: end(step))


def curved(u):
    return torch.stack((20 * u[0] ** 2 + 5 * u[1], 10 * torch.sin(3 * u[1]) - 4 * u[0]))


def test_slopes_by_differences_lead_to_the_same_point_without_a_backward_pass():
    by_passes, by_differences = (Claims(curved, [9.0, 1.0], [10.0, 2.0], stride=s) for s in (None, 1e-4))
    found = [run(claims, [0.1, 0.9]) for claims in (by_passes, by_differences)]
    assert torch.allclose(found[0].u, found[1].u, atol=1e-3)
    assert by_differences.slopes_taken == 0 < by_passes.slopes_taken


def test_claims_that_can_hold_together_do():
    claims = Claims(curved, [9.0, 1.0], [10.0, 2.0])
    found = run(claims, [0.1, 0.9])
    values = curved(found.u)
    assert (values > doubles([8.0, 0.0])).all()
    assert (values < doubles([11.0, 3.0])).all()
    assert found.loss < 0.05 * found.start_loss


def test_slopes_are_taken_a_few_times_only():
    claims = Claims(curved, [9.0, 1.0], [10.0, 2.0])
    found = run(claims, [0.1, 0.9])
    assert claims.slopes_taken <= 3
    assert len(claims.seen) == claims.slopes_taken + found.steps


def test_what_holds_already_is_left_alone():
    found = run(Claims(curved, [0.0, 0.0], [50.0, 50.0]), [0.5, 0.5])
    assert found.u.tolist() == [0.5, 0.5]
    assert found.steps == 0


def test_the_shortest_way_to_a_claim_is_taken():
    """Only the first component matters much to the claim: the second one has no reason to move far."""
    found = run(Claims(lambda u: (30 * u[0] + 3 * u[1])[None], [15.0], [math.inf]), [0.2, 0.2])
    assert found.u[0] > 0.4
    assert found.u[1] < 0.3


def test_a_claim_that_cannot_hold_does_not_rule_the_others():
    claims = Claims(lambda u: torch.stack((20 * u[0], 20 * u[1])), [400.0, 5.0], [500.0, 6.0])
    found = run(claims, [0.9, 0.9])
    assert 20 * found.u[1] == pytest.approx(5.5, abs=1.6)
    assert found.u[0] == 1.0


def test_the_box_and_what_may_move_are_kept():
    claims = Claims(lambda u: 50 * u, [40.0, 40.0], [45.0, 45.0])
    found = run(claims, [0.3, 0.3], low=[0.2, 0.2], high=[0.5, 0.9], chosen=[True, False])
    assert found.u.tolist() == [0.5, pytest.approx(0.3)]
    seen = torch.stack(claims.seen)
    assert (seen >= doubles([0.2, 0.3]) - 1e-9).all()
    assert (seen <= doubles([0.5, 0.3]) + 1e-9).all()


def test_the_rest_is_followed_where_claims_hold():
    claims = Claims(lambda u: 10 * u[:1], [-1.0], [5.0], rest=lambda u: 4 * (u - 0.3).square().sum())
    found = run(claims, [0.1, 0.9], steps=30)
    torch.testing.assert_close(found.u, doubles([0.3, 0.3]), atol=0.1, rtol=0)


def test_components_of_one_claim_are_one_distance():
    near = Claims(lambda u: 10 * u, [5.0, 5.0], [5.0, 5.0], claim=[0, 0])
    missed = near.assess(doubles([0.2, 0.1])).misses(doubles([2.0, 1.0]))
    assert missed.tolist() == [pytest.approx(5.0)]


def test_what_is_not_finite_is_not_taken():
    def broken(u):
        return torch.where(u[:1] > 0.5, math.nan, 10 * u[:1])

    found = run(Claims(broken, [9.0], [10.0]), [0.3, 0.3])
    assert found.repairs > 0
    assert math.isfinite(found.loss)
    assert found.u[0] <= 0.5


def test_a_start_that_is_not_finite_comes_back_as_it_was():
    found = run(Claims(lambda u: u[:1] * math.nan, [9.0], [10.0]), [0.3, 0.3])
    assert found.u.tolist() == [0.3, 0.3]
    assert found.repairs == 1


def test_it_ends_when_it_is_told_to():
    assert run(Claims(curved, [9.0, 1.0], [10.0, 2.0]), [0.1, 0.9], end=lambda step: step == 1).steps == 1
