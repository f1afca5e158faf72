# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults tried on purpose: in each a clear message, the scene as it was, and a next vibe that works."""

import errno
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import bpy
import pytest
import vibe_render
from dump import difference, dump
from small_scenes import cube, studio
from vibe_render import result, scene_io, session, snapshot
from vibe_render.desk import desk
from vibe_render.operators import obstacle

from proxy_renderer.schema import VibeError, messages

PROMPT = "glossy red cube, warm light"


@pytest.fixture
def addon(scene):
    """The add-on, registered, with a studio to vibe quickly."""
    vibe_render.register()
    studio(scene)
    settings = scene.vibe
    settings.prompt, settings.budget, settings.anchor = PROMPT, "CUSTOM", False
    settings.rounds, settings.steps, settings.size = 100, 1000, 64
    yield scene
    vibe_render.unregister()


def contents():
    """Everything in the file but the panel's own fields."""
    return {k: v for k, v in dump().items() if ".vibe" not in k and "Render Result" not in k}


def advance(until):
    """A new vibe, as far as a condition of it."""
    running = desk.begin(bpy.context)
    while not until(running):
        assert running.advance()
        time.sleep(0.02)
    return running


def fails(running):
    """What the panel says in the end."""
    try:
        while running.advance():
            time.sleep(0.02)
    except VibeError as error:
        desk.end(error)
        return str(error)
    pytest.fail("it did not fail")


def test_killed_and_hung_engines_and_then_a_vibe(addon, monkeypatch):
    before = contents()
    running = advance(lambda r: r.asked)
    os.kill(running._engine._process.pid, signal.SIGKILL)
    assert "stopped unexpectedly" in fails(running)
    assert difference(before, contents()) == {}

    running = advance(lambda r: r.progress)
    os.kill(running._engine._process.pid, signal.SIGKILL)
    assert "stopped unexpectedly" in fails(running)
    assert difference(before, contents()) == {}

    monkeypatch.setattr(session, "SILENT", 1.0)
    running = advance(lambda r: r.asked)
    hung = running._engine._process
    os.kill(hung.pid, signal.SIGSTOP)
    time.sleep(1.2)
    while running.silence < session.SILENT:  # what it had said before
        assert running.advance()
        time.sleep(0.3)
    desk.cancel()
    assert hung.poll() is not None
    assert difference(before, contents()) == {}

    addon.vibe.rounds, addon.vibe.steps = 1, 2
    assert bpy.ops.vibe.run() == {"FINISHED"}
    assert addon.vibe.changes


def test_an_engine_that_hangs_when_given_up_does_not_hold_up_the_next(addon, monkeypatch):
    from vibe_render import engine

    monkeypatch.setattr(engine, "_LET_GO", 0.5)
    running = advance(lambda r: r.asked)
    hung = running._engine._process
    os.kill(hung.pid, signal.SIGSTOP)
    desk.cancel()
    advance(lambda r: r.asked)
    assert hung.poll() is not None
    desk.cancel()


def test_a_full_disk_is_named(addon, monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(scene_io, "export", full)
    before = contents()
    assert "no room left on the disk" in fails(desk.begin(bpy.context))
    assert difference(before, contents()) == {}


def test_the_vibe_of_one_scene_stays_out_of_another(addon):
    other = bpy.data.scenes.new("Other")
    cube(other, "Elsewhere")
    running = advance(lambda r: r.asked)
    addon.name = "Renamed"
    assert running._find_scene() == addon
    assert not snapshot.exists(other)
    bpy.data.scenes.remove(addon)
    assert "is gone" in fails(running)
    assert not snapshot.exists(other)


def undone(tmp_path):
    """Another action, taken back."""
    bpy.ops.ed.undo_push(message="Before")
    bpy.data.objects["Area"].location.x += 1.0
    bpy.ops.ed.undo_push(message="Move")
    assert bpy.ops.ed.undo() == {"FINISHED"}


def saved(tmp_path):
    """The file."""
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "meanwhile.blend"))


def edited(tmp_path):
    """Another mode and back, as what is found is written in Object Mode only."""
    bpy.context.view_layer.objects.active = bpy.data.objects["Subject"]
    bpy.ops.object.mode_set(mode="EDIT")


def elsewhere(tmp_path):
    """Another scene is looked at."""
    bpy.context.window.scene = bpy.data.scenes.new("Other")


@pytest.mark.parametrize("act", [undone, saved, edited, elsewhere])
def test_what_artists_do_meanwhile_is_safe(addon, tmp_path, act):
    """The vibe comes to the scene that it is for, and Revert takes all of it away."""
    name, before = addon.name, contents()
    running = advance(lambda r: r.progress)
    act(tmp_path)
    running.stop()
    for _ in range(3000):
        if not running.advance():
            break
        if running.stage.startswith("Found"):
            assert not bpy.data.scenes[name].vibe.changes
            bpy.ops.object.mode_set(mode="OBJECT")
        time.sleep(0.02)
    desk.end()
    scene = bpy.data.scenes[name]
    assert scene.vibe.changes
    assert [s.name for s in bpy.data.scenes if snapshot.exists(s)] == [name]
    bpy.context.window.scene = scene
    assert bpy.ops.vibe.revert() == {"FINISHED"}
    others = ("scenes[Other]", ".is_runtime_data", ".node_tree.users")  # made by the switch, and by undo
    assert [path for path in difference(before, contents()) if not any(o in path for o in others)] == []


def test_deleting_the_subject_meanwhile_is_safe(addon):
    """What is left of the scene gets its values, and is as it was after Revert."""
    addon.vibe.prompt = "glossy red cube, dark, warm light"
    running = advance(lambda r: r.progress)
    powers = [light.energy for light in bpy.data.lights]
    bpy.data.objects.remove(bpy.data.objects["Subject"])
    running.stop()
    while running.advance():
        time.sleep(0.02)
    desk.end()
    assert any(change.name.startswith("light/") for change in addon.vibe.changes)
    assert bpy.ops.vibe.revert() == {"FINISHED"}
    assert [light.energy for light in bpy.data.lights] == powers
    assert not snapshot.exists(addon)


def test_another_file_ends_the_vibe_before_it_is_opened(addon, tmp_path):
    """The file that is opened has a snapshot of its own, which must stay."""
    subject = [bpy.data.objects["Subject"]]
    result.apply(addon, PROMPT, messages.Result({"light/Point/power": [7.0]}, {}, ""), subject, (0, 0, 0))
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "vibed.blend"))
    advance(lambda r: r.asked)
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "vibed.blend"))
    assert not desk.running
    assert desk.failure is None
    scene = bpy.context.scene
    assert bpy.data.lights["Point"].energy == 7.0
    assert [change.name for change in scene.vibe.changes] == ["light/Point/power"]
    assert snapshot.revert(scene) == []


def test_a_read_only_file_is_only_read(addon, tmp_path):
    path = tmp_path / "read_only.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    path.chmod(0o444)
    held = path.read_bytes()
    bpy.ops.wm.open_mainfile(filepath=str(path))
    scene, subject = bpy.context.scene, [bpy.data.objects["Subject"]]
    result.apply(scene, PROMPT, messages.Result({"light/Point/power": [7.0]}, {}, ""), subject, (0, 0, 0))
    assert bpy.ops.vibe.revert() == {"FINISHED"}
    assert path.read_bytes() == held


def test_a_damaged_snapshot_is_explained_in_the_panel_and_keep_ends_it(addon):
    addon[snapshot.KEY] = "somebody else's"
    with pytest.raises(RuntimeError, match="damaged"):
        bpy.ops.vibe.revert()
    assert "Press Keep" in desk.failure.remedy
    assert bpy.ops.vibe.keep() == {"FINISHED"}
    assert not snapshot.exists(addon)
    assert desk.failure is None


def test_modes_without_whole_undo_are_refused_with_the_reason(addon):
    bpy.context.view_layer.objects.active = bpy.data.objects["Subject"]
    bpy.ops.object.mode_set(mode="EDIT")
    assert "Object Mode" in obstacle(bpy.context)
    bpy.ops.object.mode_set(mode="OBJECT")
    assert obstacle(bpy.context) == ""


ORPHAN = """
import os, signal, sys, time
from pathlib import Path
from vibe_render.engine import Engine
engine = Engine("", Path(sys.argv[1]))
engine.start()
print(engine._process.pid, flush=True)
os.kill(os.getpid(), signal.SIGKILL)
"""


def test_no_engine_outlives_its_blender(tmp_path):
    """Not even one that is killed, and so cannot say goodbye."""
    command = [sys.executable, "-c", ORPHAN, str(tmp_path / "log")]
    done = subprocess.run(command, capture_output=True, text=True)
    pid, end = int(done.stdout), time.monotonic() + 120.0
    while _lives(pid) and time.monotonic() < end:
        time.sleep(0.2)
    assert not _lives(pid)


def _lives(pid):
    state = Path(f"/proc/{pid}/stat")
    return state.exists() and state.read_text().rpartition(")")[2].split()[0] != "Z"
