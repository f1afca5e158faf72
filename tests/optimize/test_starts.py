# SPDX-License-Identifier: Apache-2.0
"""Several starts: inside their ranges, told apart by their pictures, and variants that stay different."""

import pytest
import torch
from loop_parts import Silent, search_for

from proxy_renderer.engine.report import changed_values, parameter_records
from proxy_renderer.guidance.encoder import load_encoder
from proxy_renderer.optimize import pipeline
from proxy_renderer.optimize.rounds import starts
from proxy_renderer.optimize.shots import ShotInput, draw
from proxy_renderer.planning.types import Plan, PlanEntry
from proxy_renderer.schema.messages import Options


def plan_of(vector, **priorities):
    return Plan(
        {
            k: PlanEntry(i.lower, i.upper, priorities.get(k), "because", 0.0 if k in priorities else 1.0)
            for k, i in vector.instances.items()
        }
    )


def test_starts_are_drawn_from_the_ranges_of_what_is_relevant(vector):
    key = "material/Ball/base_color"
    plan, u = plan_of(vector, **{key: 1}), vector.encode({})
    lower, upper = u.clone(), u.clone()
    part = vector.slices[key]
    lower[part], upper[part] = 0.2, 0.6
    first, *others = starts.draw_starts(vector, plan, u, (lower, upper), 9, seed=3)
    assert torch.equal(first, u)
    drawn = torch.stack(others)
    assert torch.equal(torch.stack([o[~vector.mark([key])] for o in others]), u[~vector.mark([key])].expand(8, -1))
    assert drawn[:, part].min() >= 0.2
    assert drawn[:, part].max() <= 0.6
    assert drawn[:, part].std(0).min() > 0.03
    assert torch.allclose(drawn[:, part], drawn[:, part][:, :1].expand(-1, 3))  # one place in its range: one hue
    again = starts.draw_starts(vector, plan, u, (lower, upper), 9, seed=3)
    assert all(torch.equal(a, b) for a, b in zip([first, *others], again, strict=True))


def test_the_most_diverse_are_the_first_and_what_differs_from_it_and_is_good():
    gray, near, blue, red, bad = (
        torch.tensor(c).expand(20, 24, 3)
        for c in ([0.5] * 3, [0.52] * 3, [0.2, 0.3, 0.9], [0.9, 0.2, 0.1], [0.0, 1.0, 0.0])
    )
    assert starts.most_diverse([gray, near, blue, red, bad], [0.5, 0.1, 0.2, 0.3, 9.0], 3) == [0, 2, 3]
    assert len(starts.most_diverse([gray, near], [0.1, 0.2], 4)) == 2


def test_lights_roam_as_one_where_the_words_leave_them_open(vector):
    free = plan_of(vector)
    roaming = starts.roam(vector.instances, free)
    keys = [k for k, e in roaming.items() if e.priority is not None]
    assert keys
    assert {k.split("/")[0] for k in keys} <= {"light", "world"}
    u = vector.encode({})
    box = vector.bounds({k: (e.lower, e.upper) for k, e in roaming.items()})
    start = vector.plain(starts.draw_starts(vector, roaming, u, box, 2, seed=1)[1])
    turns = {start[k][0] - vector.instances[k].value[0] for k in keys if k.endswith("/azimuth")}
    assert max(turns) - min(turns) < 1e-6
    assert 75.0 >= abs(turns.pop()) > 0.0
    named = plan_of(vector, **dict.fromkeys(keys, 2))
    assert all(e.reason == "because" for e in starts.roam(vector.instances, named).values())


def test_lights_of_a_rig_turn_for_a_variant_and_stay_near_where_they_were_drawn(vector):
    key = next(k for k, i in vector.instances.items() if i.parameter.family == "light/azimuth")
    here = vector.instances[key].value[0]
    rig = PlanEntry((here - 5.0,), (here + 5.0,), 4, "'candlelight'", 0.0, varies=True)
    plan = Plan({**plan_of(vector), key: rig})
    opened = starts.roam(vector.instances, plan)[key]
    assert opened.lower[0] < here - 20.0
    assert opened.upper[0] > here + 20.0
    u = vector.encode({key: (here + 25.0,)})
    (entry,) = starts.turned(plan, vector, u).values()
    assert (entry.lower[0], entry.upper[0]) == pytest.approx((here + 20.0, here + 30.0))
    assert entry.reason == starts.VARIED


@pytest.fixture(scope="module")
def variants(scene):
    encoder = load_encoder(None, "cpu")
    options = Options(rounds=2, steps=3, size=48, variants=3, lock=("material/Floor",))
    return pipeline.run(search_for([ShotInput(scene)], "glossy teal ball", options, encoder, Silent()))


@pytest.mark.slow
def test_variants_differ_in_their_pictures_and_keep_to_words_and_locks(scene, variants):
    found = variants.variants
    assert len(found) == 3
    assert torch.equal(found[0].u, variants.u)
    assert [v.loss for v in found] == sorted(v.loss for v in found)
    proxy = variants.shots[0].proxy
    with torch.no_grad():
        pictures = [draw(proxy, v.vector, v.u).display for v in found]
    apart = [starts.distance(a, b) for i, a in enumerate(pictures) for b in pictures[:i]]
    assert min(apart) > 2.0
    for v in found:
        records = parameter_records(v)
        assert not [k for k in changed_values(v) if k.startswith(("material/Floor/", "camera/"))]
        red, green, blue = records["material/Ball/base_color"]["after"]
        assert red < min(green, blue)
        assert all(records[k]["reason"] == starts.VARIED for k in changed_values(v) if k.endswith("azimuth"))


@pytest.mark.slow
def test_one_is_lit_as_the_artist_lit_it(variants):
    assert any(not [k for k in changed_values(v) if k.endswith("azimuth")] for v in variants.variants)
