# SPDX-License-Identifier: Apache-2.0
"""Lamps stay above the floor and below the ceiling that they shine between, and do not grow through them."""

import math
from dataclasses import replace

import numpy as np
import pytest
from plan_parts import SCENE, make_plan
from tiny_job import KEY_LIGHT, write_job

from lab.bench.scenes import balls
from proxy_renderer.optimize.scene_facts import light_elevations, light_sizes, nearer_lights
from proxy_renderer.planning.types import PlanEntry
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


def walled(tmp_path, behind):
    """The tests' ball with a wall at some distance behind it; its lamp stands in front, 4 m off."""
    scene = load_scene(write_job(tmp_path / "job"))
    wall = np.array([[-9, behind, -5], [9, behind, -5], [9, behind, 9], [-9, behind, 9]], np.float32)
    mesh, count = scene.mesh, len(scene.mesh.vertices)
    faces = np.array([[0, 1, 2], [0, 2, 3]]) + count
    mesh = replace(
        mesh,
        vertices=np.concatenate([mesh.vertices, wall]),
        faces=np.concatenate([mesh.faces, faces]),
        normals=np.concatenate([mesh.normals, np.tile(np.float32([0, -1, 0]), (2, 3, 1))]),
        uvs=np.concatenate([mesh.uvs, np.zeros((2, 3, 2), np.float32)]),
        material=np.concatenate([mesh.material, [1, 1]]).astype(np.int32),
        object=np.concatenate([mesh.object, [1, 1]]).astype(np.int32),
    )
    return replace(scene, mesh=mesh)


AZIMUTH, ELEVATION, DISTANCE, POWER = (
    f"light/Key/{name}" for name in ("azimuth", "elevation", "distance", "power")
)
BEHIND = {
    AZIMUTH: PlanEntry((170.0,), (190.0,), 1, "'from behind'", prior=0.0),
    ELEVATION: PlanEntry((-89.0,), (89.0,), None, "no word touches it"),
    DISTANCE: PlanEntry((1.2,), (16.0,), None, "no word touches it"),
    POWER: PlanEntry((100.0,), (400.0,), 3, "'bright'", prior=0.0),
}


def ranges_behind(scene):
    return nearer_lights(scene, Proxy(scene, (16, 12)).geometry, BEHIND)


def test_a_lamp_that_words_want_behind_a_wall_comes_nearer_and_dims(tmp_path):
    found = ranges_behind(walled(tmp_path, behind=2.5))
    (low,), (high,) = found[DISTANCE].lower, found[DISTANCE].upper
    share = low / KEY_LIGHT["distance"]
    assert low == high == pytest.approx(0.8 * 2.5 / math.cos(math.radians(KEY_LIGHT["elevation"])), rel=0.02)
    assert found[POWER].lower == pytest.approx((share**2 * 100,))
    assert found[POWER].upper == pytest.approx((share**2 * 400,))


def test_a_lamp_that_comes_nearer_dims_though_no_word_touches_its_power(tmp_path):
    scene = walled(tmp_path, behind=2.5)
    untouched = {**BEHIND, POWER: PlanEntry((0.8,), (64000.0,), None, "no word touches it")}
    found = nearer_lights(scene, Proxy(scene, (16, 12)).geometry, untouched)
    share = found[DISTANCE].lower[0] / KEY_LIGHT["distance"]
    assert found[POWER].lower == found[POWER].upper == pytest.approx((share**2 * KEY_LIGHT["power"],))


def test_a_locked_power_stays_and_a_locked_distance_keeps_the_lamp_in_its_place(tmp_path):
    scene = walled(tmp_path, behind=2.5)
    locked = {key: replace(scene.instances[key], locked="keyframed") for key in (POWER, DISTANCE)}
    power, distance = ({**scene.instances, key: locked[key]} for key in (POWER, DISTANCE))
    assert ranges_behind(replace(scene, instances=power)).keys() == {DISTANCE}
    assert ranges_behind(replace(scene, instances=distance)).keys() == {AZIMUTH, ELEVATION}


def test_a_lamp_without_room_behind_the_subject_stays_where_it_is(tmp_path):
    found = ranges_behind(walled(tmp_path, behind=1.05))
    assert found[AZIMUTH].lower == found[AZIMUTH].upper == (KEY_LIGHT["azimuth"],)
    assert DISTANCE not in found


def test_a_lamp_in_the_open_or_shut_in_as_it_stands_keeps_its_distance(tmp_path):
    assert ranges_behind(walled(tmp_path, behind=9.0)) == {}
    assert ranges_behind(walled(tmp_path, behind=-2.0)) == {}
