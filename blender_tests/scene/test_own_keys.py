# SPDX-License-Identifier: GPL-3.0-or-later
"""Keyframes of the artist's move with a look, all keys of a value by as much, and Revert brings every one back."""

import bpy
import pytest
import small_scenes as scenes
from dump import changes, contents, dump
from vibe_render.scene import bindings, own_keys, snapshot

PIVOT = (0.0, 0.0, 0.0)
POWER, COLOR, WORLD = "light/Faded/power", "light/Faded/color", "world/strength"
FADED = {POWER: [0.5 * 250.0], COLOR: [0.5, 0.5, 1.0], WORLD: [0.2]}


@pytest.fixture
def keyed(scene):
    """A light and a world that fade from frame 1 to 51; the light's size has a driver."""
    scenes.studio(scene)
    obj = scenes.light(scene, "POINT")
    obj.name = obj.data.name = "Faded"
    lamp = obj.data
    strength = scene.world.node_tree.nodes["Background"].inputs["Strength"]
    for frame, power, color, world in ((1, 100.0, (1.0, 1.0, 1.0), 0.1), (51, 400.0, (1.0, 0.4, 0.2), 0.3)):
        lamp.energy, lamp.color, strength.default_value = power, color, world
        for owner, name in ((lamp, "energy"), (lamp, "color"), (strength, "default_value")):
            owner.keyframe_insert(name, frame=frame)
    lamp.driver_add("shadow_soft_size").driver.expression = "0.3"
    scene.frame_set(26)
    return scene


def values(scene, frame):
    scene.frame_set(frame)
    return bindings.read(scene, (), PIVOT)


def reopened(folder):
    path = str(folder / "keyed.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    return bpy.context.scene


def curves(block):
    bags = block.animation_data.action.layers[0].strips[0].channelbags[0]
    return {(curve.data_path, curve.array_index): curve for curve in bags.fcurves}


def test_all_keys_of_a_value_move_as_far_as_the_value(keyed):
    lamp = keyed.objects["Faded"].data
    first, last = (values(keyed, frame) for frame in (1, 51))
    before = values(keyed, 26)
    assert bindings.write(keyed, FADED, (), PIVOT).keys() == FADED.keys()  # without it, they stay
    own_keys.hold(keyed)
    assert values(keyed, 30)[POWER] == before[POWER]  # as at the frame where they were set aside
    wanted = {**FADED, POWER: [0.5 * before[POWER][0]]}
    assert bindings.write(keyed, wanted, (), PIVOT) == {}
    own_keys.release(keyed)
    assert not own_keys.are_held(keyed)
    there = values(keyed, 26)
    for key, value in wanted.items():
        assert there[key] == pytest.approx(value, rel=1e-4), key
    assert values(keyed, 1)[POWER][0] == pytest.approx(50.0)  # a stop less
    assert values(keyed, 51)[POWER][0] == pytest.approx(200.0)
    handle = curves(lamp)["energy", 0].keyframe_points[0].handle_right.y
    assert 50.0 <= handle <= 200.0
    gain = [after / was for was, after in zip(before[COLOR], FADED[COLOR], strict=True)]
    for frame, color in ((1, first[COLOR]), (51, last[COLOR])):
        assert values(keyed, frame)[COLOR] == pytest.approx([g * c for g, c in zip(gain, color, strict=True)])


def test_revert_brings_every_key_back(keyed, tmp_path):
    scene = reopened(tmp_path)
    before = dump()
    own_keys.hold(scene)
    bindings.write(scene, FADED, (), PIVOT)
    own_keys.release(scene)
    scene = reopened(tmp_path)
    own_keys.hold(scene)  # of a second search, which ends while they are set aside
    bindings.write(scene, {POWER: [10.0]}, (), PIVOT)
    assert snapshot.revert(scene) == []
    assert changes(before) == {}


def test_drivers_modifiers_and_shared_actions_stay(keyed):
    lamp = keyed.objects["Faded"].data
    curves(lamp)["energy", 0].modifiers.new("NOISE")
    own_keys.hold(keyed)
    locked = {key: i.locked for key, i in bindings.instances(keyed, (), PIVOT).items() if i.owner == "Faded"}
    assert "animated" in locked[POWER]
    assert "animated" in locked["light/Faded/size"]
    assert locked[COLOR] == ""


def test_the_artists_curves_are_there_for_an_image_of_before(keyed):
    plain = values(keyed, 51)
    keyed.frame_set(26)
    own_keys.hold(keyed)
    bindings.write(keyed, FADED, (), PIVOT)
    own_keys.release(keyed)
    moved = values(keyed, 51)
    with own_keys.as_before(keyed):
        assert bindings.read(keyed, (), PIVOT)[POWER] == plain[POWER] != moved[POWER]
    assert bindings.read(keyed, (), PIVOT)[POWER] == moved[POWER]


def test_keys_that_the_artist_has_added_since_are_reported(keyed):
    own_keys.hold(keyed)
    bindings.write(keyed, FADED, (), PIVOT)
    own_keys.release(keyed)
    keyed.objects["Faded"].data.keyframe_insert("energy", frame=80)
    assert any("Faded" in line for line in snapshot.revert(keyed))
    assert not any("vibe" in name for name in contents() if "actions[" in name)
