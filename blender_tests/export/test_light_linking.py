# SPDX-License-Identifier: GPL-3.0-or-later
"""Light linking: a lamp lights only its receivers, in the prediction as in Cycles."""

import bpy
import numpy as np
import pytest
import small_scenes as scenes
import torch
from dump import difference, dump
from vibe_render.export import reading
from vibe_render.render import anchors
from vibe_render.scene import bindings, light_links, snapshot
from vibe_render.scene.subject import SubjectChoice

from proxy_renderer.render.cycles import CyclesPicture
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import load_scene
from proxy_renderer.schema.light_links import LightLink


@pytest.fixture
def balls(scene):
    """Two white balls on a floor, a lamp above them, and a faint second one."""
    for name, x in (("Left", -1.2), ("Right", 1.2)):
        bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, location=(x, 0.0, 0.0))
        bpy.context.object.name = name
        scenes.principled(name, bpy.context.object)
    scenes.principled("Floor", scenes.cube(scene, "Floor", (0.0, 0.0, -6.0), 10.0))
    scenes.camera(scene, (0.0, -7.0, 0.5))
    scenes.world(scene).node_tree.nodes["Background"].inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    for kind, place, watts in (("POINT", (0.0, -2.0, 4.0), 800.0), ("SPOT", (0.0, -6.0, 0.0), 60.0)):
        lamp = scenes.light(scene, kind, place)
        lamp.data.energy, lamp.data.shadow_soft_size = watts, 0.2
    scene.objects["Spot"].rotation_euler = (1.57, 0.0, 0.0)
    scene.render.resolution_x, scene.render.resolution_y = 96, 48
    return scene


def link(scene, state, child):
    """Links the lamp to the left ball."""
    receivers = bpy.data.collections.new("Receivers")
    scene.objects["Point"].light_linking.receiver_collection = receivers
    if state == "EMPTY":
        return
    holder = receivers
    if child:
        holder = bpy.data.collections.new("Inner")
        receivers.children.link(holder)
    holder.objects.link(scene.objects["Left"])
    rows = receivers.collection_children if child else receivers.collection_objects
    rows[0].light_linking.link_state = state


@pytest.mark.parametrize(
    ("state", "child", "unlit"),
    [
        ("INCLUDE", False, {"Right", "Floor"}),
        ("EXCLUDE", False, {"Left"}),
        ("EXCLUDE", True, {"Left"}),
        ("EMPTY", False, set()),
    ],
)
def test_a_linked_lamp_lights_its_receivers_only(balls, tmp_path, state, child, unlit):
    link(balls, state, child)
    job = reading.export_scene(balls, tmp_path, SubjectChoice(("Left",)))
    assert not any("linked" in warning for warning in job.warnings)
    data = load_scene(tmp_path)
    lamp = next(light for light in data.lights if light.name == "Point")
    assert {data.objects[number].name for number in lamp.unlit} == unlit
    place = job.analysis.objects, job.analysis.pivot
    groups = anchors.render_anchor(balls, tmp_path / "a.exr", {}, *place, 96, 128)
    cycles = CyclesPicture.load(tmp_path / "a.exr", groups).whole.numpy()
    with torch.no_grad():
        predicted = Proxy(data, (96, 48)).render({}).linear.numpy()
    for part in (np.s_[18:26, 26:34], np.s_[18:26, 62:70], np.s_[-6:]):  # the balls, the floor
        a, b = cycles[part].mean(), predicted[part].mean()
        assert abs(a - b) < 0.1 * a + 0.01, (part, a, b)


def test_linked_shadows_and_glows_are_said_to_be_left_out(balls, tmp_path):
    lamp, left = balls.objects["Point"], balls.objects["Left"]
    lamp.light_linking.blocker_collection = bpy.data.collections.new("Blockers")
    left.light_linking.receiver_collection = bpy.data.collections.new("Receivers")
    scenes.shader(bpy.data.materials["Left"]).inputs["Emission Strength"].default_value = 2.0
    warnings = "\n".join(reading.export_scene(balls, tmp_path, SubjectChoice(("Left",))).warnings)
    assert "Shadow linking of Point is left out" in warnings
    assert "Left is linked to some objects" in warnings


def linking(light):
    """The names of a light's receivers by state."""
    found = light_links.states(light.light_linking.receiver_collection)
    return {state: {o.name for o in objects} for state, objects in found.items()}


@pytest.mark.parametrize("own", ["", "EXCLUDE"])
def test_links_of_words_are_written_predicted_and_reverted(balls, tmp_path, own):
    """Also those of a light that the artist has linked."""
    if own:
        link(balls, own, child=False)
    reading.export_scene(balls, tmp_path / "before", SubjectChoice(("Left",)))
    snapshot.forget(balls)
    before, lamp = dump(), balls.objects["Point"]
    links = LightLink("Point", False, ("Floor",)), LightLink("Spot", True, ("Right",))
    predicted = load_scene(tmp_path / "before")
    for each in links:
        predicted = predicted.with_link(each, "'not on the floor'")
    values = {each.key: [1.0] for each in links}
    assert bindings.write(balls, values, (), (0.0, 0.0, 0.0)) == {}
    assert linking(lamp) == {"INCLUDE": set(), "EXCLUDE": {"Floor", *(["Left"] if own else [])}}
    assert linking(balls.objects["Spot"])["INCLUDE"] == {"Right"}
    reading.export_scene(balls, tmp_path / "after", SubjectChoice(("Left",)))
    assert [x.unlit for x in load_scene(tmp_path / "after").lights] == [x.unlit for x in predicted.lights]

    bindings.write(balls, {key: [0.0] for key in values}, (), (0.0, 0.0, 0.0))  # a step that is switched off
    assert balls.objects["Spot"].light_linking.receiver_collection is None
    assert linking(lamp)["EXCLUDE"] == ({"Left"} if own else set())
    assert snapshot.revert(balls) == []
    assert difference(before, dump()) == {}


def test_a_light_that_cannot_be_linked_is_said(balls):
    key = LightLink("Lantern", True, ("Left",)).key
    assert bindings.write(balls, {key: [1.0]}, (), (0.0, 0.0, 0.0)) == {key: "there is no such light in this scene"}
