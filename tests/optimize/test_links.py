# SPDX-License-Identifier: Apache-2.0
"""Lights that words link to objects: in the proxy and in all values, unless the artist has locked the light."""

import pytest
import torch

from proxy_renderer.optimize.shots import ShotInput, gathered
from proxy_renderer.optimize.stage import linked, set_stage
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.schema.messages import Options

KEY = "light/Key (only on Ball)/linked"


def staged(scene, prompt, **options):
    return linked(set_stage([scene], prompt), Options(**options))


def test_a_linked_light_is_in_the_values_and_in_the_proxy(scene):
    (lit,) = staged(scene, "the key light only on the ball").scenes
    vector, (shot,) = gathered([ShotInput(lit)], Options(), lambda each: Proxy(each, (32, 32), "cpu"))
    assert vector.changes(vector.encode({})) == {KEY: (1.0,)}
    assert shot.vector.changes(vector.encode({})) == {KEY: (1.0,)}
    assert {light.name: light.unlit for light in lit.lights} == {"Key": (1,), "Sun": ()}
    with torch.no_grad():
        before, after = (Proxy(each, (32, 32), "cpu").render({}) for each in (scene, lit))
    mine = before.mask > 0.5
    assert torch.equal(before.mask, after.mask)
    assert after.linear[~mine].mean() < before.linear[~mine].mean()


@pytest.mark.parametrize("options", [{"lock": ("light/Key",)}, {"groups": ("film",)}])
def test_a_locked_light_is_not_linked(scene, options):
    stage = staged(scene, "warm, the key light only on the ball", **options)
    assert not stage.scenes[0].links
    assert any("it is locked" in note for note in stage.goals.parsed.notes)


def test_a_light_that_is_not_there_is_said(scene):
    stage = staged(scene, "warm, the rim light only on the ball")
    assert not stage.scenes[0].links
    assert any("there is no rim light" in note for note in stage.goals.parsed.notes)


def test_the_role_of_a_light_is_its_name(scene):
    assert list(staged(scene, "the fill light not on the ball").scenes[0].links) == ["light/Sun (not on Ball)/linked"]
