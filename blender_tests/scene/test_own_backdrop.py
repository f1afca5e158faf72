# SPDX-License-Identifier: GPL-3.0-or-later
"""A backdrop of its own for a world without one: made when it moves away from the world, predicted, taken back whole."""

import bpy
import numpy as np
import pytest
import small_scenes as scenes
import torch
from dump import contents, difference
from vibe_render.export import reading
from vibe_render.looks import transfer
from vibe_render.render import anchors
from vibe_render.run.session import result
from vibe_render.scene import bindings, snapshot
from vibe_render.scene.nodes import backgrounds, inputs
from vibe_render.scene.nodes.inputs import TINT
from vibe_render.scene.subject import SubjectChoice

from proxy_renderer.render.cycles import CyclesPicture
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import load_scene
from proxy_renderer.schema import messages

CHOICE = SubjectChoice(("Ball",))
GREEN = (0.1, 0.6, 0.15)


def plain(scene):
    """A world of one color."""
    background = scenes.world(scene).node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (0.4, 0.3, 0.2, 1.0)
    background.inputs["Strength"].default_value = 0.8


def pictured(scene):
    """A picture, red on one half and blue on the other, turned."""
    tree = scenes.world(scene).node_tree
    image = bpy.data.images.new("Sky", 16, 8, float_buffer=True)
    pixels = np.ones((8, 16, 4), np.float32)
    pixels[:, :8, :3], pixels[:, 8:, :3] = (0.9, 0.2, 0.1), (0.1, 0.3, 0.9)
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    nodes = {n: tree.nodes.new(f"ShaderNode{n}") for n in ("TexEnvironment", "Mapping", "TexCoord")}
    nodes["TexEnvironment"].image = image
    nodes["Mapping"].inputs["Rotation"].default_value[2] = 0.5
    tree.links.new(nodes["TexCoord"].outputs["Generated"], nodes["Mapping"].inputs["Vector"])
    tree.links.new(nodes["Mapping"].outputs[0], nodes["TexEnvironment"].inputs["Vector"])
    tree.links.new(nodes["TexEnvironment"].outputs["Color"], tree.nodes["Background"].inputs["Color"])


def from_a_node(scene):
    """Color and strength of nodes that hold them, through a reroute."""
    tree = scenes.world(scene).node_tree
    color, strength, way = (tree.nodes.new(n) for n in ("ShaderNodeRGB", "ShaderNodeValue", "NodeReroute"))
    color.outputs[0].default_value, strength.outputs[0].default_value = (0.3, 0.3, 0.5, 1.0), 0.7
    tree.links.new(color.outputs[0], way.inputs[0])
    tree.links.new(way.outputs[0], tree.nodes["Background"].inputs["Color"])
    tree.links.new(strength.outputs[0], tree.nodes["Background"].inputs["Strength"])


@pytest.fixture(params=[plain, pictured, from_a_node])
def studio(request, scene):
    """A white ball before such a world."""
    fill(scene, request.param)
    return scene


def fill(scene, world):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24)
    scenes.principled("White", bpy.context.object)
    bpy.context.object.name = "Ball"
    scenes.camera(scene, (0.0, -4.0, 0.0))
    world(scene)
    scene.render.resolution_x = scene.render.resolution_y = 64


def exported(scene, folder):
    """The job, its parameters with those of the backdrop, and the place that it is written with."""
    job = reading.export_scene(scene, folder, CHOICE)
    backdrop = {key: i for key, i in job.standby.items() if key.startswith("world/")}
    return job, backdrop, (job.analysis.objects, job.analysis.pivot)


def reopen(tmp_path):
    path = str(tmp_path / "saved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    return bpy.context.scene


def moved(backdrop):
    """A green, dimmer backdrop that is lighter at the horizon, in the parameters that it has."""
    horizon = {"world/backdrop_horizon": (2.0, 1.5, 3.0)}
    green = {key: GREEN if len(i.value) == 3 else (0.5,) for key, i in backdrop.items()}
    return green | {key: value for key, value in horizon.items() if key in backdrop}


def test_it_is_offered_with_the_worlds_values_and_is_no_part_of_the_scene(studio, tmp_path):
    before = contents()
    job, backdrop, place = exported(studio, tmp_path)
    assert not set(backgrounds.WORLD_OF_BACKDROP) & set(job.instances)
    assert len(backdrop) == (2 if "world/backdrop_tint" in backdrop else 3)
    for key, instance in backdrop.items():
        own = job.instances.get(backgrounds.WORLD_OF_BACKDROP[key])
        assert instance.value == (own.value if own else (1.0, 1.0, 1.0))
        assert instance.key == key
    same = {key: i.value for key, i in backdrop.items()}
    assert bindings.write(studio, same, *place) == {}
    assert not backgrounds.has_backdrop(studio.world)
    with bindings.trial(studio, moved(backdrop), *place):
        assert backgrounds.has_backdrop(studio.world)
    snapshot.revert(studio)
    assert difference(before, contents()) == {}


def test_each_of_its_values_makes_it_alone_and_revert_takes_everything_back(studio, tmp_path):
    before = contents()
    _, backdrop, place = exported(studio, tmp_path)
    started = {key: i.value for key, i in backdrop.items()}
    snapshot.revert(studio)
    for key, value in moved(backdrop).items():
        world = bindings.read(studio, *place)
        assert bindings.write(studio, {key: value}, *place) == {}
        now = bindings.read(studio, *place)
        for each in started:
            assert now[each] == pytest.approx(value if each == key else started[each])
        assert {k: v for k, v in now.items() if k not in started} == world
        snapshot.revert(studio)
        assert difference(before, contents()) == {}


def test_light_that_moves_away_leaves_the_backdrop_as_it_was(studio, tmp_path):
    _, backdrop, place = exported(studio, tmp_path)
    started = {key: i.value for key, i in backdrop.items()}
    assert bindings.write(studio, {"world/strength": (2.0,), **started}, *place) == {}
    now = bindings.read(studio, *place)
    assert now["world/strength"] == pytest.approx((2.0,))
    assert now["world/backdrop_strength"] == pytest.approx(started["world/backdrop_strength"])


def test_it_is_there_after_reopening_and_can_still_be_taken_back(studio, tmp_path):
    studio = reopen(tmp_path)  # drops what nothing uses
    before = contents()
    _, backdrop, place = exported(studio, tmp_path)
    assert bindings.write(studio, moved(backdrop), *place) == {}
    studio = reopen(tmp_path)
    again, none, place = exported(studio, tmp_path / "again")
    assert none == {}
    for key, value in moved(backdrop).items():
        assert again.instances[key].value == pytest.approx(value)
    assert bindings.write(studio, {"world/backdrop_strength": (0.9,)}, *place) == {}
    assert snapshot.revert(studio) == []
    assert difference(before, contents()) == {}


def test_a_tint_that_was_kept_is_where_it_starts(scene, tmp_path):
    fill(scene, pictured)
    _, _, place = exported(scene, tmp_path)
    bindings.write(scene, {"world/tint": (0.5, 1.2, 0.8)}, *place)
    snapshot.forget(scene)
    before = contents()
    _, backdrop, place = exported(scene, tmp_path)
    assert backdrop["world/backdrop_tint"].value == pytest.approx((0.5, 1.2, 0.8))
    assert bindings.write(scene, {"world/backdrop_strength": (0.4,)}, *place) == {}
    now = bindings.read(scene, *place)
    assert now["world/backdrop_tint"] == pytest.approx((0.5, 1.2, 0.8))
    bindings.write(scene, {"world/backdrop_tint": GREEN}, *place)
    assert bindings.read(scene, *place)["world/tint"] == pytest.approx((0.5, 1.2, 0.8))
    assert len([n for n in scene.world.node_tree.nodes if inputs._inset_name(n) == TINT.name]) == 2
    snapshot.revert(scene)
    assert difference(before, contents()) == {}


@pytest.mark.parametrize(
    "again", [pytest.param(False, id="on standby"), pytest.param(True, id="exported again", marks=pytest.mark.slow)]
)
def test_the_proxy_sees_what_cycles_renders(studio, tmp_path, again):
    _, backdrop, place = exported(studio, tmp_path)
    values = moved(backdrop)
    if again:
        bindings.write(studio, values, *place)
        exported(studio, tmp_path)
    data = load_scene(tmp_path)
    data = data if again else data.with_backdrop()
    steps = [values, {**values, "world/strength": (1.5,)}]
    if "world/rotation" in data.instances:
        steps.append({**values, "world/rotation": (120.0,)})
    for step in steps:
        groups = anchors.render_anchor(studio, tmp_path / "a.exr", step, *place, 64, 64)
        cycles = CyclesPicture.load(tmp_path / "a.exr", groups).whole.numpy()
        with torch.no_grad():
            tensors = {k: torch.tensor(v) for k, v in step.items()}
            predicted = Proxy(data, (64, 64)).render(tensors).linear.numpy()
        for part in (np.s_[:8, :24], np.s_[:8, -24:], np.s_[-8:, :24], np.s_[-8:, -24:], np.s_[28:36, 28:36]):
            a, b = cycles[part].mean((0, 1)), predicted[part].mean((0, 1))
            assert (np.abs(a - b) < 0.06 * a.max()).all(), (step, a, b)


@pytest.mark.parametrize("hide", ["wall", "film", "driver", "parted"])
def test_it_is_not_offered_where_it_would_not_be_seen_or_not_be_ours(scene, tmp_path, hide):
    fill(scene, plain)
    if hide == "wall":
        scenes.cube(scene, "Wall", (0.0, 30.0, 0.0), 25.0)
    elif hide == "film":
        scene.render.film_transparent = True
    elif hide == "driver":
        scene.world.node_tree.nodes["Background"].inputs["Strength"].driver_add("default_value")
    else:
        scenes.backdrop(scene.world)
    assert exported(scene, tmp_path)[1] == {}


def test_a_preset_brings_it_to_another_scene(scene, tmp_path):
    fill(scene, plain)
    job, backdrop, _ = exported(scene, tmp_path)
    values = moved(backdrop)
    look = transfer.extract_look("green background", job.with_additions_of(values), values)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for world, color in ((plain, "color"), (pictured, "tint")):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        fill(bpy.context.scene, world)
        read = reading.prepare_and_read(bpy.context.scene, CHOICE)
        fitted = transfer.fit_look(look, read)
        assert fitted.rest == []
        horizon = {"world/backdrop_horizon"} if world is plain else set()  # a picture has its own
        assert set(fitted.values) == {f"world/backdrop_{color}", "world/backdrop_strength"} | horizon
        assert bindings.write(bpy.context.scene, fitted.values, read.analysis.objects, read.analysis.pivot) == {}
        assert backgrounds.has_backdrop(bpy.context.scene.world)


def test_its_horizon_stays_where_it_was_made(scene, tmp_path):
    fill(scene, plain)
    scene.camera.rotation_euler = (1.7, 0.0, 0.0)
    _, backdrop, place = exported(scene, tmp_path)
    made = load_scene(tmp_path).world.horizon
    bindings.write(scene, moved(backdrop), *place)
    scene.camera.rotation_euler = (1.5, 0.0, 0.0)
    exported(scene, tmp_path / "again")
    assert load_scene(tmp_path / "again").world.horizon == pytest.approx(made)


@pytest.mark.parametrize("turn", [(1.1, 0.0, 0.0), (1.75, 0.2, 0.0), "orthographic"])
def test_its_horizon_is_where_the_cameras_is(scene, tmp_path, turn):
    fill(scene, plain)
    if turn == "orthographic":
        scene.camera.data.type = "ORTHO"
    else:
        scene.camera.rotation_euler = turn
    _, backdrop, place = exported(scene, tmp_path)
    values = moved(backdrop)
    groups = anchors.render_anchor(scene, tmp_path / "a.exr", values, *place, 64, 64)
    cycles = CyclesPicture.load(tmp_path / "a.exr", groups).whole.numpy()
    proxy = Proxy(load_scene(tmp_path).with_backdrop(), (64, 64))
    with torch.no_grad():
        predicted = proxy.render({k: torch.tensor(v) for k, v in values.items()}).linear.numpy()
    rows, predicted = (picture[2:-2, np.r_[0:6, 58:64]].mean((1, 2)) for picture in (cycles, predicted))
    assert rows == pytest.approx(predicted, rel=0.02)
    assert np.ptp(rows) > 0.1


def test_the_list_of_changes_starts_from_the_world_and_so_does_the_slider(addon):
    before = contents()
    place = [addon.objects["Subject"]], (0.0, 0.0, 0.5)
    own = bindings.read(addon, *place)
    values = {"world/backdrop_color": list(GREEN), "world/backdrop_strength": [0.5]}
    result.apply(addon, "green background", messages.Result(values, {}, ""), *place)
    for change in addon.vibe.changes:
        old, new = change.values()
        assert old == pytest.approx(own[backgrounds.WORLD_OF_BACKDROP[change.name]])
        assert new == pytest.approx(values[change.name])
    addon.vibe.show_original = True
    now = bindings.read(addon, *place)
    assert now["world/backdrop_color"] == pytest.approx(own["world/color"])
    assert now["world/backdrop_strength"] == pytest.approx(own["world/strength"])
    assert result.revert(addon) == []
    assert difference(before, contents()) == {}
