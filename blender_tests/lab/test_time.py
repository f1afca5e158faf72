# SPDX-License-Identifier: GPL-3.0-or-later
"""`python -m lab time` measures what it says, and asserts no times."""

import json

import pytest
from benches import bench

pytestmark = pytest.mark.slow


def test_every_phase_of_a_vibe_is_timed(tmp_path):
    done = bench("time", tmp_path, None, "--only=tree*", "--size=64", "--samples=4")
    assert done.returncode == 0, done.stdout + done.stderr
    results = json.loads((tmp_path / "results.json").read_text())
    assert set(results["commands"]) == {"vibe --help", "vibe explain"}
    row = results["scenes"]["tree in fog"]
    assert {"live: next words", "to the first values", "to the first picture", "anchors", "search"} <= set(
        row["phases"]
    )
    assert all(phase["seconds"] >= 0.0 for phase in row["phases"].values())
    assert row["anchors"] >= 1
    assert "to the first values" in done.stdout
