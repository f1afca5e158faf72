# SPDX-License-Identifier: GPL-3.0-or-later
"""The Flamenco job type in a JavaScript engine, against a stand-in of Flamenco's API; its tasks are then run."""

import json
import os
import subprocess
import sys
from pathlib import Path

import bpy
import pytest
from small_scenes import studio

from proxy_renderer.batch.command import install_job_type
from proxy_renderer.schema import VibeError, preset

ROOT = Path(__file__).parents[2]
API = """
function Task(name, type) {
    return { name: name, type: type, commands: [], dependencies: [],
        addCommand: function (c) { this.commands.push(c); },
        addDependency: function (t) { this.dependencies.push(t.name); } };
}
const author = { Task: Task, Command: function (name, parameters) { return { name: name, parameters: parameters }; } };
const path = { join: function () { return Array.prototype.join.call(arguments, "/"); } };
function formatTimestampLocal(time) { return "2026-01-02_030405"; }
function frameChunker(frames, size) {
    const found = [], ends = frames.split("-").map(Number), last = ends[ends.length - 1];
    for (let f = ends[0]; f <= last; f += size) {
        const end = Math.min(f + size - 1, last);
        found.push(end > f ? f + "-" + end : "" + f);
    }
    return found;
}
function compiled(settings) {
    const job = { settings: settings, created: 0, tasks: [], addTask: function (t) { this.tasks.push(t); } };
    compileJob(job);
    return JSON.stringify({ tasks: job.tasks, settings: job.settings });
}
"""


@pytest.fixture
def engine(tmp_path):
    """A JavaScript engine that has loaded the installed job type."""
    racer = pytest.importorskip("py_mini_racer", reason="mini-racer is not installed")
    context = racer.MiniRacer()
    context.eval(API + install_job_type(tmp_path / "scripts").read_text())
    return context


def compiled(engine, settings):
    return json.loads(engine.eval(f"compiled({json.dumps(settings)})"))


def test_it_needs_a_manager(tmp_path):
    with pytest.raises(VibeError, match="There is no folder"):
        install_job_type(tmp_path / "nowhere" / "scripts")


def test_its_settings_are_complete(engine):
    settings = json.loads(engine.eval("JSON.stringify(JOB_TYPE.settings)"))
    assert {"preset", "frames", "chunk_size", "blendfile", "format"} <= {s["key"] for s in settings}
    script = next(s["default"] for s in settings if s["key"] == "vibe_script")
    assert Path(script).is_file()


@pytest.mark.slow
def test_its_tasks_apply_the_look_and_render_the_frames(engine, tmp_path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    studio(scene)
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 1
    scene.render.resolution_x, scene.render.resolution_y = 32, 24
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    look = preset.Preset("dark", {"world": [{"strength": [0.01]}]}, {})
    (tmp_path / "preset.json").write_text(look.dumps())
    script = json.loads(engine.eval("JSON.stringify(JOB_TYPE.settings)"))
    settings = {s["key"]: s["default"] for s in script if "default" in s} | {
        "preset": str(tmp_path / "preset.json"),
        "frames": "1-3",
        "chunk_size": 2,
        "output_path": str(tmp_path / "out" / "{timestamp}"),
        "blendfile": str(tmp_path / "shot.blend"),
        "format": "PNG",
    }
    job = compiled(engine, settings)
    assert [task["name"] for task in job["tasks"]] == ["apply-look", "render-1-2", "render-3"]
    assert [task["dependencies"] for task in job["tasks"]] == [[], ["apply-look"], ["apply-look"]]
    for task in job["tasks"]:
        for command in task["commands"]:
            carry_out(command)
    folder = Path(job["settings"]["output_path"])
    assert folder.name == "2026-01-02_030405"
    assert (folder / "vibed.blend").is_file()
    frames = sorted((folder / "frames").iterdir())
    assert [frame.name for frame in frames] == ["000001.png", "000002.png", "000003.png"]


def carry_out(command):
    """What a worker does with the command `blender-render`."""
    assert command["name"] == "blender-render"
    given = command["parameters"]
    blender = [sys.executable, str(ROOT / "blender_tests" / "blender_command.py")]
    expand = {"{blender}": blender, "{blenderArgs}": ["-b", "-y"]}
    words = [*expand[given["exe"]], *expand[given["exeArgs"]], *given["argsBefore"], given["blendfile"], *given["args"]]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), str(ROOT / "addon")])}
    done = subprocess.run(words, env=environment, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
