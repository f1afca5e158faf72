# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel's operators and properties without a window, on a real engine process where one is needed."""

import os
import signal
import time

import bpy
import pytest
import vibe_render
from dump import contents, difference
from results import FOUND, PIVOT, PROMPT, read
from small_scenes import studio
from vibe_render.core import preferences
from vibe_render.engine.process import Engine
from vibe_render.render import anchors
from vibe_render.run import preview, result, session
from vibe_render.run.state import addon_state
from vibe_render.scene import bindings, snapshot
from vibe_render.scene.steps import along
from vibe_render.ui import setup
from vibe_render.ui.engine_state import engine_state

from proxy_renderer.schema import FAMILIES, GROUPS, VibeError, messages


@pytest.fixture
def vibed(addon):
    """A studio with a result in it: (scene, dump of before)."""
    subject = studio(addon)
    before = contents()
    addon.vibe.prompt = PROMPT
    records = {key: {"reason": "red"} for key in FOUND}
    result.apply(addon, PROMPT, messages.Result(FOUND, {"parameters": records}, "prediction.png"), subject, PIVOT)
    return addon, before


def test_registers_and_leaves_without_a_trace(scene):
    for _ in range(2):
        vibe_render.register()
        assert hasattr(bpy.types.Scene, "vibe")
        assert hasattr(bpy.types, "VIBE_PT_main")
        vibe_render.unregister()
        assert not hasattr(bpy.types.Scene, "vibe")
        assert not [name for name in dir(bpy.types) if name.startswith("VIBE_")]


def test_toggles_are_the_schemas_groups(addon):
    names = {name for name in addon.vibe.bl_rna.properties.keys() if name.startswith("change_")}  # noqa: SIM118
    assert names == {f"change_{group}" for group in GROUPS}
    assert addon.vibe.groups() == tuple(g for g in GROUPS if g != "camera")
    addon.vibe.change_light = False
    assert "light" not in addon.vibe.engine_options(bpy.context).groups


def test_options_are_what_the_engine_takes(addon):
    addon.vibe.lock = " light/Key, */metallic ,"
    addon.vibe.effort = "QUICK"
    options = addon.vibe.engine_options(bpy.context)
    assert options.lock == ("light/Key", "*/metallic")
    assert (options.rounds, options.steps, options.size) == (3, 8, 256)


def test_run_says_what_is_in_its_way(addon):
    from vibe_render.ui.run import VIBE_OT_run

    assert "mood" in VIBE_OT_run.obstacle(bpy.context)
    addon.vibe.prompt = PROMPT
    assert "mesh" in VIBE_OT_run.obstacle(bpy.context)
    studio(addon)
    assert VIBE_OT_run.obstacle(bpy.context) == ""
    for group in GROUPS:
        setattr(addon.vibe, f"change_{group}", False)
    assert "Unlock at least one" in VIBE_OT_run.obstacle(bpy.context)
    assert not bpy.ops.vibe.run.poll()


def test_result_is_written_and_listed(vibed):
    scene, _ = vibed
    assert read(scene) == {key: pytest.approx(value, abs=1e-5) for key, value in FOUND.items()}
    assert {change.name for change in scene.vibe.changes} == set(FOUND)
    assert all(change.reason == "red" for change in scene.vibe.changes)


def test_strength_leads_from_the_original_to_the_vibe(vibed):
    scene, _ = vibed
    original = {change.name: list(change.values()[0]) for change in scene.vibe.changes}
    scene.vibe.strength = 0.0
    assert read(scene) == {key: pytest.approx(value, abs=1e-6) for key, value in original.items()}
    scene.vibe.strength = 0.5
    power = original["light/Area/power"][0]
    assert read(scene)["light/Area/power"] == pytest.approx([(power * 7.0) ** 0.5], rel=1e-4)
    scene.vibe.show_original = True
    assert read(scene)["film/contrast"] == pytest.approx([1.0])
    scene.vibe.show_original, scene.vibe.strength = False, 1.0
    assert read(scene) == {key: pytest.approx(value, abs=1e-5) for key, value in FOUND.items()}


def test_revert_restores_everything(vibed):
    scene, before = vibed
    scene.vibe.strength = 0.3
    assert difference(before, contents())
    assert bpy.ops.vibe.revert() == {"FINISHED"}
    assert difference(before, contents()) == {}
    assert not scene.vibe.changes
    assert not bpy.ops.vibe.revert.poll()


def test_another_variant_brings_its_own_reasons(vibed):
    """What only the first one changed is as it was; the list tells of the one that is in the scene."""
    scene, before = vibed
    other = {"light/Area/power": [90.0], "world/strength": [0.2]}
    original, _ = scene.vibe.changes["film/contrast"].values()
    second = messages.Variant(other, "variant-2.png", 0.5, {"light/Area/power": "bright"})
    result.choose(scene, 1, second, ())
    there = bindings.read(scene, (), PIVOT)
    assert there["light/Area/power"] == pytest.approx((90.0,))
    assert there["film/contrast"] == pytest.approx(original)
    assert {c.name: c.reason for c in scene.vibe.changes} == {"light/Area/power": "bright", "world/strength": ""}
    assert bpy.ops.vibe.revert() == {"FINISHED"}
    assert difference(before, contents()) == {}


def test_again_leads_from_the_artists_own_values(vibed):
    """Before, Strength 0 and Revert agree after a second vibe, also about what only the first one changed."""
    scene, before = vibed
    own = {change.name: change.values()[0] for change in scene.vibe.changes}
    more = {"light/Area/power": [90.0], "world/strength": [0.2]}
    records = {key: {"reason": "bright"} for key in more}
    result.apply(scene, "bright", messages.Result(more, {"parameters": records}, "prediction.png"), (), PIVOT)
    listed = {change.name: change for change in scene.vibe.changes}
    assert set(listed) == set(FOUND) | set(more)
    assert {key: listed[key].values()[0] for key in own} == own
    assert (listed["light/Area/power"].reason, listed["film/contrast"].reason) == ("bright", "red")
    owners = [key.rpartition("/")[0] for key in listed]
    assert owners == sorted(owners, key=owners.index)  # one heading for each
    after = read(scene)
    scene.vibe.strength = 0.0
    assert read(scene) == {key: pytest.approx(own[key], abs=1e-6) for key in FOUND}
    scene.vibe.strength = 1.0
    assert read(scene) == {key: pytest.approx(value, rel=1e-5) for key, value in after.items()}
    scene.vibe.show_original = True
    assert read(scene) == {key: pytest.approx(own[key], abs=1e-6) for key in FOUND}
    assert bpy.ops.vibe.revert() == {"FINISHED"}
    assert difference(before, contents()) == {}


def test_variants_leave_what_an_earlier_vibe_did(vibed):
    scene, before = vibed
    own = scene.vibe.changes["light/Area/power"].values()[0]
    looks = [messages.Variant({"light/Area/power": [p]}, "", 0.5, {}) for p in (90.0, 40.0)]
    result.apply(scene, "bright", messages.Result(looks[0].values, {}, ""), (), PIVOT)
    result.choose(scene, 1, looks[1], ())
    there = bindings.read(scene, (), PIVOT)
    assert there["light/Area/power"] == pytest.approx((40.0,))
    assert there["film/contrast"] == pytest.approx((1.3,))
    assert {c.name for c in scene.vibe.changes} == set(FOUND)
    assert scene.vibe.changes["light/Area/power"].values()[0] == own
    assert bpy.ops.vibe.revert() == {"FINISHED"}
    assert difference(before, contents()) == {}


def test_keep_leaves_nothing_to_revert_to(vibed):
    scene, _ = vibed
    scene.vibe.show_original = True
    assert bpy.ops.vibe.keep() == {"FINISHED"}
    assert read(scene) == {key: pytest.approx(value, abs=1e-5) for key, value in FOUND.items()}
    assert not snapshot.exists(scene)


@pytest.mark.parametrize("family", FAMILIES)
def test_mixing_ends_at_its_ends(family):
    parameter = FAMILIES[family]
    low, high = ((b,) * parameter.components for b in (parameter.lower, parameter.upper))
    assert along(family, low, (low, high), 0.0) == list(low)
    assert along(family, low, (low, high), 1.0) == list(high)
    assert all(low[0] < v < high[0] for v in along(family, low, (low, high), 0.5))


@pytest.fixture(scope="module")
def engine():
    """An engine that stays warm between these tests, as it does between vibes."""
    kept = Engine()
    yield kept
    kept.stop()


@pytest.fixture
def warm(addon, engine):
    """A scene to vibe, with the warm engine."""
    studio(addon)
    addon.vibe.prompt, addon.vibe.effort = PROMPT, "CUSTOM"
    addon.vibe.rounds, addon.vibe.steps, addon.vibe.size = 1, 2, 64
    choice = preferences.engine_choice(bpy.context), preferences.cache_folder(bpy.context)
    addon_state._engine, addon_state._engine_choice = engine, choice
    yield addon
    addon_state._engine = None


@pytest.fixture
def cold(addon):
    """A session whose engine has just been sent the scene: (scene, dump of before, session)."""
    studio(addon)
    addon.vibe.prompt = PROMPT
    before = contents()
    started = addon_state.begin(bpy.context)
    while not started.asked:
        assert started.advance()
    assert difference(before, contents())
    return addon, before, started


def to_the_end(running):
    """Lets a session come to its end."""
    while running.advance():
        time.sleep(0.05)


def test_run_operator_does_it_all(warm):
    assert bpy.ops.vibe.run() == {"FINISHED"}
    assert warm.vibe.changes
    assert warm.vibe.vibed_prompt == PROMPT


def test_engine_refusal_reaches_the_panel(warm):
    before = contents()
    warm.vibe.prompt = "qwxz vbnm"
    with pytest.raises(RuntimeError):
        bpy.ops.vibe.run()
    assert addon_state.failure.remedy
    assert difference(before, contents()) == {}


def test_anchors_are_announced_and_leave_the_scene_as_it_was_meanwhile(warm):
    running = addon_state.begin(bpy.context)
    while running.stage != session.ANCHORING:
        assert running.advance()
        time.sleep(0.05)
    between = contents()
    assert running.advance()
    changed = difference(between, contents())
    changed.pop(f"scenes[{bpy.context.scene.name}]['{preview.KEY}']", None)  # the same look, journaled anew
    assert changed == {}
    to_the_end(running)
    assert running.prediction_error >= 0.0
    assert running.report["anchored"]["notes"] == []


def test_cancel_between_anchors_leaves_a_vibe_as_it_was(warm):
    assert bpy.ops.vibe.run() == {"FINISHED"}
    before = contents()
    warm.vibe.prompt = "dark, cool blue light, fog"
    running = addon_state.begin(bpy.context)
    for _ in range(2):
        while running.stage != session.ANCHORING:
            assert running.advance()
            time.sleep(0.05)
        assert running.advance()
    addon_state.cancel()
    assert difference(before, contents()) == {}


def test_without_anchors_nothing_is_rendered(warm):
    warm.vibe.anchor = False
    running = addon_state.begin(bpy.context)
    stages = {running.stage}
    while running.advance():
        stages.add(running.stage)
        time.sleep(0.02)
    assert session.ANCHORING not in stages
    assert running.prediction_error is None


def test_a_blender_that_cannot_render_goes_on_without(warm, monkeypatch):
    def broken(*_args, **_named):
        raise RuntimeError("no memory for this")

    monkeypatch.setattr(anchors, "render_anchor", broken)
    running = addon_state.begin(bpy.context)
    to_the_end(running)
    assert warm.vibe.changes
    assert running.prediction_error is None
    assert "no memory for this" in running.report["anchored"]["notes"][0]


def test_cancel_leaves_the_scene_as_it_was_and_the_engine_warm(warm, engine):
    before, process = contents(), engine._process
    warm.vibe.rounds, warm.vibe.steps = 100, 1000
    running = addon_state.begin(bpy.context)
    while running.progress is None:
        assert running.advance()
        time.sleep(0.05)
    addon_state.cancel()
    assert difference(before, contents()) == {}
    warm.vibe.rounds, warm.vibe.steps = 1, 2
    assert bpy.ops.vibe.run() == {"FINISHED"}
    assert engine._process is process


def test_stop_takes_the_best_so_far(warm):
    before = contents()
    warm.vibe.rounds, warm.vibe.steps = 100, 1000
    running = addon_state.begin(bpy.context)
    while running.progress is None:
        assert running.advance()
        time.sleep(0.05)
    running.stop()
    to_the_end(running)
    assert warm.vibe.changes
    assert running.preview.is_file()
    result.revert(warm)
    assert difference(before, contents()) == {}


def test_cancel_at_once_leaves_the_scene_as_it_was(cold):
    _, before, _ = cold
    addon_state.cancel()
    assert difference(before, contents()) == {}


def test_engine_that_dies_leaves_the_scene_as_it_was(cold):
    _, before, running = cold
    os.kill(running._engine._process.pid, signal.SIGKILL)
    with pytest.raises(VibeError, match="stopped unexpectedly"):
        to_the_end(running)
    assert difference(before, contents()) == {}


def test_unregister_ends_the_engine(cold):
    process = cold[2]._engine._process
    vibe_render.unregister()
    assert process.poll() is not None
    vibe_render.register()


def test_wrong_engine_is_refused(tmp_path):
    with pytest.raises(VibeError, match="no Vibe engine"):
        Engine(str(tmp_path)).start()


def test_a_file_that_is_opened_does_not_end_the_search_for_the_engine(addon, tmp_path):
    engine_state.search(str(tmp_path), again=True)
    setup.warm_up_soon()
    assert not bpy.app.timers.is_registered(setup._warm_up)
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    assert bpy.app.timers.is_registered(engine_state._timer)


def test_the_engine_starts_once_when_a_panel_is_drawn(addon):
    engine_state.search("")
    while engine_state.search_work:
        engine_state.tick()
    setup.warm_up_soon()
    setup.warm_up_soon()
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    assert bpy.app.timers.is_registered(setup._warm_up)
    setup._warm_up()
    until = time.monotonic() + 60.0
    while not addon_state.engine(bpy.context).alive and time.monotonic() < until:
        time.sleep(0.02)
    warm = addon_state.engine(bpy.context)
    assert warm.alive
    assert addon_state.begin(bpy.context)._engine is warm
