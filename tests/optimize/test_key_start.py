# SPDX-License-Identifier: Apache-2.0
"""The key light is turned to where a picture of this very scene has it, before values are sought."""

import math

import pytest
import torch

from proxy_renderer.optimize.rounds.key_start import with_key_turned
from proxy_renderer.optimize.shots import picture_size
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.schema import orbit


def goal(scene, vector, **values):
    u = vector.encode({key: (value,) for key, value in values.items()})
    with torch.no_grad():
        return Proxy(scene, picture_size(scene.resolution, 96)).render(vector.decode(u)).display


def angle(vector, u, azimuth, elevation):
    found = vector.plain(u)
    one = orbit.direction(found["light/Key/azimuth"][0], found["light/Key/elevation"][0])
    other = orbit.direction(azimuth, elevation)
    return math.degrees(math.acos(min(sum(a * b for a, b in zip(one, other, strict=True)), 1.0)))


def turned(scene, vector, picture, fixed=False):
    home = vector.encode({})
    ends = (home, home) if fixed else (torch.zeros_like(home), torch.ones_like(home))
    return with_key_turned(scene, vector, home, *ends, picture)


@pytest.mark.slow
def test_it_is_found_though_strength_and_grade_differ(scene, vector):
    hidden = {"light/Key/azimuth": 70.0, "light/Key/elevation": 30.0}
    others = {"light/Key/power": 500.0, "film/contrast": 1.2, "film/exposure": -0.5}
    found = turned(scene, vector, goal(scene, vector, **hidden, **others))
    assert angle(vector, vector.encode({}), 70.0, 30.0) > 70.0
    assert angle(vector, found, 70.0, 30.0) < 25.0
    moved = (found != vector.encode({})).nonzero()[:, 0].tolist()
    assert len(moved) == 2  # nothing but the direction


@pytest.mark.slow
def test_a_key_that_stands_right_stays(scene, vector):
    assert torch.equal(turned(scene, vector, goal(scene, vector)), vector.encode({}))


def test_a_key_that_may_not_turn_stays(scene, vector):
    picture = goal(scene, vector, **{"light/Key/azimuth": 70.0})
    assert torch.equal(turned(scene, vector, picture, fixed=True), vector.encode({}))
