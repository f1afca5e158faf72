# SPDX-License-Identifier: GPL-3.0-or-later
"""Light linking: a lamp lights only its receivers, in the prediction as in Cycles."""

import bpy
import numpy as np
import pytest
import small_scenes as scenes
import torch
from vibe_render.export import reading
from vibe_render.render import anchors
from vibe_render.scene.subject import SubjectChoice

from proxy_renderer.render.cycles import CyclesPicture
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import load_scene


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
