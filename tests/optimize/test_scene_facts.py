# SPDX-License-Identifier: Apache-2.0
"""Lamps stay above the floor and below the ceiling that they shine between, and do not grow through them."""

import math
from dataclasses import replace

import numpy as np
import pytest
from plan_parts import SCENE, make_plan
from tiny_job import KEY_LIGHT, write_job

from lab.bench.scenes import balls
from proxy_renderer.optimize.scene_facts import light_elevations, light_sizes
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import load_scene
from proxy_renderer.words.types import LightDescription

FLOOR, CEILING, FAR = 1.0, 2.0, 4.0


def room(position, heights, kind="POINT"):
    """A ball with horizontal planes at some heights from it, and one lamp; heights count from the ball's center."""
    scene = balls(2, 1, 1)
    ball = scene.mesh.object == 0
    corner = np.array([[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]], float)
    planes = np.concatenate([corner + np.array([0, 0, h]) for h in heights]) + scene.pivot
    square = np.array([[0, 1, 2], [0, 2, 3]]) + 4 * np.arange(len(heights))[:, None, None]
    faces = scene.mesh.faces[ball]
    mesh = replace(
        scene.mesh,
        vertices=np.concatenate([scene.mesh.vertices, planes]).astype(np.float32),
        faces=np.concatenate([faces, square.reshape(-1, 3) + len(scene.mesh.vertices)]),
        object=np.repeat([0, 1], [len(faces), 2 * len(heights)]),
    )
    objects = tuple(replace(o, subject=k == 0) for k, o in enumerate(scene.objects))
    lamp = replace(
        scene.lights[0], name="Key", type=kind, position=tuple(np.add(scene.pivot, position).tolist())
    )
    return replace(scene, mesh=mesh, objects=objects, lights=(lamp,))


def test_lamps_stay_between_floor_and_ceiling():
    low, high = light_elevations(room((FAR, 0, 0), (-FLOOR, CEILING)))["Key"]
    assert math.sin(math.radians(low)) * FAR == pytest.approx(-0.8 * FLOOR)
    assert math.sin(math.radians(high)) * FAR == pytest.approx(0.8 * CEILING)


def test_the_nearest_floor_counts():
    low, _ = light_elevations(room((FAR, 0, 0), (-3 * FLOOR, -FLOOR)))["Key"]
    assert math.sin(math.radians(low)) * FAR == pytest.approx(-0.8 * FLOOR)


def test_a_lamp_beyond_stays_the_artists_affair():
    assert light_elevations(room((0, 0, CEILING + 1), (CEILING,))) == {}


def test_nothing_limits_lamps_in_the_open():
    assert light_elevations(room((FAR, 0, 0), (CEILING,), "SUN")) == {}
    assert light_elevations(room((FAR, 0, 0), (-FLOOR,), "SUN")) == {"Key": (0.0, 90.0)}


def test_light_from_below_stays_above_the_floor():
    limited = replace(SCENE, lights={"Key": LightDescription("AREA", elevations=(-12.0, 60.0))})
    assert make_plan("lit from below")["light/Key/elevation"].upper[0] < -12.0
    entry = make_plan("lit from below", scene=limited)["light/Key/elevation"]
    assert entry.lower[0] == pytest.approx(-12.0)


@pytest.mark.parametrize("size", [KEY_LIGHT["size"], 9.0])
def test_a_lamp_grows_until_its_lower_edge_is_near_the_floor_and_never_shrinks(tmp_path, size):
    scene = load_scene(write_job(tmp_path / "job", **{"light/Key/size": [size]}))
    tilt = math.radians(KEY_LIGHT["elevation"])
    height = scene.pivot[2] + KEY_LIGHT["distance"] * math.sin(tilt)
    widest = light_sizes(scene, Proxy(scene, (16, 12)).geometry)
    assert widest == {"light/Key/size": pytest.approx(max(0.8 * 2 * height / math.cos(tilt), size), rel=1e-3)}
