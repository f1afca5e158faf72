# SPDX-License-Identifier: Apache-2.0
"""Lamps do not grow through the surfaces around them."""

import math

import pytest
from tiny_job import KEY_LIGHT, write_job

from proxy_renderer.optimize.scene_facts import light_sizes
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import load_scene


@pytest.mark.parametrize("size", [KEY_LIGHT["size"], 9.0])
def test_a_lamp_grows_until_its_lower_edge_is_near_the_floor_and_never_shrinks(tmp_path, size):
    scene = load_scene(write_job(tmp_path / "job", **{"light/Key/size": [size]}))
    tilt = math.radians(KEY_LIGHT["elevation"])
    height = scene.pivot[2] + KEY_LIGHT["distance"] * math.sin(tilt)
    widest = light_sizes(scene, Proxy(scene, (16, 12)).geometry)
    assert widest == {"light/Key/size": pytest.approx(max(0.8 * 2 * height / math.cos(tilt), size), rel=1e-3)}
