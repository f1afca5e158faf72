# SPDX-License-Identifier: GPL-3.0-or-later
"""`python -m lab sealed` and `python -m lab materials` from end to end, and the drawn scenes."""

import json
import random

import bpy
import numpy as np
import pytest
from benches import bench

from lab.bench.sealed import scenes
from lab.blender import materials, sealed


def test_a_drawn_scene_is_built_with_materials_that_have_the_names_that_prompts_use(tmp_path):
    thing = next(thing for thing in scenes.things() if thing.shape == "car")
    drawn = None
    for number in range(1000):
        drawn = scenes.draw_scene(random.Random(number))
        if drawn.thing == thing and drawn.ground == "floor":
            break
    told = sealed.build_scene(json.loads(json.dumps(drawn.plain)), tmp_path, 0)
    assert set(told["subject"]) == {"Body", "Cabin"}
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "scene.blend"))
    names = {thing.name: thing.data.materials[0].name for thing in bpy.data.objects if thing.type == "MESH"}
    assert names["Body"] == "Toy Car"
    assert names["Wheel 0"] == "Tires"
    with np.load(tmp_path / "sight.npz") as sight:
        seen = {sight["materials"][i] for i in np.unique(sight["material"]) if i >= 0}
    assert {"Toy Car", "Tires", "Floor"} <= seen


def test_a_ball_is_given_what_was_measured():
    stuff = bpy.data.materials.new("Ball")
    row = {"color": [1.059, 0.773, 0.307], "metalness": 1, "roughness": 0.2, "transmission": 0, "ior": 1.4}
    materials.give(stuff, row)
    inputs = stuff.node_tree.nodes["Principled BSDF"].inputs
    assert tuple(inputs["Base Color"].default_value) == pytest.approx((1.0, 0.773, 0.307, 1.0))
    assert inputs["Metallic"].default_value == 1.0
    assert inputs["IOR"].default_value == pytest.approx(1.4)


@pytest.mark.slow
def test_a_sealed_job_is_carried_out_judged_and_kept(tmp_path):
    out = tmp_path / "out"
    options = ("--jobs=1", "--seed=test", "--size=64", "--samples=4")
    done = bench("sealed", out, None, *options)
    assert done.returncode == 0, done.stdout + done.stderr
    results = json.loads((out / "results.json").read_text())
    (row,) = results["rows"]
    assert row["asks"]
    assert results["asks"]["asked"] == sum(ask["holds"] is not None for ask in row["asks"])
    assert results["seed"] == "test"
    assert (out / "contact.png").is_file()
    again = bench("sealed", out, None, *options)
    assert again.returncode == 0, again.stdout + again.stderr
    assert json.loads((out / "results.json").read_text())["rows"] == results["rows"]


@pytest.mark.slow
def test_a_measured_material_and_its_picture_are_compared(tmp_path):
    out = tmp_path / "out"
    done = bench("materials", out, None, "--only=copper", "--size=64", "--samples=4")
    assert done.returncode == 0, done.stdout + done.stderr
    (row,) = json.loads((out / "results.json").read_text())["rows"]
    assert row["delta_e"] >= 0
    assert row["metal_right"] in (True, False)
