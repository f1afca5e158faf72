# SPDX-License-Identifier: GPL-3.0-or-later
"""A file with a fluid is opened, stepped, rendered and saved: nothing is simulated, and no cache is written."""

import subprocess
import sys

MAKE = """
import os, sys, bpy
scene = bpy.context.scene
for name, kind in (("Domain", "DOMAIN"), ("Flow", "FLOW")):
    mesh = bpy.data.objects["Cube"].data
    thing = bpy.data.objects.new(name, mesh)
    scene.collection.objects.link(thing)
    fluid = thing.modifiers.new("Fluid", "FLUID")
    fluid.fluid_type = kind
    if kind == "DOMAIN":
        thing.scale = (3, 3, 3)
        fluid.domain_settings.cache_directory = "//cache"
        fluid.domain_settings.resolution_max = 16
scene.frame_current = 3
bpy.ops.wm.save_as_mainfile(filepath=sys.argv[1])
os._exit(0)
"""
USE = """
import os, sys
from pathlib import Path
import bpy
from vibe_render.headless.scenes import _fluids, open_blend, save_blend
from vibe_render.render import final_render
shot, out = Path(sys.argv[1]), Path(sys.argv[2])
open_blend(shot)
assert {name for name, *_ in _fluids} == {"Domain", "Flow"}, _fluids
bpy.context.scene.frame_set(5)
final_render.render_picture(bpy.context.scene, out / "after.png", 32, 1)
save_blend(out / "vibed.blend")
open_blend(out / "vibed.blend")
assert "Domain" in {name for name, *_ in _fluids}  # it was saved as the artist has it: switched on
print("done", flush=True)
os._exit(0)
"""


def test_no_fluid_is_simulated(tmp_path):
    for name in ("scene", "out", "current"):
        (tmp_path / name).mkdir()
    shot = tmp_path / "scene" / "shot.blend"
    for script, arguments in ((MAKE, [shot]), (USE, [shot, tmp_path / "out"])):
        done = subprocess.run(
            [sys.executable, "-c", script, *map(str, arguments)],
            cwd=tmp_path / "current",
            capture_output=True,
            text=True,
        )
        assert done.returncode == 0, done.stdout + done.stderr
    assert "done" in done.stdout
    assert [path.name for path in (tmp_path / "scene").iterdir()] == ["shot.blend"]
    assert not list((tmp_path / "current").iterdir())
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"after.png", "vibed.blend"}
