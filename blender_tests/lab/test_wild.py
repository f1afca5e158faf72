# SPDX-License-Identifier: GPL-3.0-or-later
"""`python -m lab wild` on a folder of two files: one that is changed and given back, and one that is no scene."""

import json
import os

import bpy
import pytest
import small_scenes
from benches import bench

from lab.blender.wild import compare


@pytest.fixture
def blend(tmp_path):
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    path = tmp_path / "scenes" / "cube.blend"
    path.parent.mkdir()
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


@pytest.mark.slow
def test_a_folder_is_tried_and_told(blend, tmp_path):
    (blend.parent / "broken.blend").write_bytes(os.urandom(5000))
    out = tmp_path / "out"
    done = bench("wild", out, None, f"--scenes={blend.parent}", "--half=all", "--size=64")
    assert done.returncode == 0, done.stdout + done.stderr
    results = json.loads((out / "results.json").read_text())
    assert (results["pictures"], results["refused"], results["failed"]) == (1, 1, [])
    row = results["rows"]["cube.blend"]
    assert row["revert"]["differ"] == 0, row["revert"]
    assert row["revert"]["values"] > 1000
    assert 0 < row["delta_e"] < 5
    assert row["memory_gb"] > 0.2
    assert (out / "contact.png").is_file()


def test_what_a_revert_does_not_give_back_is_counted(blend, tmp_path):
    small_scenes.cube(bpy.context.scene, "New")
    bpy.data.objects["Cube"].location.x = 3.0
    changed = tmp_path / "changed.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(changed), copy=True)
    told = compare(blend, changed, tmp_path)
    assert told["differ"] > len(told["examples"]) > 0
    assert all("New" in line or "Cube" in line or "collection" in line for line in told["examples"])
    assert compare(blend, blend, tmp_path)["differ"] == 0
