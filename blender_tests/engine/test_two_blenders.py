# SPDX-License-Identifier: GPL-3.0-or-later
"""Two Blenders at once, on the same file, cache and presets: both finish, both are right, nothing of theirs is mixed up."""

import json
import os
import subprocess
import sys
from pathlib import Path

import bpy
import pytest
from headless_runs import BATCH_PY, FILES, QUICK, save_scene
from model_server import MODEL, sensible, serving
from vibe_render.looks import transfer

HERE = Path(__file__).parents[1]
WINDOW = """
import json, os, sys
import bpy, vibe_render
from dump import contents, difference
vibe_render.register()
bpy.ops.wm.open_mainfile(filepath=sys.argv[1])
settings, before = bpy.context.scene.vibe, contents()
settings.prompt, settings.effort = "glossy teal box, vignette", "CUSTOM"
settings.rounds, settings.steps, settings.size = 1, 2, 48
assert bpy.ops.vibe.run() == {"FINISHED"}
values = {change.name: list(change.values()[1]) for change in settings.changes}
assert bpy.ops.vibe.preset_save(name="Mine") == {"FINISHED"}
assert bpy.ops.vibe.revert() == {"FINISHED"}
assert difference(before, contents()) == {}
print("FOUND", json.dumps(values), flush=True)
vibe_render.unregister()
os._exit(0)
"""


def twice(command, **variables):
    """Two processes of one command at once: what they print."""
    kept = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "encoding": "utf-8"}
    both = [
        subprocess.Popen([sys.executable, *map(str, command)], env={**os.environ, **variables}, **kept)
        for _ in range(2)
    ]
    outputs = [process.communicate(timeout=300)[0] for process in both]
    assert [process.returncode for process in both] == [0, 0], outputs
    return outputs


def same(first, second):
    """Whether two vibes came to the same values; Cycles and torch do not promise the last digit."""
    assert set(first) == set(second)
    for key, value in first.items():
        assert second[key] == pytest.approx(value, rel=0.02, abs=0.01), key


@pytest.mark.slow
def test_two_windows(tmp_path):
    shot = save_scene(tmp_path / "shot.blend")
    held, user = shot.read_bytes(), tmp_path / "user"
    places = {"BLENDER_USER_RESOURCES": str(user), "TMPDIR": str(tmp_path)}
    paths = {"PYTHONPATH": os.pathsep.join([str(HERE), os.environ.get("PYTHONPATH", "")])}
    with serving(sensible) as model:
        asked = {"VIBE_VLM_MODEL": MODEL, "VIBE_VLM_URL": model.url}
        outputs = twice(["-c", WINDOW, shot], **places, **paths, **asked)
    same(*(json.loads(text.rpartition("FOUND ")[2].splitlines()[0]) for text in outputs))
    assert shot.read_bytes() == held
    saved = sorted(user.rglob("presets/vibe_render/*.json"))
    assert [path.name for path in saved] == ["mine-2.json", "mine.json"]
    same(*(transfer.load_preset(path).roles["film"][0] for path in saved))
    (prompts,) = user.rglob("prompts.json")
    assert [row["prompt"] for row in json.loads(prompts.read_text())] == ["glossy teal box, vignette"]
    assert list(user.rglob("cache/**/*.json"))
    assert not [path for path in user.rglob("*") if path.is_file() and path.name.startswith(".")]


@pytest.mark.slow
def test_two_runs_into_one_folder(tmp_path):
    shot, out = save_scene(tmp_path / "shot.blend"), tmp_path / "out"
    held, temporary = shot.read_bytes(), tmp_path / "temporary"
    temporary.mkdir()
    command = [BATCH_PY, "--events", "run", shot, "--prompt=glossy red box", f"--out={out}", *QUICK]
    outputs = twice(command, TMPDIR=str(temporary))
    results = [json.loads(text.rpartition("VIBE ")[2].splitlines()[0]) for text in outputs]
    assert [result["type"] for result in results] == ["result", "result"]
    assert {path.name for path in out.iterdir()} == FILES
    assert shot.read_bytes() == held
    assert not list(temporary.iterdir())
    wanted = json.loads((out / "report.json").read_text())["parameters"]["material/Box/base_color"]["after"]
    bpy.ops.wm.open_mainfile(filepath=str(out / "vibed.blend"))
    shader = bpy.data.materials["Box"].node_tree.nodes["Principled BSDF"]
    assert list(shader.inputs["Base Color"].default_value[:3]) == pytest.approx(wanted, rel=0.02, abs=0.01)
