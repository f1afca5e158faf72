# SPDX-License-Identifier: Apache-2.0
"""What the words claim steers the loop: its gradients, when it ends, and which round is the result."""

import pytest
import torch
from loop_parts import PROMPT, Silent

from proxy_renderer.optimize import pipeline
from proxy_renderer.optimize.search import Missed, Search, Start
from proxy_renderer.optimize.shots import ShotInput
from proxy_renderer.prompt.types import Plan
from proxy_renderer.schema.messages import Options


@pytest.fixture
def search(scene, encoder):
    def begin(prompt, **options):
        chosen = Options(**{"rounds": 2, "steps": 4, "size": 48, **options})
        return Search([ShotInput(scene)], prompt, chosen, encoder, encoder, Silent(), None)

    return begin


def confined(search):
    home = search.vector.encode({})
    return search.confine(home, Plan(), Start(home)), home


def test_rounds_end_when_the_picture_shows_all_that_the_words_claim(search):
    begun = search("very dark", rounds=6)
    outcome = pipeline.refine(begun, Start(begun.vector.encode({})))
    assert outcome.rounds[-1]["missed"]["claims"] == 0
    assert len(outcome.rounds) < 6


def test_the_best_round_is_the_result_and_others_are_not_waited_for_long(search, monkeypatch):
    begun = search(PROMPT, rounds=6, steps=2)
    ends = []

    def missed(self, u):
        ends.append(u.clone())
        return Missed(1, float(len(ends)))  # each round is farther from the words than the one before

    monkeypatch.setattr(Search, "missed", missed)
    outcome = pipeline.refine(begun, Start(begun.vector.encode({})))
    assert torch.equal(outcome.u, ends[0])
    assert len(outcome.rounds) == 1 + pipeline.PATIENCE


def test_words_that_claim_nothing_do_not_end_the_rounds_early(search):
    begun = search("fluorescent light", rounds=2, steps=2)
    confined(begun)
    assert not begun.claims_words
    assert search("dark").claims_words is False  # before the artist's picture was seen


def test_a_missed_claim_pulls_the_picture_towards_it(search):
    begun = search("very bright picture")
    now, home = confined(begun)
    _, objective = begun.objective(now, home)
    u = home.clone().requires_grad_()
    residuals = begun.shots[0].residuals(objective.render(u, 0))
    worst = max(residuals, key=lambda r: float(r.detach().norm()))
    worst.square().sum().backward()
    step = home - 0.05 * u.grad / u.grad.norm()
    nearer = begun.shots[0].residuals(objective.render(step, 0))
    assert torch.cat(nearer).norm() < torch.cat(residuals).norm()


def test_the_baseline_is_judged_by_no_claim(search):
    begun = search("dark", baseline="clip-only")
    confined(begun)
    assert begun.shots[0].claims is None
    assert begun.missed(begun.vector.encode({})) == Missed(0, 0.0)
