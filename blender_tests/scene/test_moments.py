# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks at frames of a scene: their keyframes, what lies between them, and that Revert takes exactly those away."""

import bpy
import numpy as np
import pytest
import small_scenes as scenes
from dump import changes, dump
from vibe_render.core.color import from_oklab, to_oklab
from vibe_render.scene import bindings, keyframes, moments, snapshot
from vibe_render.scene.moments import Moment
from vibe_render.scene.steps import old_value

from proxy_renderer import schema

PIVOT = [0.0, 0.0, 0.5]
NOON = {
    "light/Area/power": [800.0],
    "light/Point/azimuth": [170.0],
    "light/Sun/color": [1.0, 0.9, 0.8],
    "material/Body/base_color": [0.6, 0.05, 0.05],
    "film/exposure": [0.5],
}
NIGHT = {
    "light/Area/power": [25.0],
    "light/Point/azimuth": [-170.0],
    "light/Sun/color": [0.2, 0.4, 1.0],
    "light/Vibe Rim/power": [300.0],
    "volume/density": [0.05],
    "film/contrast": [1.3],
    "world/color": [0.01, 0.02, 0.2],
}


def of_looks(scene, *looks, every=60):
    """Moments at frame 1 and every 60 frames, as vibes make them."""
    there = bindings.read(scene, (), PIVOT)
    bases = [{key: list(old_value(key, there, look[key])) for key in look} for look in looks]
    own = {key: list(there[key]) for look in looks for key in look if key in there}
    return [
        Moment(1 + every * n, "", look, base | own, PIVOT)
        for n, (look, base) in enumerate(zip(looks, bases, strict=True))
    ]


def read(scene, frame, key):
    scene.frame_set(frame)
    return bindings.read(scene, (), PIVOT)[key]


@pytest.fixture
def studio(scene):
    scenes.studio(scene)
    scene.view_settings.view_transform = "Standard"
    return scene


@pytest.fixture
def keyed(studio):
    moments.show(studio, of_looks(studio, NOON, NIGHT))
    return studio


def test_each_look_is_at_its_frame(keyed):
    for frame, look in ((1, NOON), (61, NIGHT)):
        for key, value in look.items():
            there = read(keyed, frame, key)
            turned = 360.0 * round((there[0] - value[0]) / 360.0) if "azimuth" in key else 0.0
            assert np.array(there) - turned == pytest.approx(value, rel=1e-4, abs=1e-4), (frame, key)
    assert read(keyed, 1, "film/contrast")[0] == pytest.approx(1.0)
    assert read(keyed, 1, "light/Vibe Rim/power")[0] == 0.0
    assert read(keyed, 61, "film/exposure")[0] == 0.0


def test_between_them_steps_look_even(keyed):
    assert read(keyed, 31, "light/Area/power")[0] == pytest.approx((800 * 25) ** 0.5, rel=0.01)
    assert abs(read(keyed, 31, "light/Point/azimuth")[0]) == pytest.approx(180.0, abs=0.5)
    ends = [to_oklab(np.array(look["light/Sun/color"])) for look in (NOON, NIGHT)]
    middle = to_oklab(np.array(read(keyed, 31, "light/Sun/color")))
    assert middle == pytest.approx((ends[0] + ends[1]) / 2, abs=0.005)
    warm, cool = 2000.0, 10000.0
    middle = moments.between("light/Key/temperature", [warm], [cool], 0.5)
    assert 1e6 / middle[0] == pytest.approx((1e6 / warm + 1e6 / cool) / 2)
    assert from_oklab(to_oklab(np.array((0.1, 0.5, 3.0)))) == pytest.approx((0.1, 0.5, 3.0), abs=1e-5)


def test_a_light_moves_on_its_orbit(studio):
    distance = bindings.read(studio, (), PIVOT)["light/Point/distance"][0]
    looks = {"light/Point/azimuth": [0.0]}, {"light/Point/azimuth": [120.0]}
    moments.show(studio, of_looks(studio, *looks))
    for frame in range(1, 62, 5):
        assert read(studio, frame, "light/Point/distance")[0] == pytest.approx(distance, rel=0.01)
        assert read(studio, frame, "light/Point/azimuth")[0] == pytest.approx(2.0 * (frame - 1), abs=0.6)


def test_the_card_before_a_light_fades_with_it(studio):
    """While its light is off, it must not keep that of others away. Fog of no density is hidden, but not on its way."""
    before = dump()
    dusk = {"light/Vibe Key Blinds/strength": [3.0], "light/Vibe Key Blinds/azimuth": [40.0]}
    moments.show(studio, of_looks(studio, NOON, dusk, NIGHT))
    card = next(o for o in studio.objects if o.name.startswith("Vibe Card"))
    opacity = card.data.materials[0].node_tree.nodes["Vibe Card"].inputs[0]
    fog = studio.objects["Vibe Fog"]
    seen = []
    for frame in (1, 31, 61, 121):
        studio.frame_set(frame)
        seen.append((opacity.default_value, fog.hide_render))
    assert seen == [(0.0, True), (0.5, True), (1.0, False), (0.0, False)]
    studio.frame_set(1)
    assert snapshot.revert(studio) == []
    assert changes(before) == {}


def test_only_what_differs_is_keyframed(keyed):
    paths = {
        curve.data_path
        for action in bpy.data.actions
        for layer in action.layers
        for bag in layer.strips[0].channelbags
        for curve in bag.fcurves
    }
    assert "energy" in paths
    assert "view_settings.exposure" in paths
    assert not any("Roughness" in path or "use_temperature" in path for path in paths)
    assert bpy.data.lights["Spot"].animation_data is None


@pytest.mark.parametrize("kind", scenes.ALL)
def test_revert_takes_away_what_was_added(scene, kind):
    subject = scenes.ALL[kind](scene)
    before = dump()
    found = bindings.instances(scene, subject, PIVOT)
    looks = [
        {k: [a + s * (b - a) for a, b in zip(i.lower, i.upper, strict=True)] for k, i in found.items()}
        for s in (0.4, 0.6)
    ]
    for look in looks:
        look |= {"light/Vibe Key/power": [50.0]}
    moments.show(scene, of_looks(scene, *looks, every=3))
    assert keyframes.are_shown(scene)
    scene.frame_set(2)
    moments.show(scene, of_looks(scene, *reversed(looks), every=3))
    scene.frame_set(1)
    assert snapshot.revert(scene) == []
    assert changes(before) == {}


def test_revert_after_saving_leaves_the_artists_action_as_it_was(studio, tmp_path):
    lamp = bpy.data.lights["Area"]
    for frame, size in ((1, 1.0), (50, 2.0)):
        lamp.size = size
        lamp.keyframe_insert("size", frame=frame)
    studio.world.node_tree.nodes["Background"].inputs["Strength"].driver_add("default_value")
    studio.frame_set(1)
    path = str(tmp_path / "scene.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    scene, before = bpy.context.scene, dump()
    moments.show(scene, of_looks(scene, NOON, NIGHT))
    assert read(scene, 61, "light/Area/power")[0] == pytest.approx(25.0)
    assert read(scene, 25, "light/Area/size")[0] == pytest.approx(1.5, abs=0.1)
    scene.frame_set(1)
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert snapshot.revert(bpy.context.scene) == []
    assert changes(before) == {}


def test_the_artists_keyframes_and_drivers_stay(studio):
    lamp = bpy.data.lights["Area"]
    lamp.keyframe_insert("energy", frame=1)
    studio.world.node_tree.nodes["Background"].inputs["Strength"].driver_add("default_value")
    own = lamp.energy
    notes = moments.show(studio, of_looks(studio, NOON, NIGHT | {"world/strength": [3.0]}))
    assert [note.partition(":")[0] for note in notes] == ["Area light", "World"]
    assert all("animated or driven" in note for note in notes)
    assert read(studio, 61, "light/Area/power")[0] == own


def test_an_action_that_two_lights_share_stays(studio):
    lamp, other = bpy.data.lights["Area"], bpy.data.lights["Point"]
    lamp.keyframe_insert("size", frame=1)
    other.animation_data_create().action = lamp.animation_data.action
    other.animation_data.action_slot = lamp.animation_data.action_slot
    (note,) = moments.show(studio, of_looks(studio, NOON, NIGHT))
    assert note == '"Area" keeps one value at all frames: it shares its action with "Point".'


def test_the_artists_own_key_in_an_action_of_ours_survives(keyed):
    lamp = bpy.data.lights["Area"]
    lamp.keyframe_insert("size", frame=5)
    assert snapshot.revert(keyed) == []
    (curve,) = lamp.animation_data.action.layers[0].strips[0].channelbags[0].fcurves
    assert curve.data_path == "size"


def test_another_look_sets_them_aside_and_a_failure_brings_them_back(keyed):
    keyed.frame_set(61)
    bindings.write(keyed, {"light/Area/power": [7.0]}, (), PIVOT)
    assert not keyframes.are_shown(keyed)
    assert read(keyed, 61, "light/Area/power") == (7.0,)
    keyframes.bring_back(keyed)
    assert read(keyed, 61, "light/Area/power")[0] == pytest.approx(25.0)
    with pytest.raises(schema.VibeError):
        bindings.write(keyed, {"light/Area/power": [float("nan")]}, (), PIVOT)
    assert keyframes.are_shown(keyed)


def test_kept_keyframes_are_the_artists(keyed):
    snapshot.forget(keyed)
    assert not keyframes.exist(keyed)
    assert moments.of(keyed) == []
    assert "animated" in bindings.instances(keyed, (), PIVOT)["light/Area/power"].locked
    assert read(keyed, 61, "light/Area/power")[0] == pytest.approx(25.0)
