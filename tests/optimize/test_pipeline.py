# SPDX-License-Identifier: Apache-2.0
"""Algorithm 1 on a small real scene, with the real renderer, planner and embedded encoder."""

import pytest
import torch
from loop_parts import PROMPT, Silent, search_for
from tiny_job import write_job

from proxy_renderer.engine.report import changed_values, parameter_records
from proxy_renderer.guidance.guide import Weights, claims_loss
from proxy_renderer.optimize import objective as objectives
from proxy_renderer.optimize import pipeline
from proxy_renderer.optimize.least_squares import fixed_views
from proxy_renderer.optimize.shots import ShotInput
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import load_scene
from proxy_renderer.schema import VibeError
from proxy_renderer.schema.messages import Options
from proxy_renderer.words import parser


def vibe(scene, encoder, prompt=PROMPT, watch=None, **options):
    chosen = Options(**{"rounds": 2, "steps": 8, "size": 64, **options})
    return pipeline.run(search_for([ShotInput(scene)], prompt, chosen, encoder, watch or Silent()))


@pytest.fixture(scope="module")
def teal(scene, encoder):
    return vibe(scene, encoder)


def worth(outcome):
    """How far the result's picture is from what the words claim, and the loss of all that judges pictures."""
    shot = outcome.shots[0]
    with torch.no_grad():
        picture = shot.draw(outcome.u)
        residuals = shot.residuals(picture)
        missed = sum(float(r.square().sum()) for r in residuals)
        terms = shot.guidance(picture.display, picture.mask, fixed_views())
        claims = Weights().claims * claims_loss(residuals)
    return missed, float(sum(terms.values()) + claims)


@pytest.mark.parametrize("prompt", ["very dark, blue ball", "red ball, bright background, high contrast"])
def test_the_loss_falls_and_the_words_show_by_what_is_seen(scene, encoder, prompt, monkeypatch):
    """Ranges, projection and priors alone do not reach it: the same run with pictures that have no gradient is worse."""
    render = Proxy.render
    outcome = vibe(scene, encoder, prompt, rounds=1)
    monkeypatch.setattr(Proxy, "render", lambda self, values: render(self, {k: constant(v) for k, v in values.items()}))
    monkeypatch.setattr(objectives, "_PICTURES", 0)  # slopes come from backward passes through these
    (missed, loss), (blind_missed, blind_loss) = worth(outcome), worth(vibe(scene, encoder, prompt, rounds=1))
    assert missed < 0.6 * blind_missed
    assert loss < 0.97 * blind_loss


def constant(value):
    """The same value, with a gradient of zero."""
    return value.detach() + 0.0 * value


def test_every_value_is_within_its_range_and_has_a_reason(teal):
    for key, record in parameter_records(teal).items():
        rows = zip(
            *(x if isinstance(x, list) else [x] for x in (record["lower"], record["after"], record["upper"])),
            strict=True,
        )
        for low, value, high in rows:
            assert low - 1e-5 * abs(low) - 1e-9 <= value <= high + 1e-5 * abs(high) + 1e-9, key
        assert record["reason"], key
        assert not record["optimized"] or record["priority"] is not None, key


def test_no_round_optimizes_more_than_k(scene, encoder):
    outcome = vibe(scene, encoder, top_k=3, steps=2)
    assert all(len(r["parameters"]) <= 3 for r in outcome.rounds)


@pytest.mark.slow
def test_same_seed_same_values_bit_for_bit(scene, encoder, teal):
    again = vibe(scene, encoder)
    assert torch.equal(again.u, teal.u)
    assert again.rounds[0]["loss"] == teal.rounds[0]["loss"]
    assert not torch.equal(vibe(scene, encoder, seed=7).u, teal.u)


def test_locks_hold_exactly(scene, encoder):
    outcome = vibe(scene, encoder, lock=("material/Ball", "light"), steps=3)
    changed = changed_values(outcome)
    assert changed
    assert not [k for k in changed if k.startswith(("material/Ball/", "light/", "camera/"))]


def test_only_the_groups_that_were_named_change(scene, encoder):
    changed = changed_values(vibe(scene, encoder, groups=("film",), prompt="dark, high contrast, vignette", steps=3))
    assert changed
    assert {key.split("/")[0] for key in changed} == {"film"}


def test_what_no_word_names_stays_the_artists(scene, encoder):
    changed = changed_values(vibe(scene, encoder, prompt="vignette", steps=3))
    assert "film/vignette" in changed
    assert "material/Ball/base_color" not in changed


def test_no_fog_is_a_bound(tmp_path, encoder):
    foggy = load_scene(write_job(tmp_path, **{"volume/density": 0.2}))
    outcome = vibe(foggy, encoder, prompt="matte black ball, no fog", steps=2)
    density = outcome.vector.values(outcome.u)["volume/density"][0]
    assert density < 0.005


def test_the_watcher_can_end_it(scene, encoder):
    outcome = vibe(scene, encoder, watch=Silent(end=3), rounds=50, steps=50)
    assert outcome.stopped
    assert sum(r["steps"] for r in outcome.rounds) == 3
    assert changed_values(outcome)


def test_progress_counts_to_the_end(scene, encoder):
    watch = Silent()
    vibe(scene, encoder, watch=watch, rounds=1, steps=3)
    assert [(p.round, p.step) for p in watch.seen] == [(1, 1), (1, 2), (1, 3)]
    assert all(p.seconds_left >= 0 for p in watch.seen)


def test_a_prompt_in_which_nothing_is_known(scene, encoder):
    with pytest.raises(VibeError, match="xqzt") as caught:
        vibe(scene, encoder, prompt="xqzt wrrgl")
    assert caught.value.remedy


def test_everything_locked(scene, encoder):
    with pytest.raises(VibeError, match="may change"):
        vibe(scene, encoder, prompt="vignette", lock=("film",))


def test_a_prompt_is_read_once_however_many_rounds_there_are(scene, encoder, monkeypatch):
    read = []
    parse = parser.read
    monkeypatch.setattr(parser, "read", lambda *given, **more: read.append(given[0]) or parse(*given, **more))
    vibe(scene, encoder, rounds=2)
    assert read == [PROMPT]
