# SPDX-License-Identifier: Apache-2.0
"""Slopes by pictures beside are those of backward passes, where nothing moves, and leave no trace."""

import pytest
import torch
from loop_parts import Silent, search_for

from proxy_renderer.optimize import objective as objectives
from proxy_renderer.optimize.objective import backward_slopes, forward_slopes, gradients, pictures_for
from proxy_renderer.optimize.rounds.confiner import RoundStart
from proxy_renderer.optimize.shots import ShotInput
from proxy_renderer.schema.messages import Options

PROMPT = "glossy deep red ball, warm soft light from the left, thin fog, vignette, high contrast"


@pytest.fixture(scope="module")
def begun(scene, encoder):
    """A round's objective, and where it begins."""
    search = search_for([ShotInput(scene)], PROMPT, Options(rounds=1, size=48), encoder, Silent(), None)
    home = search.vector.encode({})
    now = search.confine(RoundStart(home, search.shots))
    return search.select(now, now.u).objective, now


def both(begun, keys):
    """Slopes over these keys' components, forward and backward."""
    objective, now = begun
    chosen = objective.vector.mark(keys) & (now.upper > now.lower)
    box = now.lower, now.upper
    forward = forward_slopes(objective.seen, objective.judge, now.u, chosen, box)
    return forward, backward_slopes(objective.assess, now.u, chosen), (now.upper - now.lower)[chosen]


def stands(key):
    """Whether a key moves neither lights nor camera."""
    return key.split("/")[-1] not in ("size", "angle", "azimuth", "elevation", "distance", "rotation", "ior")


def test_each_parameter_has_the_slopes_that_a_backward_pass_gives(begun):
    keys = {key for key in begun[0].free if stands(key)}
    assert len(keys) > 10
    forward, backward, span = both(begun, keys)
    torch.testing.assert_close(forward.here.values, backward.here.values, atol=1e-3, rtol=1e-4)
    ours, theirs = forward.values * span, backward.values * span
    assert (theirs.norm(dim=0) > 0.1).sum() > 10
    off = (ours - theirs).norm(dim=0)
    assert (off < 0.05 * theirs.norm(dim=0) + 0.05).all()
    assert (forward.rest - backward.rest).norm() < 0.1 * backward.rest.norm()


def test_backward_passes_together_give_what_they_give_one_by_one(begun, monkeypatch):
    objective, now = begun
    chosen = objective.vector.mark({key for key in objective.free if stands(key)}) & (now.upper > now.lower)
    compared = []

    def twice(*given, together):
        found = gradients(*given, together=False)
        for one_by_one, other in zip(found, gradients(*given, together=True), strict=True):
            torch.testing.assert_close(other, one_by_one, atol=1e-5, rtol=1e-3)
            compared.append(len(other))
        return found

    monkeypatch.setattr(objectives, "gradients", twice)
    forward_slopes(objective.seen, objective.judge, now.u, chosen, (now.lower, now.upper))
    assert len(compared) > 1
    assert min(compared) > 2


def test_a_light_that_moves_leaves_nothing_behind(begun):
    objective, now = begun
    with torch.no_grad():
        before = objective.seen[0].draw(now.u, objective.free).linear
    moving = {key for key in objective.free if not stands(key)}
    assert moving
    forward, *_ = both(begun, moving)
    assert (forward.values != 0).any()
    with torch.no_grad():
        assert torch.equal(objective.seen[0].draw(now.u, objective.free).linear, before)


def test_the_cheaper_way_is_taken(begun, monkeypatch):
    objective, now = begun
    chosen = objective.vector.mark(objective.free) & (now.upper > now.lower)
    ways = []

    def noted(way, take):
        return lambda *arguments: ways.append(way) or take(*arguments)

    monkeypatch.setattr(objectives, "forward_slopes", noted("forward", objectives.forward_slopes))
    monkeypatch.setattr(objectives, "backward_slopes", noted("backward", objectives.backward_slopes))
    objective.slopes(now.u, chosen)
    monkeypatch.setattr(objectives, "_PICTURES", 0)
    objective.slopes(now.u, chosen)
    assert ways == ["forward", "backward"]


def test_the_film_needs_no_pictures(begun):
    film = {key for key in begun[0].free if key.startswith("film/")}
    assert film
    assert pictures_for(begun[0].seen, film) == 0


def test_what_supports_the_words_is_not_moved_for_a_finish(begun):
    objective, now = begun
    chosen = objective.vector.mark(objective.free) & (now.upper > now.lower)
    supports = objective._supports[chosen]
    free = forward_slopes(objective.seen, objective.judge, now.u, chosen, (now.lower, now.upper))
    held = objective.slopes(now.u, chosen)
    rows = held.here.finish[:, None] & supports
    assert rows.any()
    assert not held.values[rows].any()
    assert torch.allclose(held.values[~rows], free.values[~rows])
