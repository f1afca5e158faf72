# SPDX-License-Identifier: Apache-2.0
"""Pictures right beside a point are those of whole renders, and few are rendered."""

import pytest
import torch
from loop_parts import Silent, search_for

from proxy_renderer.optimize.objective import difference_slopes, neighbors
from proxy_renderer.optimize.rounds.confiner import RoundStart
from proxy_renderer.optimize.shots import ShotInput
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.schema.messages import Options

PROMPT = "glossy deep red ball, warm soft light from the left, thin fog, vignette, high contrast"
TRACED = ("size", "angle", "azimuth", "elevation", "distance", "rotation", "ior", "metallic")
"""What rays are traced anew for."""


@pytest.fixture(scope="module")
def begun(scene, encoder):
    """A round's objective, and where it begins."""
    search = search_for([ShotInput(scene)], PROMPT, Options(rounds=1, size=48), encoder, Silent(), None)
    home = search.vector.encode({})
    now = search.confine(RoundStart(home, search.shots))
    return search.select(now, now.u).objective, now.u


@pytest.fixture
def exposed(monkeypatch):
    """The pictures that are rendered, up to the film."""
    taken, expose = [], Proxy.expose
    monkeypatch.setattr(Proxy, "expose", lambda *given: taken.append(1) or expose(*given))
    return taken


def stands(key):
    return not key.startswith("camera/") and key.split("/")[-1] not in TRACED


def nearby(objective, u, strides):
    return neighbors(objective.seen, objective.judge, u, strides)


@torch.no_grad()
def test_slopes_are_those_of_whole_pictures(begun):
    objective, u = begun
    chosen, strides = objective.vector.mark(filter(stands, objective.free)), torch.full_like(u, 0.01)
    ours = difference_slopes(nearby(objective, u, strides), u, chosen, strides)
    whole = difference_slopes(objective.assess, u, chosen, strides)
    assert (whole.values.norm(dim=0) > 0.1).sum() > 10
    torch.testing.assert_close(ours.values, whole.values, atol=0.05, rtol=0.01)
    torch.testing.assert_close(ours.rest, whole.rest, atol=0.05, rtol=0.01)


@torch.no_grad()
@pytest.mark.parametrize(("kind", "pictures"), [("light/color", 1), ("film/gain", 0)])
def test_a_color_takes_one_picture_and_the_film_none(begun, exposed, kind, pictures):
    objective, u = begun
    vector, strides = objective.vector, torch.full_like(u, -0.01)
    key = next(key for key, i in vector.instances.items() if i.parameter.family == kind)
    beside = nearby(objective, u, strides)
    exposed.clear()
    difference_slopes(beside, u, vector.mark([key]), strides)
    assert len(exposed) == pictures


@torch.no_grad()
def test_a_light_that_moves_changes_its_shadows_and_leaves_nothing_behind(begun):
    objective, u = begun
    vector, strides = objective.vector, torch.full_like(u, 0.01)
    before = objective.seen[0].draw(u, objective.free).linear.clone()
    key = next(key for key, i in vector.instances.items() if i.parameter.family == "light/azimuth")
    beside = nearby(objective, u, strides)
    moved = beside(u + strides * vector.mark([key])).picture.linear
    assert (moved - before).abs().max() > 1e-3
    objective.seen[0]._last = None
    assert torch.equal(objective.seen[0].draw(u, objective.free).linear, before)
