# SPDX-License-Identifier: Apache-2.0
"""The inner loop on functions whose answers are known: convergence, the box, repair, reproducibility."""

import math

import pytest
import torch

from lab.methods.adam import StepSettings, descend


class Bowl:
    """Distance to a target, with noise from the views; not finite where `broken` says so."""

    shots = 1

    def __init__(self, target, noise=0.0, broken=lambda u: False):
        self.target, self.noise, self.broken = torch.tensor(target, dtype=torch.float64), noise, broken
        self.seen = []

    def render(self, u, shot):
        self.seen.append(u.detach().clone())
        return u * math.nan if self.broken(u) else u

    def loss(self, picture, u, generator, shot):
        shake = self.noise * torch.randn(len(u), generator=generator, dtype=torch.float64)
        return (picture - self.target + shake).square().sum()


def run(bowl, start, lower, upper, chosen=None, steps=40, seed=0, end=lambda step: False):
    u, low, high = (torch.tensor(x, dtype=torch.float64) for x in (start, lower, upper))
    chosen = torch.ones(len(u), dtype=torch.bool) if chosen is None else torch.tensor(chosen)
    return descend(bowl, u, chosen, low, high, steps, seed, StepSettings(), lambda step, loss, picture: end(step))


def test_it_finds_the_nearest_feasible_point():
    found = run(Bowl([0.3, 0.9]), [0.5, 0.2], [0.0, 0.0], [1.0, 0.6])
    torch.testing.assert_close(found.u, torch.tensor([0.3, 0.6], dtype=torch.float64), atol=0.03, rtol=0)
    assert found.loss < found.start_loss


def test_no_point_that_is_looked_at_leaves_the_box():
    bowl = Bowl([5.0, -5.0], noise=1.0)
    run(bowl, [0.5, 0.5], [0.2, 0.4], [0.6, 0.9])
    seen = torch.stack(bowl.seen)
    assert (seen >= torch.tensor([0.2, 0.4]) - 1e-6).all()
    assert (seen <= torch.tensor([0.6, 0.9]) + 1e-6).all()


def test_a_step_is_a_share_of_the_range():
    bowl = Bowl([1.0, 1.0])
    run(bowl, [0.0, 0.0], [0.0, 0.0], [1.0, 0.01], steps=3)
    moved = bowl.seen[2]
    assert moved[0].item() == pytest.approx(100 * moved[1].item(), rel=0.05)


def test_only_the_chosen_move():
    found = run(Bowl([1.0, 1.0]), [0.2, 0.2], [0.0, 0.0], [1.0, 1.0], chosen=[True, False])
    assert found.u[0] > 0.8
    assert found.u[1] == 0.2


def test_what_is_not_finite_is_rolled_back():
    found = run(Bowl([1.0], broken=lambda u: bool(u[0] > 0.5)), [0.3], [0.0], [1.0])
    assert found.repairs > 0
    assert 0.3 < found.u[0] <= 0.5
    assert math.isfinite(found.loss)


def test_a_start_that_is_not_finite_comes_back_as_it_was():
    found = run(Bowl([1.0], broken=lambda u: True), [0.3], [0.0], [1.0])
    assert found.u.tolist() == [0.3]
    assert found.steps <= StepSettings().repairs + 1


def test_the_best_is_judged_on_fixed_views():
    bowl = Bowl([0.5] * 4, noise=0.5)
    found = run(bowl, [0.1] * 4, [0.0] * 4, [1.0] * 4)
    fixed = torch.Generator().manual_seed(12345)
    assert float(bowl.loss(found.u, found.u, fixed, 0)) == found.loss
    assert found.loss <= found.start_loss


def test_same_seed_same_result_bit_for_bit():
    first, again, other = (run(Bowl([0.7] * 3, 0.3), [0.2] * 3, [0.0] * 3, [1.0] * 3, seed=s) for s in (4, 4, 5))
    assert torch.equal(first.u, again.u)
    assert not torch.equal(first.u, other.u)


def test_it_ends_when_told_and_when_nothing_improves():
    assert run(Bowl([0.9]), [0.1], [0.0], [1.0], end=lambda step: step == 3).steps == 3
    assert run(Bowl([0.5]), [0.5], [0.0], [1.0], steps=200).steps < 60


class Bowls(Bowl):
    """Two shots of one u, each with a target of its own."""

    shots = 2

    def loss(self, picture, u, generator, shot):
        return (picture - self.target[shot]).square().sum()


def test_shots_meet_in_the_middle_and_are_judged_together():
    bowls = Bowls([[0.2], [0.6]])
    found = run(bowls, [0.9], [0.0], [1.0], steps=80)
    assert found.u.item() == pytest.approx(0.4, abs=0.05)
    assert found.loss == pytest.approx(0.04, abs=0.005)  # the mean of both
