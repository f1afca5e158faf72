# SPDX-License-Identifier: Apache-2.0
"""What the words claim steers the loop: its gradients, when it ends, and which round is the result."""

from dataclasses import replace

import pytest
import torch
from loop_parts import PROMPT, Silent, search_for
from tiny_job import write_job

from proxy_renderer.claims.from_goals import claims_of
from proxy_renderer.engine.report import claims_about, foreseen
from proxy_renderer.optimize import pipeline, stage
from proxy_renderer.optimize.least_squares import fixed_views
from proxy_renderer.optimize.pipeline import refine
from proxy_renderer.optimize.rounds.confiner import RoundStart
from proxy_renderer.optimize.rounds.search import Missed, Search
from proxy_renderer.optimize.shots import ShotInput
from proxy_renderer.scene import load_scene
from proxy_renderer.schema.messages import Options

_DENSE = 0.97
"""Share of light that the air takes away, which the ranges of "thick fog" do not make."""


@pytest.fixture
def search(scene, encoder):
    def begin(prompt, **options):
        chosen = Options(**{"rounds": 2, "steps": 4, "size": 48, **options})
        return search_for([ShotInput(scene)], prompt, chosen, encoder, Silent(), None)

    return begin


def confined(search):
    home = search.vector.encode({})
    return search.confine(RoundStart(home, search.shots)), home


def refined(search):
    return refine(search, RoundStart(search.vector.encode({}), search.shots))


def test_rounds_end_when_the_picture_shows_all_that_the_words_claim(search):
    begun = search("very dark", rounds=6)
    outcome = refined(begun)
    assert outcome.rounds[-1]["missed"]["claims"] == 0
    assert len(outcome.rounds) < 6


def test_the_best_round_is_the_result_and_others_are_not_waited_for_long(search, monkeypatch):
    begun = search(PROMPT, rounds=5, steps=2)
    ends = []

    def seen(self, shots, u, number):
        ends.append(u.clone())
        return shots, Missed(float(len(ends)), 1)  # each round is farther from the words than the one before

    monkeypatch.setattr(Search, "seen", seen)
    monkeypatch.setattr(pipeline, "CONVERGED", -1.0)
    outcome = refined(begun)
    assert torch.equal(outcome.u, ends[0])
    assert len(outcome.rounds) == 1 + pipeline.PATIENCE


def test_a_round_that_comes_hardly_nearer_is_the_last(search, monkeypatch):
    begun = search(PROMPT, rounds=5, steps=2)
    misses = iter([Missed(4.0, 2), Missed(3.9, 1), Missed(3.0, 1), Missed(2.95, 1)])
    monkeypatch.setattr(Search, "seen", lambda self, shots, u, number: (shots, next(misses)))
    monkeypatch.setattr(pipeline, "CONVERGED", -1.0)
    monkeypatch.setattr(pipeline, "eased", lambda *given: None)
    outcome = refined(begun)
    # the second satisfied another claim, the third came much nearer
    assert [record["missed"]["distance"] for record in outcome.rounds] == [4.0, 3.9, 3.0, 2.95]


@pytest.mark.parametrize(("prompt", "gray"), [("low contrast", True), ("teal shadows", False)])
def test_the_darks_of_a_picture_are_lifted_and_not_tinted(search, prompt, gray):
    begun = search(prompt)
    now, home = confined(begun)
    stiff = begun.select(now, home).objective.stiffness(begun.vector.mark(["film/lift"])).double()
    tinted, even = torch.tensor([0.0, 1.0, 0.0]).double(), torch.ones(3).double()
    assert even @ stiff @ even < 1.0
    assert bool(tinted @ stiff @ tinted > 10.0) == gray


def test_words_that_claim_nothing_do_not_end_the_rounds_early(search):
    begun = search("vhs", rounds=2, steps=2)
    now, _ = confined(begun)
    assert not pipeline.claims_words(now.shots)
    assert not pipeline.claims_words(search("dark").shots)  # before the artist's picture was seen


def test_a_missed_claim_pulls_the_picture_towards_it(search):
    begun = search("very bright picture")
    now, home = confined(begun)
    objective = begun.select(now, home).objective
    u = home.clone().requires_grad_()
    residuals = now.shots[0].residuals(objective.seen[0].draw(u, objective.free))
    worst = max(residuals, key=lambda r: float(r.detach().norm()))
    worst.square().sum().backward()
    step = home - 0.05 * u.grad / u.grad.norm()
    nearer = now.shots[0].residuals(objective.seen[0].draw(step, objective.free))
    assert torch.cat(nearer).norm() < torch.cat(residuals).norm()


def test_what_holds_values_and_hues_is_foreseen_exactly(search):
    """The model of least squares knows what it costs to move a color's components apart, though its slope is 0 at first."""
    begun = search("titanium ball")
    now, home = confined(begun)
    objective = begun.select(now, home).objective
    dice = torch.Generator().manual_seed(0)
    span = (now.upper - now.lower).clamp_min(1e-9)
    where = home.clone().requires_grad_()
    (slope,) = torch.autograd.grad(objective.held(where), where)
    apart = torch.rand(len(home), generator=dice, dtype=torch.float64) * (now.upper > now.lower)
    foreseen = (
        slope @ (span * apart) + 0.5 * apart @ objective.stiffness(torch.ones_like(apart, dtype=torch.bool)) @ apart
    )
    torch.testing.assert_close(objective.held(home + span * apart) - objective.held(home), foreseen)
    assert float(foreseen) > 0.1


def test_a_round_that_made_it_worse_is_taken_back_first_with_narrower_ranges_then_half_as_far(search, monkeypatch):
    begun = search(PROMPT, rounds=4, steps=2)
    began, ends = [], []
    confine = Search.confine

    def confined_at(self, here):
        began.append((here.u.clone(), here.share, here.opening))
        return confine(self, here)

    def seen(self, shots, u, number):
        ends.append(u.clone())
        return shots, Missed(float(len(ends)), 1)

    monkeypatch.setattr(Search, "confine", confined_at)
    monkeypatch.setattr(Search, "seen", seen)
    monkeypatch.setattr(pipeline, "CONVERGED", -1.0)
    monkeypatch.setattr(pipeline, "PATIENCE", 9)
    refined(begun)
    assert [share for _, share, _ in began] == [1.0, 1.0, 1.0, 0.5]
    assert [opening for _, _, opening in began] == [0.0, 0.5, 0.0, 0.5]  # a claim is missed all the time
    assert torch.equal(began[2][0], ends[0])
    assert torch.equal(began[3][0], ends[0])


@pytest.mark.slow
def test_a_claim_out_of_reach_of_its_words_ranges_is_earned_in_wider_ones(search, monkeypatch):
    def demanding(*told):
        """Air that is denser than the words' ranges make it."""
        return tuple(replace(c, lower=(_DENSE,), change=None) if c.measure == "haze" else c for c in claims_of(*told))

    monkeypatch.setattr(stage, "claims_of", demanding)
    begun = search("thick fog", steps=12, rounds=4, size=64)
    outcome = refined(begun)
    first, *wider = (record["missed"] for record in outcome.rounds)
    assert first["claims"] > 0
    assert min(missed["claims"] for missed in wider) < first["claims"]
    assert min(missed["distance"] for missed in wider) < 0.95 * first["distance"]
    for key, values in outcome.vector.values(outcome.u).items():
        instance, (low, high) = outcome.vector.instances[key], outcome.ranges[key]
        for a, v, b in zip(low, values, high, strict=True):
            assert a - 1e-5 * (1 + abs(a)) <= v <= b + 1e-5 * (1 + abs(b))
        assert all(a <= v <= b for a, v, b in zip(instance.lower, values, instance.upper, strict=True))


@pytest.mark.parametrize("gray", [0.03, 0.8])
def test_a_vignette_is_earned_on_dark_and_on_light_ground(tmp_path, encoder, gray):
    """Its range is the same on both; how dark corners are is for the claim to see."""
    scene = load_scene(write_job(tmp_path / "job", **{"material/Floor/base_color": (gray,) * 3}))
    chosen = Options(rounds=2, steps=4, size=64)
    begun = search_for([ShotInput(scene)], "vignette", chosen, encoder, Silent(), None)
    outcome = refined(begun)
    (claim,) = (row for row in foreseen(outcome, claims_about(outcome)) if row["measure"] == "vignette")
    assert claim["holds"]
    assert claim["after"] > claim["before"] + 4.0


def test_a_subject_that_words_make_like_its_ground_is_told_apart(tmp_path, encoder):
    scene = load_scene(write_job(tmp_path / "job", **{"material/Floor/base_color": (0.75,) * 3}))
    chosen = Options(rounds=3, steps=6, size=64)
    begun = search_for([ShotInput(scene)], "white ball", chosen, encoder, Silent(), None)
    outcome = refined(begun)
    rows = {row["measure"]: row for row in foreseen(outcome, claims_about(outcome))}
    assert rows["color"]["holds"]
    assert rows["separation"]["holds"]


def test_the_inner_loop_earns_a_claim_that_does_not_hold_yet(search):
    begun = search("very bright picture", steps=12, rounds=1)
    now, _ = confined(begun)
    darker = replace(now, u=(now.u + now.lower) / 2)
    _, before = begun.seen(now.shots, darker.u, 0)
    assert before.claims > 0
    found = begun.descend(darker, begun.select(darker, darker.u))
    assert found.loss < found.start_loss
    assert begun.seen(now.shots, found.u, 0)[1] < before


def test_what_a_model_says_in_a_later_round_reaches_the_loss(search):
    begun = search(PROMPT)
    now, _ = confined(begun)
    (shot,) = now.shots
    first, claims = shot.guidance, shot.claims.claims
    again = replace(RoundStart(now.u, now.shots), earlier=now.plan)
    assert begun.confine(again).shots[0].guidance is first  # the same words
    advisor = begun.confiner.advisor

    class Model:
        def advise(self, display, instances, known):
            advice = advisor.advise(display, instances, known)
            return replace(advice, unmeasured=replace(advice.prompts, subject="a rusty ball", whole="rust"))

    begun.confiner.advisor = Model()
    (shot,) = begun.confine(again).shots
    picture = shot.draw(now.u)
    before, after = (judge(picture.display, picture.mask, fixed_views()) for judge in (first, shot.guidance))
    assert not before  # measures cover the artist's words
    assert float(after["subject"]) > 0.0
    assert shot.claims.claims == claims  # of the artist's words, whatever the model makes of them
