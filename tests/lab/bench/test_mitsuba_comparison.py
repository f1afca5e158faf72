# SPDX-License-Identifier: Apache-2.0
"""The comparison with Mitsuba: what it says where Mitsuba is missing, and that it refuses what would not be alike."""

import importlib.util
from dataclasses import replace

import pytest

from lab.__main__ import main
from lab.bench.mitsuba import twin
from lab.bench.scenes import balls
from proxy_renderer.schema import VibeError


def test_a_missing_mitsuba_is_told_before_anything_is_measured(monkeypatch, tmp_path, capsys):
    found = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda name, *a: (name != "mitsuba" and found(name, *a)) or None)
    assert main(["speed", "--mitsuba", "--out", str(tmp_path)]) == 2
    said = capsys.readouterr().err
    assert "pip install mitsuba" in said
    assert "LLVM" in said


@pytest.mark.parametrize(("change", "why"), [({"lights": 4}, "a spot"), ({"type": "ORTHO"}, "orthographic")])
def test_what_has_no_equivalent_is_refused(change, why):
    scene = balls(2, change.get("lights", 1), 1)
    scene = replace(scene, camera=replace(scene.camera, type=change.get("type", "PERSP")))
    with pytest.raises(VibeError, match=why):
        twin.twin(None, scene, (8, 8))
