# SPDX-License-Identifier: GPL-3.0-or-later
"""`vibe run --light-mix`: lights.exr next to after.png, of the same render."""

import json

import bpy
import numpy as np
from headless_runs import FILES, QUICK, run_headless, save_scene
from OpenEXR import File
from PIL import Image


def test_a_run_writes_the_light_layers_of_its_image(tmp_path):
    shot, out = save_scene(tmp_path / "shot.blend"), tmp_path / "out"
    code, output = run_headless("run", shot, "--prompt=warm light", f"--out={out}", "--light-mix", *QUICK)
    assert code == 0, output
    assert FILES | {"lights.exr"} <= {path.name for path in out.iterdir()}
    lights = json.loads((out / "report.json").read_text())["lights"]["lights.exr"]
    assert ["Area"] in lights.values()
    with File(str(out / "lights.exr")) as file:
        channels = [pair for part in file.parts for pair in part.channels.items()]
        passes = {name.partition(".")[2]: channel.pixels for name, channel in channels}
    assert passes["Combined"].shape[:2] == Image.open(out / "after.png").size[::-1]
    noisy = passes["Noisy Image"][..., :3]
    total = np.sum([passes[name] for name in lights], 0)
    assert np.abs(total - noisy).max() < 1e-4 * noisy.max()
    bpy.ops.wm.open_mainfile(filepath=str(out / "vibed.blend"))
    assert not bpy.context.view_layer.lightgroups
