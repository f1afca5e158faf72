# SPDX-License-Identifier: Apache-2.0
"""Watts and radiance are inverses of each other."""

import math

import pytest

from proxy_renderer.schema.radiometry import radiance, unit_energy


@pytest.mark.parametrize("kind", ["POINT", "SPOT", "AREA", "SUN"])
def test_the_unit_energy_has_a_radiance_of_one(kind):
    assert radiance(kind, unit_energy(kind, 3.0), 3.0) == pytest.approx(1.0)
    assert radiance(kind, unit_energy(kind, 3.0), 3.0, stops=1.0) == pytest.approx(2.0)


def test_suns_ignore_distance_and_lamps_obey_the_inverse_square_law():
    assert unit_energy("SUN", 10.0) == unit_energy("SUN") == math.pi
    assert unit_energy("AREA", 10.0) == pytest.approx(100.0 * unit_energy("AREA"))
