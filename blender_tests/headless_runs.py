# SPDX-License-Identifier: GPL-3.0-or-later
"""batch.py as a process, on a small scene."""

import json
import os
import subprocess
import sys
from pathlib import Path

import bpy
from model_server import KEY, MODEL

ROOT = Path(__file__).parents[1]
BATCH_PY = ROOT / "addon" / "vibe_render" / "batch.py"
QUICK = ["--rounds=1", "--steps=2", "--size=48", "--samples=2"]
FILES = {"before.png", "predicted.png", "after.png", "compare.png", "vibed.blend", "preset.json", "report.json"}


def run_headless(*arguments, **variables):
    """Runs batch.py with the package of this Python; its output in one string."""
    done = subprocess.run(
        [sys.executable, str(BATCH_PY), *map(str, arguments)],
        capture_output=True,
        encoding="utf-8",
        errors="replace",
        timeout=300,
        env={**os.environ, **variables},
    )
    return done.returncode, done.stdout + done.stderr


def save_scene(path):
    """A cube on a floor, with a camera and a lamp: small, and quick to render."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for name, size, height in (("Floor", 30.0, -15.0), ("Box", 1.0, 0.5)):
        bpy.ops.mesh.primitive_cube_add(size=size, location=(0, 0, height))
        bpy.context.object.name = name
        material = bpy.data.materials.new(name)
        material.use_nodes = True
        bpy.context.object.data.materials.append(material)
    bpy.ops.object.camera_add(location=(1.5, -5, 2), rotation=(1.25, 0, 0.29))
    bpy.context.scene.camera = bpy.context.object
    bpy.ops.object.light_add(type="AREA", location=(-2, -2, 4), rotation=(0.5, -0.4, 0))
    bpy.context.object.data.energy = 200.0
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = 96, 64
    scene.cycles.max_bounces = 2
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def run_with_model(folder, model):
    """A whole run that asks a model: its report, and what it printed."""
    shot = save_scene(folder / "shot.blend")
    variables = {
        "VIBE_VLM_MODEL": "another",
        "VIBE_VLM_URL": model.url,
        "VIBE_VLM_KEY": KEY,
        "VIBE_VLM_TIMEOUT": "20",
        "XDG_CACHE_HOME": str(folder / "cache"),
        "TMPDIR": str(folder / "tmp"),
    }
    (folder / "tmp").mkdir()
    code, output = run_headless(
        "run",
        shot,
        "--prompt=glossy teal box, vignette",
        f"--vlm-model={MODEL}",
        f"--out={folder / 'out'}",
        *QUICK,
        **variables,
    )
    assert code == 0, output
    return json.loads((folder / "out" / "report.json").read_text()), output
