# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults tried on purpose: in each a clear message, the scene as it was, and a next vibe that works."""

import errno
import time

import bpy
import pytest
from dump import contents, difference
from marks import few_of
from small_scenes import cube
from vibe_render.export import reading
from vibe_render.run.session import result
from vibe_render.run.state import addon_state
from vibe_render.scene import snapshot
from vibe_render.ui.run import VIBE_OT_run
from vibing import advance, fails

from proxy_renderer.schema import messages


def test_a_full_disk_is_named(addon, monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(reading, "export_captured", full)
    before = contents()
    assert "no room left on the disk" in fails(addon_state.begin(bpy.context))
    assert difference(before, contents()) == {}


@pytest.mark.slow
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
    settings = other.vibe
    settings.prompt, settings.effort, settings.anchor = "blue cube", "CUSTOM", False
    settings.rounds, settings.steps, settings.size = 1, 2, 64
    assert bpy.ops.vibe.run() == {"FINISHED"}  # and what comes is not the answer that the first one left
    assert "material/Body" not in " ".join(change.name for change in settings.changes)
    assert any(change.name.startswith("material/") for change in settings.changes)


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


@pytest.mark.parametrize("act", few_of([undone, saved, edited, elsewhere], [edited]))
def test_what_artists_do_meanwhile_is_safe(addon, tmp_path, act):
    """The vibe comes to the scene that it is for, and Revert takes all of it away."""
    name, before = addon.name, contents()
    running = advance(lambda r: r.progress)
    act(tmp_path)
    running.stop()
    for _ in range(3000):
        if not running.advance():
            break
        if "Object Mode" in running.stage:
            assert not bpy.data.scenes[name].vibe.changes
            bpy.ops.object.mode_set(mode="OBJECT")
        time.sleep(0.02)
    addon_state.end()
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
    addon_state.end()
    assert any(change.name.startswith("light/") for change in addon.vibe.changes)
    assert bpy.ops.vibe.revert() == {"FINISHED"}
    assert [light.energy for light in bpy.data.lights] == powers
    assert not snapshot.exists(addon)


@pytest.mark.slow
def test_another_file_ends_the_vibe_before_it_is_opened(addon, tmp_path):
    """The file that is opened has a snapshot of its own, which must stay."""
    subject = [bpy.data.objects["Subject"]]
    result.apply(addon, addon.vibe.prompt, messages.Result({"light/Point/power": [7.0]}, {}, ""), subject, (0, 0, 0))
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "vibed.blend"))
    advance(lambda r: r.asked)
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "vibed.blend"))
    assert not addon_state.running
    assert addon_state.failure is None
    scene = bpy.context.scene
    assert bpy.data.lights["Point"].energy == 7.0
    assert [change.name for change in scene.vibe.changes] == ["light/Point/power"]
    assert snapshot.revert(scene) == []


def test_a_damaged_snapshot_is_explained_in_the_panel_and_keep_ends_it(addon):
    addon[snapshot.KEY] = "somebody else's"
    with pytest.raises(RuntimeError, match="damaged"):
        bpy.ops.vibe.revert()
    assert "Press Keep" in addon_state.failure.remedy
    assert bpy.ops.vibe.keep() == {"FINISHED"}
    assert not snapshot.exists(addon)
    assert addon_state.failure is None


def test_modes_without_whole_undo_are_refused_with_the_reason(addon):
    bpy.context.view_layer.objects.active = bpy.data.objects["Subject"]
    bpy.ops.object.mode_set(mode="EDIT")
    assert "Object Mode" in VIBE_OT_run.obstacle(bpy.context)
    bpy.ops.object.mode_set(mode="OBJECT")
    assert VIBE_OT_run.obstacle(bpy.context) == ""
