# SPDX-License-Identifier: GPL-3.0-or-later
"""Flat grounds whose patterns mirrors show."""

import numpy as np
import pytest
from vibe_render.export.measured import capture_plane

PIVOT = np.array([0.0, 0.0, 1.0])


def _square(size: float, turn: np.ndarray) -> np.ndarray:
    """Two triangles (2, 3, 3) of a turned square."""
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) * size / 2 @ turn.T
    return corners[[[0, 1, 2], [0, 2, 3]]]


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_plane_maps_its_corners_into_the_unit_square(axis):
    turn = np.roll(np.eye(3), axis, axis=1)
    corners = _square(4.0, turn)
    plane = capture_plane(corners, PIVOT, 100.0)
    points = corners.reshape(-1, 3)
    mapped = np.column_stack((points, np.ones(len(points)))) @ np.array(plane.mapping).T
    assert mapped.min() == pytest.approx(0.0, abs=1e-6)
    assert mapped.max() == pytest.approx(1.0, abs=1e-6)
    assert np.linalg.det(plane.axes) == pytest.approx(1.0)


def test_far_parts_of_a_large_ground_are_left_out():
    assert capture_plane(_square(1e4, np.eye(3)), PIVOT, 6.0).side == pytest.approx(36.0)


def test_what_is_not_flat_is_no_plane():
    corners = _square(4.0, np.eye(3))
    corners[0, 0, 2] += 0.1
    assert capture_plane(corners, PIVOT, 6.0) is None
