# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender is free while a scene is read, and the artist goes on: nothing breaks, and all is as they left it."""

import time

import bpy
import pytest
from dump import contents, difference
from marks import few_of
from results import state
from small_scenes import studio
from vibe_render.run import session
from vibe_render.run.state import addon_state
from vibe_render.scene import snapshot
from vibing import advance, fails


def remove(*names):
    for name in names:
        bpy.data.objects.remove(bpy.data.objects[name])


def rename():
    bpy.data.objects["Subject"].name = "Hero"
    bpy.data.materials["Body"].name = "Skin"
    bpy.data.objects["Area"].name = "Window"


CHANGES = {
    "subject deleted": lambda: remove("Subject"),
    "camera and lights deleted": lambda: remove("Camera", "Area", "Sun"),
    "renamed": rename,
    "material deleted": lambda: bpy.data.materials.remove(bpy.data.materials["Body"]),
    "another frame": lambda: bpy.context.scene.frame_set(20),
}


def halfway():
    """A vibe whose scene has been read by Blender, but not yet looked at."""
    running = advance(lambda r: snapshot.exists(bpy.context.scene))
    assert running.stage == session.READING
    return running


def finish(running):
    while running.advance():
        time.sleep(0.02)
    addon_state.end()


@pytest.mark.parametrize("change", few_of(CHANGES, {"renamed"}))
def test_changes_while_the_scene_is_read(addon, change):
    """The vibe is one of what is there then; Revert gives back what the artist made of it."""
    CHANGES[change]()
    wanted = contents()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    studio(bpy.context.scene)
    settings = bpy.context.scene.vibe
    settings.prompt, settings.effort, settings.anchor = "dusk, red light", "CUSTOM", True
    settings.rounds, settings.steps, settings.size = 1, 2, 64
    running = halfway()
    CHANGES[change]()
    finish(running)
    assert settings.changes
    assert bpy.ops.vibe.revert() == {"FINISHED"}
    assert difference(wanted, contents()) == {}


def test_given_up_while_the_scene_is_read(addon):
    remove("Area", "Sun", "Camera")
    before = contents()
    running = halfway()
    assert "Vibe Camera" in bpy.data.objects
    addon_state.cancel()
    assert not addon_state.running
    assert running.advance() is False
    assert difference(before, contents()) == {}


def test_edit_mode_while_the_engine_starts(addon):
    """There a mesh has no triangles that a render shows: the vibe waits for the artist to come back."""
    addon.vibe.rounds, addon.vibe.steps = 1, 2
    running = addon_state.begin(bpy.context)
    bpy.context.view_layer.objects.active = bpy.data.objects["Subject"]
    bpy.ops.object.mode_set(mode="EDIT")
    while "Object Mode" not in running.stage:
        assert running.advance()
        time.sleep(0.02)
    assert not snapshot.exists(addon)
    bpy.ops.object.mode_set(mode="OBJECT")
    finish(running)
    assert any(change.name.startswith("material/Body/") for change in addon.vibe.changes)


def test_nothing_left_to_see(addon):
    running = halfway()
    remove("Subject", "Floor")
    assert "no mesh" in fails(running)
    assert addon_state.failure.remedy
    assert not snapshot.exists(addon)
    assert not [m for m in bpy.data.materials if m.name.startswith("Vibe")]


@pytest.mark.slow
def test_undone_while_the_scene_is_read(addon):
    """What the scene lacked has been added, and is taken away by the undo."""
    settings = addon.vibe
    settings.rounds, settings.steps = 1, 2
    remove("Area", "Sun", "Camera")
    before = state()
    bpy.ops.ed.undo_push(message="Studio")
    bpy.context.scene.frame_set(7)
    bpy.ops.ed.undo_push(message="Frame")
    running = halfway()
    assert bpy.ops.ed.undo() == {"FINISHED"}
    finish(running)
    assert bpy.context.scene.vibe.changes
    assert bpy.ops.vibe.revert() == {"FINISHED"}
    assert difference(before, state()) == {}


def test_another_file_while_the_scene_is_read(addon):
    running = halfway()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    assert not addon_state.running
    assert running.advance() is False
    assert not snapshot.exists(bpy.context.scene)
