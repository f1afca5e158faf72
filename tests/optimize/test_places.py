# SPDX-License-Identifier: Apache-2.0
"""Where objects are in the picture: a ball that is moved or made bigger is found there."""

from dataclasses import replace

import numpy as np
import pytest

from lab.bench.scenes import balls
from proxy_renderer.optimize.scene_words import placed
from proxy_renderer.schema.orbit import frame


@pytest.fixture
def scene():
    return balls(2, 1, 1)


def changed(scene, change):
    """The scene with other corners of its first object."""
    mine = np.unique(scene.mesh.faces[scene.mesh.object == 0])
    vertices = scene.mesh.vertices.copy()
    vertices[mine] = change(vertices[mine])
    return replace(scene, mesh=replace(scene.mesh, vertices=vertices))


def to_the_right(scene):
    """The direction of the picture's right."""
    angles = (scene.value(f"camera/{name}")[0] for name in ("azimuth", "elevation"))
    return np.array(frame(*angles), np.float32)[:, 0]


def test_a_ball_that_is_moved_to_the_right_is_farther_right(scene):
    name = scene.objects[0].name
    moved = changed(scene, lambda corners: corners + 0.4 * to_the_right(scene))
    assert placed(moved)[0][name][0] > placed(scene)[0][name][0] + 0.01


def test_a_ball_that_is_made_bigger_takes_more_of_the_picture(scene):
    name = scene.objects[0].name
    bigger = changed(scene, lambda corners: corners.mean(0) + 1.5 * (corners - corners.mean(0)))
    assert placed(bigger)[0][name][2] == pytest.approx(1.5 * placed(scene)[0][name][2], rel=0.1)


def test_what_reaches_behind_the_camera_has_no_place(scene):
    around = changed(scene, lambda corners: corners.mean(0) + 1e3 * (corners - corners.mean(0)))
    assert scene.objects[0].name in placed(scene)[0]
    assert scene.objects[0].name not in placed(around)[0]
