# SPDX-License-Identifier: GPL-3.0-or-later
"""Revert is exact: the whole file is compared before and after, also across saving and reopening."""

import bpy
import pytest
import small_scenes as scenes
from dump import changes, dump
from results import PIVOT, vibe
from vibe_render.core import compat, stored_journal
from vibe_render.scene import bindings, fog, prepare, scene_context, snapshot
from vibe_render.scene.nodes import owned

from proxy_renderer import schema


def reopen(tmp_path):
    path = str(tmp_path / "scene.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    return bpy.context.scene


@pytest.fixture(params=scenes.ALL)
def kind(request):
    return scenes.ALL[request.param]


def test_revert(scene, kind):
    subject = kind(scene)
    before = dump()
    vibe(scene, subject)
    assert len(changes(before)) > 50
    assert snapshot.revert(scene) == []
    assert changes(before) == {}


def test_revert_after_two_vibes_with_saving_and_reopening_between(scene, kind, tmp_path):
    kind(scene)
    scene = reopen(tmp_path)
    before = dump()
    names = [o.name for o in scene_context.meshes(scene)[:1]]
    vibe(scene, [bpy.data.objects[n] for n in names], 0.6)
    scene = reopen(tmp_path)
    assert fog.find_fog(scene) or scene.world.node_tree.nodes.get("Principled Volume")
    vibe(scene, [bpy.data.objects[n] for n in names], 0.3)
    scene = reopen(tmp_path)
    assert len(changes(before)) > 50
    assert snapshot.revert(scene) == []
    assert changes(before) == {}
    assert changes(dump()) == {}
    scene = reopen(tmp_path)
    assert changes(before) == {}


def test_a_look_that_was_there_is_kept_by_the_next_snapshot(scene):
    subject = scenes.studio(scene)
    vibe(scene, subject, 0.6)
    snapshot.forget(scene)
    kept = dump()
    vibe(scene, subject, 0.3)
    snapshot.revert(scene)
    assert changes(kept) == {}
    with pytest.raises(schema.VibeError, match="no snapshot"):
        snapshot.revert(scene)


def test_a_failure_in_the_middle_leaves_the_scene_as_it_was(scene, kind, monkeypatch):
    subject = kind(scene)
    prepare.prepare_scene(scene, subject)
    before = dump()
    wanted = {k: i.upper for k, i in bindings.instances(scene, subject, PIVOT).items() if not i.locked}

    class Broken:
        locked = ""

        def get(self):
            return 0.0

        def set(self, journal, raw):
            raise RuntimeError("the disk is on fire")

    rows = [
        *bindings.BINDINGS[:-1],
        bindings.ParameterBinding(bindings.BINDINGS[-1].parameter, lambda context, thing: Broken()),
    ]
    monkeypatch.setattr(bindings, "BINDINGS", tuple(rows))
    with pytest.raises(RuntimeError, match="fire"):
        bindings.write(scene, wanted, subject, PIVOT)
    assert changes(before) == {}


def test_rollback_to_a_mark(scene):
    subject = scenes.bare(scene)
    before = dump()
    first = snapshot.mark(scene)
    prepare.prepare_scene(scene, subject)
    snapshot.rollback(scene, first)
    assert changes(before) == {}
    assert not snapshot.exists(scene)


def test_revert_after_the_artist_has_renamed_and_removed_things(scene):
    subject = scenes.studio(scene)
    before = bindings.read(scene, subject, PIVOT)
    vibe(scene, subject)
    bpy.data.materials["Body"].name = "Skin"
    bpy.data.objects["Sun"].name = "Sonne"
    bpy.data.objects.remove(bpy.data.objects["Spot"])
    bpy.data.materials["Ground"].node_tree.nodes.clear()
    lost = snapshot.revert(scene)
    assert lost
    assert all("gone" in line for line in lost)
    after = bindings.read(scene, subject, PIVOT)
    assert after["material/Skin/roughness"] == before["material/Body/roughness"]
    assert after["light/Sonne/elevation"] == pytest.approx(before["light/Sun/elevation"], abs=1e-3)
    assert after["film/exposure"] == before["film/exposure"]
    assert not [b for c in ("objects", "materials", "node_groups") for b in getattr(bpy.data, c) if owned.MARK in b]


def test_a_shared_world_is_changed_for_one_scene_only(scene):
    subject = scenes.studio(scene)
    other = bpy.data.scenes.new("Other")
    other.world = scene.world
    before = dump()
    vibe(scene, subject)
    assert other.world.node_tree.nodes["Background"].inputs["Strength"].default_value == 1.0
    assert scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value > 1.0
    snapshot.revert(scene)
    assert changes(before) == {}


@pytest.mark.skipif(not compat.COMPOSITOR_IS_GROUP, reason="compositing belongs to one scene in Blender 4")
def test_shared_compositing_is_changed_for_one_scene_only(scene):
    subject = scenes.studio(scene)
    tree = scenes.compositor(scene)
    other = bpy.data.scenes.new("Other")
    other.compositing_node_group = tree
    before = dump()
    vibe(scene, subject)
    assert not owned.group_nodes(other.compositing_node_group, "Vibe Grade")
    assert owned.group_nodes(scene.compositing_node_group, "Vibe Grade")
    snapshot.revert(scene)
    assert changes(before) == {}


def test_a_snapshot_of_a_newer_version_is_refused(scene):
    vibe(scene, scenes.studio(scene))
    scene[snapshot.KEY]["version"] = stored_journal.VERSION + 1
    with pytest.raises(schema.VibeError, match="newer"):
        snapshot.revert(scene)
    assert snapshot.exists(scene)


DAMAGES = {
    "text": lambda stored: "gone",
    "half": lambda stored: {"version": 1},
    "cut": lambda stored: {**stored, "entries": stored["entries"][:-7]},
    "nonsense": lambda stored: {**stored, "entries": '[{"op": "burn", "id": 0}]'},
    "numbers": lambda stored: {**stored, "count": 1},
    "pointers": lambda stored: {**stored, "ids": 3},
    "driver": lambda stored: {
        **stored,
        "entries": '[{"op": "set", "id": 0, "path": "animation_data.drivers[0].driver", "name": "x", "old": 1}]',
    },
    "python": lambda stored: {
        **stored,
        "entries": '[{"op": "set", "id": 0, "path": "", "name": "name", "old": "import os"}]',
    },
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_snapshot_of_somebody_else_is_one_clear_line(scene, damage):
    subject = scenes.studio(scene)
    vibe(scene, subject)
    scene[snapshot.KEY] = DAMAGES[damage](scene[snapshot.KEY].to_dict())
    before = bindings.read(scene, subject, PIVOT)
    with pytest.raises(schema.VibeError, match="damaged"):
        snapshot.revert(scene)
    with pytest.raises(schema.VibeError, match="damaged"):
        bindings.write(scene, {"light/Point/power": (3.0,)}, subject, PIVOT)
    assert bindings.read(scene, subject, PIVOT) == before
    snapshot.forget(scene)  # what Keep does
    assert bindings.write(scene, {"light/Point/power": (3.0,)}, subject, PIVOT) == {}
    assert snapshot.revert(scene) == []


def test_a_snapshot_comes_along_with_an_appended_scene(scene, tmp_path):
    subject = scenes.studio(scene)
    scene.name = "Vibed"
    power = bpy.data.lights["Point"].energy
    vibe(scene, subject)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "vibed.blend"))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(str(tmp_path / "vibed.blend")) as (_, here):
        here.scenes = ["Vibed"]
    appended = bpy.data.scenes["Vibed"]
    assert snapshot.exists(appended)
    light = next(o for o in appended.objects if o.name == "Point").data
    assert light.energy != power
    assert snapshot.revert(appended) == []
    assert light.energy == power
    assert not snapshot.exists(appended)


def test_a_snapshot_is_small(scene):
    vibe(scene, scenes.studio(scene))
    assert len(scene[snapshot.KEY]["entries"]) < 30_000


def test_writing_the_values_that_are_there_touches_nothing(scene, kind):
    subject = kind(scene)
    before = dump()
    bindings.write(scene, bindings.read(scene, subject, PIVOT), subject, PIVOT)
    assert changes(before) == {}
