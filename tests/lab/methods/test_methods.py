# SPDX-License-Identifier: Apache-2.0
"""Each method of the laboratory, on a small real scene."""

from dataclasses import replace

import pytest
import torch
from loop_parts import PROMPT, Silent, search_for
from tiny_job import write_job

from lab.methods import METHODS, RATE, Variation
from lab.methods.adam import Adam
from lab.methods.clip import ClipAuthors, ClipOnly, GlobalGuidance
from lab.methods.parts import BareRig, Middle, Projection, WithoutClaims, WithoutEncoder
from proxy_renderer.engine.report import changed_values
from proxy_renderer.guidance.encoder import Encoder, load_encoder
from proxy_renderer.optimize import pipeline
from proxy_renderer.optimize.rounds import selection
from proxy_renderer.optimize.rounds.confiner import RoundStart
from proxy_renderer.optimize.rounds.method import VARIABLE, Method, load_method
from proxy_renderer.optimize.rounds.search import Missed
from proxy_renderer.optimize.shots import ShotInput
from proxy_renderer.optimize.stage import set_stage
from proxy_renderer.scene import load_scene
from proxy_renderer.schema.messages import Options, Progress


@pytest.fixture(scope="module")
def encoder():
    return load_encoder(None, "cpu")


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    return load_scene(write_job(tmp_path_factory.mktemp("job")))


@pytest.fixture
def vibe(scene, encoder):
    def run(method, watch=None, **options):
        chosen = Options(**{"rounds": 2, "steps": 8, "size": 64, **options})
        return pipeline.run(search_for([ShotInput(scene)], PROMPT, chosen, encoder, watch or Silent(), method=method))

    return run


@pytest.fixture
def search(scene, encoder):
    def begin(prompt, method=None, **options):
        chosen = Options(**{"rounds": 2, "steps": 4, "size": 48, **options})
        return search_for([ShotInput(scene)], prompt, chosen, encoder, Silent(), None, method=method)

    return begin


def confined(search):
    home = search.vector.encode({})
    return search.confine(RoundStart(home, search.shots)), home


@pytest.mark.parametrize("name", METHODS)
def test_each_is_a_plug_in_that_an_engine_finds(name, monkeypatch):
    monkeypatch.setattr(selection, "ALIKE", selection.ALIKE)
    for variable, value in Variation(name).environment.items():
        monkeypatch.setenv(variable, value)
    assert isinstance(load_method(), Method)
    assert (type(load_method()) is Method) == (not name)
    assert (VARIABLE in Variation(name).environment) == bool(name)


def test_adam_earns_a_claim_that_is_not_satisfied_yet(search):
    begun = search("very bright picture", Adam(), steps=12, rounds=1)
    now, _ = confined(begun)
    darker = replace(now, u=(now.u + now.lower) / 2)
    _, before = begun.seen(now.shots, darker.u, 0)
    assert before.claims > 0
    found = begun.descend(darker, begun.select(darker, darker.u))
    assert found.loss < found.start_loss
    assert begun.seen(now.shots, found.u, 0)[1] < before


@pytest.mark.slow
def test_the_baseline_uses_everything_without_a_plan(vibe):
    outcome = vibe(ClipOnly(), rounds=1, camera=True)
    assert len(outcome.optimized) > 40
    assert {"camera/azimuth", "film/hue", "volume/density"} <= outcome.optimized
    start, end = outcome.rounds[0]["loss"]
    assert end < start


def test_the_authors_baseline_leaves_camera_and_fog_alone(vibe):
    outcome = vibe(ClipAuthors(), rounds=1, camera=True)
    assert len(outcome.optimized) > 30
    assert not [k for k in {*outcome.optimized, *changed_values(outcome)} if k.startswith(("camera", "volume"))]


@pytest.mark.slow
def test_a_baseline_takes_all_its_steps_though_they_bring_nothing(vibe, monkeypatch):
    monkeypatch.setattr(
        GlobalGuidance, "__call__", lambda self, display, mask, generator: {"whole": 0.0 * display.mean()}
    )
    watch = Silent()
    vibe(ClipOnly(), watch, rounds=1, steps=24, size=32)
    assert [p.step for p in watch.seen if isinstance(p, Progress)] == list(range(1, 25))


def test_no_step_of_a_baseline_is_greater_than_its_rate(vibe, monkeypatch):
    monkeypatch.setenv(RATE, "3")
    outcome = vibe(ClipOnly(), rounds=1, steps=4)
    vector = outcome.vector
    lower, upper = vector.bounds({k: (i.lower, i.upper) for k, i in vector.instances.items()})
    moved = (outcome.u - vector.encode({})).abs() / (upper - lower).clamp_min(1e-9)
    assert 0.002 < float(moved.max()) <= 4 * 0.003 + 1e-6


def test_the_baseline_is_judged_by_no_claim(search):
    begun = search("dark", ClipOnly())
    now, home = confined(begun)
    assert not now.shots[0].claims.claims
    assert begun.seen(now.shots, home, 0)[1] == Missed(0.0, 0)


def test_without_an_inner_loop_values_are_the_nearest_that_the_words_allow(search):
    begun = search(PROMPT, Projection())
    now, _ = confined(begun)
    assert torch.equal(begun.descend(now, begun.select(now, now.u)).u, now.u)
    middle = search(PROMPT, Middle())
    now, _ = confined(middle)
    chosen = middle.select(now, now.u)
    found = middle.descend(now, chosen).u
    marked = middle.vector.mark(chosen.keys) & (now.upper > now.lower)
    torch.testing.assert_close(found[marked], ((now.lower + now.upper) / 2)[marked])
    assert torch.equal(found[~marked], now.u[~marked])


def test_the_papers_loop_asks_for_the_raw_text(search, monkeypatch):
    asked = []
    encode = Encoder.encode_texts
    monkeypatch.setattr(Encoder, "encode_texts", lambda self, texts: asked.extend(texts) or encode(self, texts))
    confined(search(PROMPT, Adam()))
    assert PROMPT in asked
    asked.clear()
    confined(search(PROMPT))
    assert PROMPT not in asked


def test_what_is_left_out_is_not_in_the_loss(search):
    begun = search("very bright picture", WithoutClaims())
    now, home = confined(begun)
    objective = begun.select(now, home).objective
    terms = objective.account(home)["terms"]
    assert "claims" not in terms
    assert terms["whole"] != 0.0
    assert terms["attributes"] > 0.0
    begun = search("very bright picture", WithoutEncoder())
    now, home = confined(begun)
    terms = begun.select(now, home).objective.account(home)["terms"]
    assert "claims" in terms
    assert all(terms.get(name, 0.0) == 0.0 for name in ("whole", "direction", "attributes"))


@pytest.mark.parametrize("prompt", ["candlelight, the ball is gold", "a gold ball"])
def test_the_bare_rig_moves_lights_and_no_surface(scene, encoder, prompt):
    stage = set_stage([scene], prompt)
    views = [ShotInput(each) for each in stage.scenes]
    options = Options(rounds=2, size=48)
    outcome = pipeline.run(search_for(views, prompt, options, encoder, Silent(), stage=stage, method=BareRig()))
    changed = changed_values(outcome)
    assert not [key for key in changed if key.startswith("material/")]
    assert any(key.startswith(("light/", "world/")) for key in changed) == ("candlelight" in prompt)
