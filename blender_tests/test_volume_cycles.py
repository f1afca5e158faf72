# SPDX-License-Identifier: GPL-3.0-or-later
"""Fog of the proxy looks like fog in Cycles."""

import fidelity
import pytest


@pytest.mark.parametrize("name", ["area fog", "sun thick", "spot thin", "world fog", "point low"])
def test_fog_matches_cycles(tmp_path, name):
    found = fidelity.compare(fidelity.CASES[name], tmp_path, size=48, samples=64)
    print(f"{name}: {found.difference.mean():.2f}")
    assert found.cycles.mean() > 0.05
    assert found.difference.mean() < 2.6  # so small a picture is all edges; at 128 pixels it is below 1.6
    assert abs(found.cycles.mean() - found.proxy.mean()) < 0.04 * found.cycles.mean()
