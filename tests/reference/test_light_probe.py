# SPDX-License-Identifier: Apache-2.0
"""What a panorama says of light."""

import numpy as np
import pytest

from proxy_renderer.reference.light_probe import probe


def panorama(azimuth, elevation, color=(1.0, 0.6, 0.3), sky=(0.2, 0.3, 0.5)):
    """An even sky with a small sun, in a direction of `schema.orbit`."""
    picture = np.ones((64, 128, 3), np.float32) * np.array(sky, np.float32)
    turn = (azimuth - 90.0) / 360.0
    column, row = round((0.5 - turn) % 1.0 * 128), round((90.0 - elevation) / 180.0 * 64)
    picture[row - 1 : row + 1, np.arange(column - 1, column + 1) % 128] = 900 * np.array(color)
    return picture


@pytest.mark.parametrize(("azimuth", "elevation"), [(0.0, 30.0), (90.0, 45.0), (-120.0, 10.0)])
def test_the_sun_is_found_where_blender_would_show_it(azimuth, elevation):
    found = probe(panorama(azimuth, elevation))
    assert found.azimuth == pytest.approx(azimuth, abs=3.0)
    assert found.elevation == pytest.approx(elevation, abs=3.0)


def test_colors_of_the_sun_and_of_the_rest_are_told_apart():
    found = probe(panorama(30.0, 40.0))
    assert found.key == pytest.approx((1.0, 0.6, 0.3), abs=0.01)
    assert found.around == pytest.approx((0.4, 0.6, 1.0), abs=0.01)
    assert found.ratio > 1.0


def test_an_even_sky_has_no_direction():
    found = probe(np.full((32, 64, 3), 0.4, np.float32))
    assert found.azimuth is None
    assert found.around == pytest.approx((1.0, 1.0, 1.0))
