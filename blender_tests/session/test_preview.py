# SPDX-License-Identifier: GPL-3.0-or-later
"""A preview goes without a trace: by Cancel, by saving, by undo; what the artist changes meanwhile stays."""

import bpy
import pytest
import small_scenes as scenes
from dump import changes, contents, difference, dump
from results import FOUND, PIVOT, read
from vibe_render.run import preview
from vibe_render.run.state import addon_state
from vibe_render.scene import bindings, prepare, snapshot
from vibing import advance


def some_values(scene, subject, level):
    found = bindings.instances(scene, subject, PIVOT)
    return {
        key: [(1.0 - level) * a + level * b for a, b in zip(i.lower, i.upper, strict=True)] for key, i in found.items()
    }


@pytest.mark.parametrize("kind", scenes.ALL)
def test_it_goes_without_a_trace(scene, kind):
    subject = scenes.ALL[kind](scene)
    prepare.prepare_scene(scene, subject)
    values = some_values(scene, subject, 0.6)
    before = dump()
    preview.show(scene, values, subject, PIVOT)
    assert len(changes(before)) > 10
    preview.show(scene, dict(list(values.items())[::2]), subject, PIVOT)
    preview.hide(scene)
    assert changes(before) == {}
    preview.hide(scene)


def test_it_goes_to_an_earlier_vibe_that_was_not_kept(scene):
    subject = scenes.studio(scene)
    snapshot.take(scene)
    bindings.write(scene, FOUND, subject, PIVOT)
    before = dump()
    preview.show(scene, some_values(scene, subject, 0.6), subject, PIVOT)
    preview.hide(scene)
    assert changes(before) == {}


def test_what_the_artist_changes_meanwhile_stays(scene):
    subject = scenes.studio(scene)
    preview.show(scene, FOUND, subject, PIVOT)
    bpy.data.lights["Area"].energy = 3.0
    preview.hide(scene)
    assert bpy.data.lights["Area"].energy == 3.0
    assert bpy.data.lights["Sun"].color[:] == (1.0, 1.0, 1.0)


def test_a_failure_shows_none(scene):
    subject = scenes.studio(scene)
    before = dump()
    with pytest.raises(Exception, match="not a finite number"):
        preview.show(scene, {**FOUND, "light/Sun/color": [1.0, float("nan"), 0.0]}, subject, PIVOT)
    assert changes(before) == {}


def test_undo_brings_back_none_that_no_vibe_shows(addon):
    before = read(addon)
    bpy.ops.ed.undo_push(message="Scene")
    preview.show(addon, FOUND, [bpy.data.objects["Subject"]], PIVOT)
    bpy.data.objects["Floor"].location.x = 1.0
    bpy.ops.ed.undo_push(message="Move")
    preview.hide(addon)
    bpy.data.objects["Floor"].location.x = 2.0
    bpy.ops.ed.undo_push(message="Move again")
    bpy.ops.ed.undo()
    scene = bpy.context.scene
    assert bpy.data.objects["Floor"].location.x == 1.0
    assert not preview.exists(scene)
    assert read(scene) == before


@pytest.mark.slow
def test_the_first_look_is_in_the_scene_until_cancel_and_in_no_file(addon, tmp_path):
    before = contents()
    running = advance(lambda session: session.words)
    shown = contents()
    assert difference(before, contents())
    assert running.preview.is_file()
    assert running.words.keys() >= {"glossy"}
    path = str(tmp_path / "meanwhile.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path, copy=True)
    assert difference(shown, contents()) == {}
    addon_state.cancel()
    assert difference(before, contents()) == {}
    before = read(addon)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert not preview.exists(bpy.context.scene)
    assert read(bpy.context.scene) == before
