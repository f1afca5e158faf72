# SPDX-License-Identifier: Apache-2.0
"""What materials look like before any wish, and which structures they are by their shape."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from lab.bench.scenes import balls
from proxy_renderer.color.shades import basic
from proxy_renderer.optimize.scene_facts import _parts, _Rays, _structures, described, present_looks

SCENE = (0.0, 10.0, 0.0)  # from height 0, 10 tall, the subject stands at the bottom


@pytest.fixture
def scene():
    return balls(2, 1, 1)


def with_value(scene, key, value):
    instance = replace(scene.instances[key], value=value)
    return replace(scene, instances={**scene.instances, key: instance})


def test_the_present_color_is_that_of_the_artist(scene):
    name = scene.materials[0].name
    for linear, called in (((0.6, 0.0, 0.0), "red"), ((0.0, 0.02, 0.5), "blue"), ((0.8, 0.8, 0.8), "white")):
        looks = present_looks(with_value(scene, f"material/{name}/base_color", linear))
        assert basic(looks[name].color) == called


def test_shares_are_those_of_the_objects_that_wear_a_material(scene):
    looks = present_looks(scene)
    assert 0.0 < sum(look.share for look in looks.values()) <= 1.0
    for look in looks.values():
        assert sum(look.worn.values()) == pytest.approx(look.share)
    assert described(scene).looks == looks


def test_a_strength_without_a_color_is_no_glow(scene):
    name = scene.materials[0].name
    bright = with_value(scene, f"material/{name}/emission", (1.0,))
    for color, glows in (((0.0, 0.0, 0.0), False), ((0.0, 0.2, 1.0), True)):
        lit = with_value(bright, f"material/{name}/emission_color", color)
        assert present_looks(lit)[name].glows is glows
        assert (name in described(lit).glows) is glows


def parts(height, slope):
    return {*_parts(np.array(height, float), np.array(slope, float), SCENE)}


def test_structures_are_told_by_slope_and_height():
    heights = np.linspace(0, 10, 20)
    assert parts([0.0] * 20, [1.0] * 20) == {"ground", "support"}
    assert parts(heights, [0.0] * 20) == {"wall"}
    assert parts(np.linspace(7, 10, 20), [0.6] * 20) == {"roof"}
    assert parts([10.0] * 20, [-1.0] * 20) == {"ceiling"}
    assert parts(heights, np.linspace(-1, 1, 20)) == set()  # a ball is none


@pytest.mark.parametrize("shelf", [0, 30])
def test_the_only_ground_is_the_table_that_people_say(shelf):
    """A ball that hovers a little over a plane; beside another level surface the plane is the ground alone."""
    number = np.repeat([0, 1, 2], [50, 20, shelf])
    height, slope = np.array([0.0, 5.0, 3.0])[number], np.array([1.0, 0.0, 1.0])[number]
    rays = _Rays(100, number, number, height, slope)
    objects = [SimpleNamespace(subject=n == 1) for n in range(3)]
    found = _structures(SimpleNamespace(objects=objects), rays)
    assert found["ground"] == [0]
    assert found.get("support") == (None if shelf else [0])


def test_a_hole_in_the_ground_is_not_the_ground():
    """Stairs that lead down, of which little is seen."""
    number = np.repeat([0, 1, 2], [75, 23, 2])
    height, slope = np.array([0.0, 5.0, -4.0])[number], np.array([1.0, 0.0, 1.0])[number]
    rays = _Rays(100, number, number, height, slope)
    objects = [SimpleNamespace(subject=n > 0) for n in range(3)]
    assert _structures(SimpleNamespace(objects=objects), rays)["ground"] == [0]


def test_several_walls_are_told_from_the_floor_between_them():
    random = np.random.default_rng(0)
    number = np.repeat([0, 1, 2], 50)
    height = np.where(number == 0, 0.0, random.uniform(0.3, 3.0, 150))
    rays = _Rays(220, number, number, height, np.where(number < 1, 1.0, 0.0))
    objects = [SimpleNamespace(subject=False)] * 3
    assert _structures(SimpleNamespace(objects=objects), rays)["walls"] == [1, 2]
