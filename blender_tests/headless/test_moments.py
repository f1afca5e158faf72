# SPDX-License-Identifier: GPL-3.0-or-later
"""Moments on the command line, in a process of their own: files, keyframes, refusals, and Revert."""

import json
import shutil

import bpy
import pytest
from dump import changes, dump
from headless_runs import QUICK, run_headless, save_scene
from vibe_render.core import compat
from vibe_render.scene import keyframes, moments, snapshot

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def shot(tmp_path_factory):
    """A scene with two markers, one of which Blender has named."""
    path = save_scene(tmp_path_factory.mktemp("moments") / "shot.blend")
    bpy.context.scene.timeline_markers.new("F_5", frame=5)
    bpy.context.scene.timeline_markers.new("dark night", frame=9)
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


@pytest.fixture(scope="module")
def keyed(shot):
    """The folder of two moments, and what was printed."""
    out = shot.parent / "out"
    text = "--moments=1: warm light, vignette; 11: red box, rim light, cold light"
    code, output = run_headless("run", shot, text, f"--out={out}", *QUICK)
    assert code == 0, output
    return out, output


def test_it_writes_an_image_for_each_moment_and_a_strip(keyed):
    out, output = keyed
    images = {"before.png", "after.png", "before-2.png", "after-2.png", "moments.png"}
    assert {path.name for path in out.iterdir()} == {*images, "vibed.blend", "report.json"}
    report = json.loads((out / "report.json").read_text("utf-8"))
    assert [(row["frame"], row["after"]) for row in report["moments"]] == [(1, "after.png"), (11, "after-2.png")]
    assert all(row["verdicts"] for row in report["moments"])
    assert report["left_alone"] == []
    assert "Keyframes from frame 1 to 11." in output


def test_each_look_is_at_its_frame_and_revert_takes_it_away(shot, keyed, tmp_path):
    bpy.ops.wm.open_mainfile(filepath=str(shot))
    before = dump()
    copy = shutil.copy(keyed[0] / "vibed.blend", tmp_path / "vibed.blend")
    bpy.ops.wm.open_mainfile(filepath=str(copy))
    scene = bpy.context.scene
    assert scene.frame_current == 1
    assert [moment.frame for moment in moments.of(scene)] == [1, 11]
    assert keyframes.are_shown(scene)
    assert list(compat.curves(compat.compositor(scene)))  # of the vignette, after all renders
    rim = bpy.data.lights["Vibe Rim"]
    scene.frame_set(1)
    assert rim.energy == 0.0
    scene.frame_set(11)
    assert rim.energy > 0.0
    code, output = run_headless("revert", copy)
    assert code == 0, output
    bpy.ops.wm.open_mainfile(filepath=str(copy))
    left = {key: value for key, value in changes(before).items() if "[Render Result]" not in key}
    assert not bpy.data.actions
    assert left == {}


def test_a_sequence_is_checked(shot, tmp_path):
    """From frame 5 on, a flash of the artist's own hides the color."""
    bpy.ops.wm.open_mainfile(filepath=str(shot))
    scene = bpy.context.scene
    bpy.ops.object.light_add(type="AREA", location=(2.0, -3.0, 4.0), rotation=(0.6, 0.4, 0.0))
    for frame, energy in ((4, 0.0), (5, 9000.0)):
        bpy.context.object.data.energy = energy
        bpy.context.object.data.keyframe_insert("energy", frame=frame)
    scene.frame_start, scene.frame_end = 1, 7
    scene.frame_set(1)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "flash.blend"))
    out = tmp_path / "out"
    code, output = run_headless(
        "run", tmp_path / "flash.blend", "--prompt=red box", "--check-every=3", f"--out={out}", *QUICK
    )
    assert code == 0, output
    report = json.loads((out / "report.json").read_text("utf-8"))
    assert [(row["frame"], row["lost"]) for row in report["sequence"]] == [(1, []), (4, []), (7, ["red"])]
    assert "Frame 7: no longer visible: red." in output
    assert (out / "sequence.png").is_file()

    arguments = ["--prompt=red box", "--check-every=6", "--steady", f"--out={out}"]
    code, output = run_headless("run", tmp_path / "flash.blend", *arguments, *QUICK)
    assert code == 0, output
    assert "one look for frames 7 too" in output
    assert (out / "after-2.png").is_file()
    bpy.ops.wm.open_mainfile(filepath=str(out / "vibed.blend"))
    assert bpy.context.scene.frame_current == 1


def test_keyframes_of_the_artist_move_with_a_look(shot, tmp_path):
    bpy.ops.wm.open_mainfile(filepath=str(shot))
    lamp = bpy.data.objects["Area"].data
    for frame, energy in ((1, 200.0), (11, 400.0)):
        lamp.energy = energy
        lamp.keyframe_insert("energy", frame=frame)
    bpy.context.scene.frame_set(1)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "faded.blend"))
    out = tmp_path / "out"
    arguments = ["--prompt=very dim light", "--offset-keys", f"--out={out}"]
    code, output = run_headless("run", tmp_path / "faded.blend", *arguments, *QUICK)
    assert code == 0, output
    bpy.ops.wm.open_mainfile(filepath=str(out / "vibed.blend"))
    scene, lamp = bpy.context.scene, bpy.data.objects["Area"].data
    powers = []
    for frame in (1, 11):
        scene.frame_set(frame)
        powers.append(lamp.energy)
    assert powers[0] < 150.0
    assert powers[1] == pytest.approx(2.0 * powers[0])
    assert snapshot.revert(scene) == []
    scene.frame_set(11)
    assert lamp.energy == 400.0


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        (["--moments=1: noon; 5: night", "--offset-keys"], "--offset-keys"),
        (["--markers"], "There is only one moment"),
        (["--prompt=noon", "--steady"], "--check-every 10"),
        (["--moments=1: noon; 5: xqzt"], "xqzt"),
        (["--moments=5: noon; 1: night"], "does not come after frame 5"),
    ],
)
def test_mistakes_leave_nothing(shot, tmp_path, arguments, problem):
    code, output = run_headless("run", shot, *arguments, f"--out={tmp_path}", *QUICK)
    assert code == 2, output
    assert problem in output
    assert "Traceback" not in output
    assert not any(tmp_path.iterdir())
