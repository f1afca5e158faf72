# SPDX-License-Identifier: Apache-2.0
"""A picture through thick air is exposed for it: it is about as light as it would be in clear air, also with a rig of lights."""

from dataclasses import replace

import pytest
import torch
from loop_parts import Silent, search_for

from proxy_renderer.color.tensors import lab_from_srgb
from proxy_renderer.optimize.rounds.confiner import RoundStart
from proxy_renderer.optimize.shots import ShotInput
from proxy_renderer.optimize.stage import set_stage
from proxy_renderer.optimize.vector import DENSITY, EXPOSURE, exposed_through_air, start_point
from proxy_renderer.planning.types import Plan, PlanEntry
from proxy_renderer.schema.messages import Options


def planned(scene, vector, encoder, prompt):
    """The first shot of a prompt's search, and its plan."""
    stage = set_stage([scene], prompt)
    views = [ShotInput(shot) for shot in stage.scenes]
    search = search_for(views, prompt, Options(size=64, rounds=1), encoder, Silent(), stage=stage)
    now = search.confine(RoundStart(search.vector.encode({}), search.shots))
    return search, now


@pytest.mark.parametrize("prompt", ["thick fog", "foggy dawn"])
def test_fog_leaves_the_picture_as_light_as_clear_air(scene, vector, encoder, prompt):
    search, now = planned(scene, vector, encoder, prompt)
    shot, plan = now.shots[0], now.plan
    clear = torch.where(search.vector.mark([DENSITY, EXPOSURE]), search.vector.encode({}), now.u)
    unexposed = torch.where(search.vector.mark([EXPOSURE]), search.vector.encode({}), now.u)
    clear_light, foggy, exposed = (lightness(shot.draw(u).display) for u in (clear, unexposed, now.u))
    assert plan[DENSITY].start[0] > plan[DENSITY].lower[0]
    assert abs(exposed - clear_light) <= abs(foggy - clear_light) + 0.5
    assert abs(exposed - clear_light) < 8.0


def plan_of(vector, density):
    """A plan in which words name the air, and exposure is free to support them."""
    entries = {key: PlanEntry.kept(instance, "") for key, instance in vector.instances.items()}
    if density is not None:
        entries[DENSITY] = PlanEntry((density,), (2 * density,), 1, "'fog'", prior=0.0)
    entries[EXPOSURE] = PlanEntry((-1.5,), (1.5,), 12, "supports the words", prior=0.5)
    return Plan(entries)


def lightness(display):
    return float(lab_from_srgb(display)[..., 0].mean())


def test_air_that_takes_light_is_made_up_for_and_nothing_else(vector):
    foggy, plain = plan_of(vector, density=0.5), plan_of(vector, density=None)

    def linear(u):
        dark = bool((u != vector.encode({}))[vector.slices[DENSITY]].any())
        return torch.full((2, 2, 3), 0.05 if dark else 0.4)

    found = exposed_through_air(foggy, vector, linear)
    own = vector.instances[EXPOSURE].value[0]
    assert found[EXPOSURE].start == pytest.approx((own + 3.0,), abs=1e-3)  # an eighth of the light
    assert found[EXPOSURE].upper[0] > own + 3.0
    assert exposed_through_air(plain, vector, linear) == plain
    bright = exposed_through_air(foggy, vector, lambda u: torch.full((2, 2, 3), 0.4))
    assert bright[EXPOSURE] == foggy[EXPOSURE]
    locked = Plan({**foggy, EXPOSURE: replace(foggy[EXPOSURE], priority=None)})
    assert exposed_through_air(locked, vector, linear)[EXPOSURE] == locked[EXPOSURE]
    assert start_point(vector, found, vector.encode({})).isfinite().all()
