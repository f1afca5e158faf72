# SPDX-License-Identifier: GPL-3.0-or-later
"""`vibe batch` with the real Blender and the real engine: a crowd of jobs, one of them hopeless, and Ctrl-C."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import bpy
import psutil
import pytest
from PIL import Image
from small_scenes import studio

ROOT = Path(__file__).parents[2]
MANIFEST = """
scenes = ["*.blend"]
prompts = ["noir", "golden hour"]
[options]
rounds = 1
steps = 2
size = 48
samples = 2
anchor = false
[limits]
retries = 0
[scene."broken.blend"]
prompts = ["noir"]
"""


def start(folder, *arguments):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), str(ROOT / "addon")])}
    command = [sys.executable, "-m", "proxy_renderer.cli", "batch", "m.toml", "--out", "out", *arguments]
    return subprocess.Popen(
        command,
        cwd=folder,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        # A test that runs in the background ignores Ctrl-C, and so would what it starts.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )


def rows(folder):
    return [json.loads(line) for line in (folder / "out" / "results.jsonl").read_text().splitlines()]


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    folder = tmp_path_factory.mktemp("shots")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    studio(bpy.context.scene)
    bpy.context.scene.cycles.samples = 2
    bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y = 96, 64
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "shot.blend"))
    (folder / "broken.blend").write_text("no .blend at all")
    (folder / "m.toml").write_text(MANIFEST)
    return folder


@pytest.mark.slow
def test_ctrl_c_ends_it_cleanly_and_the_next_run_completes_it(place):
    process = start(place)
    deadline = time.monotonic() + 300
    while not list(place.glob("out/jobs/shot*/log.txt")):
        assert time.monotonic() < deadline
        time.sleep(0.1)
    children = psutil.Process(process.pid).children(recursive=True)
    process.send_signal(signal.SIGINT)
    output, _ = process.communicate(timeout=60)
    assert process.returncode == 130, output
    assert "vibe: stopped." in output
    assert "Traceback" not in output
    _, alive = psutil.wait_procs(children, timeout=30)
    assert not alive
    assert {row["status"] for row in rows(place)} == {"failed", "waiting"}
    assert (place / "out" / "index.html").is_file()

    output, _ = (process := start(place)).communicate(timeout=600)
    assert process.returncode == 1, output  # one of the scenes is no .blend
    by_job = {(row["scene"], row["prompt"]): row for row in rows(place)}
    assert by_job["broken.blend", "noir"]["status"] == "failed"
    assert "cannot be opened" in by_job["broken.blend", "noir"]["error"]
    for prompt in ("noir", "golden hour"):
        row = by_job["shot.blend", prompt]
        assert row["status"] == "done", row
        assert row["visible"] + row["already"] + row["missed"] + row["unmeasured"]
        for kind in ("before", "after", "compare", "blend", "preset", "report"):
            assert (place / "out" / row[kind]).stat().st_size > 0
    output, _ = (process := start(place, "--final", "2-3")).communicate(timeout=600)
    assert process.returncode == 1, output
    frames = sorted(p.relative_to(place / "out" / "jobs") for p in place.glob("out/jobs/*/frames/*"))
    done = sorted(Path(row["folder"]).name for row in by_job.values() if row["status"] == "done")
    assert frames == [Path(name) / "frames" / f"000{number}.png" for name in done for number in (2, 3)]
    assert {row["frames"] for row in rows(place) if row["status"] == "done"} == {2}
    with Image.open(place / "out" / "jobs" / frames[0]) as picture:
        assert picture.size == (96, 64)  # the scene's own, not that of the small pictures
    logs = [(place / "out" / row["folder"] / "log.txt").read_text() for row in by_job.values()]
    assert all("opening" in log for log in logs)
