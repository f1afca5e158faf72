# SPDX-License-Identifier: GPL-3.0-or-later
"""Keyframe in the panel, by its operator: a look at each of several frames, one undo step each, and Revert."""

import bpy
import pytest
from dump import contents, difference
from results import FOUND, PIVOT, PROMPT
from small_scenes import studio
from vibe_render.run import result
from vibe_render.scene import bindings, keyframes, moments, own_keys

from proxy_renderer.schema import messages

NIGHT = {"light/Area/power": [90.0], "world/strength": [0.2]}


def find(scene, words, values):
    """What a vibe writes."""
    report = {"parameters": {key: {"reason": words} for key in values}}
    result.apply(scene, words, messages.Result(values, report, "prediction.png"), (), PIVOT)


def read(scene, frame, key):
    scene.frame_set(frame)
    return bindings.read(scene, (), PIVOT)[key][0]


@pytest.fixture
def two(addon):
    """A scene with a look at frame 1 and another at frame 101: (scene, dump of before)."""
    studio(addon)
    before = contents()
    find(addon, PROMPT, FOUND)
    assert bpy.ops.vibe.keyframe() == {"FINISHED"}
    addon.frame_set(101)
    find(addon, "night", NIGHT)
    return addon, before


def test_a_single_look_has_a_key_for_each_value(addon):
    studio(addon)
    find(addon, PROMPT, FOUND)
    addon.frame_set(24)
    assert bpy.ops.vibe.keyframe() == {"FINISHED"}
    (curve,) = bpy.data.lights["Area"].animation_data.action.layers[0].strips[0].channelbags[0].fcurves
    assert [tuple(point.co) for point in curve.keyframe_points] == [(24.0, 7.0)]
    assert bpy.data.lights["Spot"].animation_data is None
    assert [moment.frame for moment in moments.of(addon)] == [24]


def test_another_look_is_keyframed_at_another_frame(two):
    scene, _ = two
    assert not bpy.ops.vibe.keep.poll()  # it would lose the first
    assert not keyframes.are_shown(scene)
    assert read(scene, 1, "light/Area/power") == pytest.approx(90.0)
    scene.frame_set(101)
    assert bpy.ops.vibe.keyframe() == {"FINISHED"}
    assert read(scene, 1, "light/Area/power") == pytest.approx(7.0)
    assert read(scene, 51, "light/Area/power") == pytest.approx((7.0 * 90.0) ** 0.5, rel=0.01)
    assert read(scene, 101, "light/Area/power") == pytest.approx(90.0)
    assert read(scene, 1, "world/strength") == pytest.approx(1.0)


def test_a_look_that_is_changed_replaces_that_of_its_frame(two):
    scene, _ = two
    bpy.ops.vibe.keyframe()
    scene.vibe.strength = 0.0
    bpy.ops.vibe.keyframe()
    assert [moment.frame for moment in moments.of(scene)] == [1, 101]
    assert read(scene, 101, "world/strength") == pytest.approx(1.0)
    assert read(scene, 1, "light/Area/power") == pytest.approx(7.0)


def test_a_look_fades_in_by_strength(addon):
    studio(addon)
    own = bindings.read(addon, (), PIVOT)["light/Area/power"][0]
    find(addon, PROMPT, FOUND)
    addon.vibe.strength = 0.0
    bpy.ops.vibe.keyframe()
    addon.frame_set(101)
    addon.vibe.strength = 1.0
    bpy.ops.vibe.keyframe()
    assert read(addon, 1, "light/Area/power") == pytest.approx(own)
    assert read(addon, 51, "light/Area/power") == pytest.approx((own * 7.0) ** 0.5, rel=0.01)
    assert read(addon, 101, "light/Area/power") == pytest.approx(7.0)


def test_revert_removes_looks_and_keyframes(two):
    scene, before = two
    bpy.ops.vibe.keyframe()
    scene.frame_set(1)
    assert bpy.ops.vibe.revert() == {"FINISHED"}
    assert difference(before, contents()) == {}


def test_keep_leaves_the_keyframes(two):
    scene, _ = two
    bpy.ops.vibe.keyframe()
    assert bpy.ops.vibe.keep() == {"FINISHED"}
    assert not keyframes.exist(scene)
    assert not bpy.ops.vibe.keyframe.poll()
    assert read(scene, 1, "light/Area/power") == pytest.approx(7.0)
    assert read(scene, 101, "light/Area/power") == pytest.approx(90.0)


def test_undo_takes_back_one_press(two):
    scene, _ = two
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.vibe.keyframe()
    bpy.ops.ed.undo_push(message="after")
    bpy.ops.ed.undo()
    scene = bpy.context.scene
    assert [moment.frame for moment in moments.of(scene)] == [1]
    assert not keyframes.are_shown(scene)
    bpy.ops.ed.redo()
    assert [moment.frame for moment in moments.of(bpy.context.scene)] == [1, 101]
    assert read(bpy.context.scene, 1, "light/Area/power") == pytest.approx(7.0)


def test_keep_moves_the_artists_own_keyframes(addon):
    studio(addon)
    lamp = bpy.data.lights["Area"]
    for frame, power in ((1, 20.0), (11, 40.0)):
        lamp.energy = power
        lamp.keyframe_insert("energy", frame=frame)
    addon.frame_set(11)
    own_keys.hold(addon)
    find(addon, "dimmer", {"light/Area/power": [10.0]})
    assert not bpy.ops.vibe.keyframe.poll()  # which writes curves of its own
    assert [c.name for c in addon.vibe.changes] == ["light/Area/power"]
    assert bpy.ops.vibe.keep() == {"FINISHED"}
    assert [read(addon, frame, "light/Area/power") for frame in (1, 11)] == pytest.approx([5.0, 10.0])
    assert not own_keys.are_held(addon)
