# SPDX-License-Identifier: Apache-2.0
"""What only supports the words ends as near to the artist's values as the words allow."""

import pytest
import torch
from loop_parts import Silent, search_for
from tiny_job import write_job

from proxy_renderer.optimize import pipeline
from proxy_renderer.optimize.pipeline import eased, refine
from proxy_renderer.optimize.rounds.confiner import RoundStart
from proxy_renderer.optimize.shots import ShotInput
from proxy_renderer.scene import load_scene
from proxy_renderer.schema.messages import Options


def begun(scene, encoder, prompt, **options):
    search = search_for(
        [ShotInput(scene)], prompt, Options(**{"rounds": 3, "steps": 6, "size": 64, **options}), encoder, Silent(), None
    )
    return search, search.vector.encode({})


def supports(search, plan):
    return search.vector.mark(key for key, e in plan.items() if e.priority is not None and e.prior > 0.0)


@pytest.mark.parametrize(("red", "exposure"), [(0.6, 0.7), (0.85, -1.4)])
def test_light_that_nobody_asked_for_goes_back_whole(scene, encoder, red, exposure):
    search, home = begun(scene, encoder, "red ball")
    now = search.confine(RoundStart(home, search.shots))
    lit = {"material/Ball/base_color": (red, 0.006, 0.006), "film/exposure": (exposure,)}
    brighter = search.vector.encode(search.vector.values(now.u) | lit)
    shots, missed = search.seen(now.shots, brighter, 0)
    assert not missed.claims
    found = eased(search, shots, now.plan, brighter)
    marked = supports(search, now.plan)
    assert found is not None
    assert not search.seen(shots, found, 0)[1].claims
    torch.testing.assert_close(found[marked], home[marked])
    torch.testing.assert_close(found[~marked], brighter[~marked])  # what the words name stays


def test_what_the_words_need_stays(tmp_path, encoder):
    """A white ball before a white floor is told apart by light, of which something has to be left."""
    scene = load_scene(write_job(tmp_path / "job", **{"material/Floor/base_color": (0.85,) * 3}))
    search, home = begun(scene, encoder, "white ball")
    outcome = refine(search, RoundStart(home, search.shots))
    assert not search.seen(outcome.shots, outcome.u, 0)[1].claims
    assert float((outcome.u - home)[supports(search, outcome.plan)].abs().amax()) > 0.01


def test_less_change_than_without_it_and_all_claims_hold(scene, encoder, monkeypatch):
    ends = {}
    for easing in (True, False):
        if not easing:
            monkeypatch.setattr(pipeline, "eased", lambda *_: None)
        search, home = begun(scene, encoder, "navy blue ball")
        outcome = refine(search, RoundStart(home, search.shots))
        missed = search.seen(outcome.shots, outcome.u, 0)[1]
        ends[easing] = outcome.u, supports(search, outcome.plan), home, missed.claims
    moved = {easing: float((u - home)[marked].norm()) for easing, (u, marked, home, _) in ends.items()}
    assert ends[True][3] == 0
    assert moved[True] <= moved[False]
