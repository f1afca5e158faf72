# SPDX-License-Identifier: GPL-3.0-or-later
"""`python -m lab gradients` through the real command, and what its steps promise."""

import json
from fnmatch import fnmatchcase

import pytest
from benches import bench

from lab.blender.scenes.steps import CASES, ends
from proxy_renderer.schema import FAMILIES, PARAMETERS, Instance

SUN = "--only=sun", "--size=32", "--samples=8"


@pytest.mark.slow
def test_the_command_compares_with_cycles_and_keeps_its_pictures(tmp_path):
    out, cache = tmp_path / "out", tmp_path / "cache"
    done = bench("gradients", out, cache, *SUN)
    assert done.returncode == 0, done.stdout + done.stderr
    results = json.loads((out / "results.json").read_text())
    assert set(results["parameters"]) == {f"light/{n}" for n in ("strength", "azimuth", "elevation", "angle")}
    assert results["parameters"]["light/strength"]["cosine"] > 0.95
    assert results["parameters"]["light/strength"]["length"] == pytest.approx(1.0, abs=0.2)
    pictures = sorted(cache.glob("*.png"))
    assert len(pictures) == 8
    written = [p.stat().st_mtime_ns for p in pictures]

    # One picture cannot be written: the scene fails, and nothing that is there is rendered again.
    pictures[0].unlink()
    pictures[0].mkdir()
    again = bench("gradients", out, cache, *SUN)
    assert again.returncode == 1, again.stdout + again.stderr
    assert list(json.loads((out / "results.json").read_text())["failed"]) == ["sun"]
    assert [p.stat().st_mtime_ns for p in pictures[1:]] == written[1:]


def test_every_parameter_is_moved_somewhere():
    patterns = [pattern for case in CASES for pattern in case.keys]
    keys = {p.family: p.key({"light": "Lamp 1", "material": "Stuff 0"}.get(p.group, "")) for p in PARAMETERS}
    missing = [f for f, key in keys.items() if not any(fnmatchcase(key, pattern) for pattern in patterns)]
    assert not missing


@pytest.mark.parametrize("family", FAMILIES)
def test_steps_go_to_both_sides_within_the_bounds(family):
    p = FAMILIES[family]
    low, middle, high, du = ends(Instance(p, "", (p.default,) * p.components))
    assert low != middle != high
    assert 0 < du <= 0.1 + 1e-9
    bounds = (p.lower, p.upper)
    assert all(min(bounds) - 1e-6 <= v <= max(bounds) + 1e-6 for v in (*low, *middle, *high))
    if p.unit == "deg":
        assert max(abs(a - b) for a, b in zip(low, high, strict=True)) <= 6.0 + 1e-6
