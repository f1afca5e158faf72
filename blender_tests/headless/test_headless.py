# SPDX-License-Identifier: GPL-3.0-or-later
"""batch.py as a process: a whole vibe with the real engine, its revert and its preset, and what can go wrong."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time

import bpy
import pytest
from dump import difference, dump
from headless_runs import BATCH_PY, FILES, QUICK, ROOT, run_headless, save_scene

_COMPOSITOR = "scenes[Scene].node_tree"


@pytest.fixture(scope="module")
def vibed(tmp_path_factory):
    """A folder with shot.blend, and what a vibe made of it in out/."""
    folder = tmp_path_factory.mktemp("vibed")
    shot = save_scene(folder / "shot.blend")
    original = shot.read_bytes()
    code, output = run_headless(
        "--events", "run", shot, "--prompt=glossy red box, vignette", f"--out={folder / 'out'}", *QUICK
    )
    assert code == 0, output
    assert shot.read_bytes() == original
    return folder, output


def contents(path):
    """A file's data, but for the renders' picture and the emptied compositor that Blender 4 keeps for good."""
    bpy.ops.wm.open_mainfile(filepath=str(path))
    return {k: v for k, v in dump().items() if "[Render Result]" not in k and not k.startswith(_COMPOSITOR)}


def test_it_writes_all_its_files_and_nothing_else(vibed):
    folder, _ = vibed
    assert {p.name for p in (folder / "out").iterdir()} == FILES
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for name in ("before.png", "after.png"):
        assert tuple(bpy.data.images.load(str(folder / "out" / name)).size) == (48, 32)


def test_its_report_says_what_was_done(vibed):
    report = json.loads((vibed[0] / "out" / "report.json").read_text())
    wanted = "prompt encoder seed parameters rounds similarity delta_e timings versions subject warnings claims"
    assert set(wanted.split()) <= set(report)
    assert report["subject"] == ["Box"]
    assert report["versions"]["blender"] == bpy.app.version_string
    color = report["parameters"]["material/Box/base_color"]
    assert set(color) == {"before", "after", "lower", "upper", "moved", "priority", "optimized", "reason"}
    assert color["after"][0] > 2 * color["after"][1]
    assert set(report["similarity"]) == {"before", "after"}
    assert set(report["prediction"]) == {"shown"}
    assert report["delta_e"] == report["prediction"]["shown"]["mean"]
    assert {row["word"] for row in report["claims"]} > {""}
    assert all(row["holds"] in (True, False, None) for row in report["claims"])


def test_the_values_are_in_the_blend(vibed):
    folder, _ = vibed
    bpy.ops.wm.open_mainfile(filepath=str(folder / "out" / "vibed.blend"))
    after = json.loads((folder / "out" / "report.json").read_text())["parameters"]["material/Box/base_color"]["after"]
    shader = bpy.data.materials["Box"].node_tree.nodes["Principled BSDF"]
    assert shader.inputs["Base Color"].default_value[:3] == pytest.approx(after, abs=1e-5)


def test_its_events_can_be_followed(vibed):
    events = [json.loads(line[5:]) for line in vibed[1].splitlines() if line.startswith("VIBE ")]
    kinds = [event["type"] for event in events]
    assert kinds[0] == "stage"
    assert kinds[-1] == "result"
    assert "progress" in kinds
    assert any("Box" in line for line in events[-1]["lines"])


def test_revert_brings_the_scene_back(vibed, tmp_path):
    folder, _ = vibed
    copy = shutil.copy(folder / "out" / "vibed.blend", tmp_path / "vibed.blend")
    code, output = run_headless("revert", copy)
    assert code == 0, output
    assert os.listdir(tmp_path) == ["vibed.blend"]
    assert difference(contents(folder / "shot.blend"), contents(copy)) == {}
    code, output = run_headless("revert", copy)
    assert code == 2
    assert "holds no vibe" in output


def test_an_export_for_explaining_leaves_the_file_alone(vibed, tmp_path):
    folder, _ = vibed
    shot = folder / "shot.blend"
    original = shot.read_bytes()
    code, output = run_headless("export", shot, f"--out={tmp_path / 'job'}", "--names-only")
    assert code == 0, output
    assert shot.read_bytes() == original
    assert (tmp_path / "job" / "scene.json").is_file()


def test_explain_reads_a_scene(vibed):
    command = [sys.executable, "-m", "proxy_renderer.cli", "explain", "the box is dark oak, rim light", "--json"]
    shot = vibed[0] / "shot.blend"
    done = subprocess.run([*command, str(shot)], capture_output=True, encoding="utf-8", timeout=300, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert {o["region"] for o in told["objects"]} <= {"subject", "surroundings"}
    assert told["objects"][0]["attributes"]["material"] == "dark oak"
    assert "'dark oak'" in told["plan"]["material/Box/base_color"]["reason"]
    rim = told["plan"]["light/Vibe Rim/power"]  # the scene has none: it gets one
    assert "rim light" in rim["reason"]


def test_a_preset_is_applied(vibed, tmp_path):
    folder, _ = vibed
    code, output = run_headless(
        "apply", folder / "out" / "preset.json", folder / "shot.blend", f"--out={tmp_path}", *QUICK[2:]
    )
    assert code == 0, output
    assert {p.name for p in tmp_path.iterdir()} == {"before.png", "after.png", "vibed.blend"}
    bpy.ops.wm.open_mainfile(filepath=str(folder / "out" / "vibed.blend"))
    wanted = tuple(bpy.data.materials["Box"].node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value)
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "vibed.blend"))
    shader = bpy.data.materials["Box"].node_tree.nodes["Principled BSDF"]
    assert tuple(shader.inputs["Base Color"].default_value) == pytest.approx(wanted, abs=1e-4)


@pytest.mark.slow
def test_an_interrupt_saves_the_best_so_far(vibed, tmp_path):
    command = [sys.executable, str(BATCH_PY), "--events", "run", str(vibed[0] / "shot.blend")]
    command += ["--prompt=blue box", f"--out={tmp_path}", "--rounds=500", "--steps=500", "--figures", *QUICK[2:]]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding="utf-8") as process:
        end = time.monotonic() + 200
        for line in process.stdout:
            assert time.monotonic() < end
            if '"progress"' in line:
                break
        assert '"progress"' in line
        process.send_signal(signal.SIGINT)
        output = process.stdout.read()
    assert process.wait() == 0, output
    assert {p.name for p in tmp_path.iterdir()} == {*FILES, "mask.png"}
    report = json.loads((tmp_path / "report.json").read_text())
    assert set(report["prediction"]) == {"shown", "before_last_anchor", "unanchored"}
    assert json.loads((tmp_path / "report.json").read_text())["stopped"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["run", "missing.blend", "--prompt=x"], "There is no file"),
        (["run", "broken.blend", "--prompt=x"], "broken.blend cannot be opened"),
        (["run", "empty.blend", "--prompt=x"], "no mesh"),
        (["run", "shot.blend", "--prompt= "], "The prompt is empty"),
        (["run", "shot.blend", "--prompt=" + "long " * 2000], "characters"),
        (["run", "shot.blend", "--prompt=x", "--groups=sound"], "Unknown group 'sound'"),
        (["run", "shot.blend", "--prompt=x", "--lock=sound"], "can match nothing"),
        (["run", "shot.blend", "--prompt=x", "--frobnicate"], "frobnicate"),
        (["run", "shot.blend", "--prompt=red box", "--subject=Moon"], "no object or collection 'Moon'"),
        (["apply", "shot.blend", "shot.blend"], "cannot be read"),
        (["dance"], "Unknown command"),
    ],
)
def test_mistakes_are_one_line_and_leave_nothing(vibed, tmp_path, arguments, message):
    shutil.copy(vibed[0] / "shot.blend", tmp_path)
    (tmp_path / "broken.blend").write_bytes(b"BLENDER-v405nonsense")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "empty.blend"))
    shots = ("missing.blend", "broken.blend", "empty.blend", "shot.blend")
    arguments = [str(tmp_path / a) if a in shots else a for a in arguments]
    out = tmp_path / "out"
    code, output = run_headless(*arguments, f"--out={out}")
    assert code == 2, output
    (line,) = [line for line in output.splitlines() if line.startswith("vibe: ")]
    assert message in line
    assert "Traceback" not in output
    assert not out.exists() or not any(out.iterdir())


def test_a_computer_without_the_engine(vibed, tmp_path):
    code, output = run_headless(
        "run", vibed[0] / "shot.blend", "--prompt=red box", f"--out={tmp_path}", VIBE_ENGINE="/nowhere"
    )
    assert code == 2, output
    assert "engine" in output
    assert not any(tmp_path.iterdir())
