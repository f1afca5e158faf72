# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps inside collections that instances show are lights of the scene: one owner, as many places."""

import bpy
import pytest
import small_scenes as scenes
import torch
from vibe_render.export import reading
from vibe_render.render import anchors
from vibe_render.scene import bindings
from vibe_render.scene.subject import SubjectChoice

from proxy_renderer.render.cycles import CyclesPicture
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import load_scene


@pytest.fixture
def street(scene):
    """A cube between two instances of a collection that holds a lamp."""
    scenes.principled("Paint", scenes.cube(scene, "Cube", (0.0, 0.0, 0.0), 2.0))
    floor = scenes.cube(scene, "Floor", (0.0, 0.0, -11.0), 20.0)
    scenes.principled("Ground", floor)
    scenes.camera(scene, (0.0, -8.0, 1.0))
    scenes.world(scene).node_tree.nodes["Background"].inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    inside = bpy.data.collections.new("Lamp")
    data = bpy.data.lights.new("Bulb", "POINT")
    data.energy, data.shadow_soft_size = 300.0, 0.3
    inside.objects.link(bpy.data.objects.new("Bulb", data))
    for x in (-3.0, 3.0):
        lamp = bpy.data.objects.new("Street Lamp", None)
        lamp.instance_type, lamp.instance_collection, lamp.location = "COLLECTION", inside, (x, -2.0, 2.0)
        scene.collection.objects.link(lamp)
    scene.render.resolution_x = scene.render.resolution_y = 64
    return scene


def test_they_are_one_owner_without_an_orbit(street, tmp_path):
    job = reading.export_scene(street, tmp_path, SubjectChoice(("Cube",)))
    assert "Vibe Key" not in street.objects
    names = {key.rpartition("/")[2] for key in job.instances if key.startswith("light/Bulb/")}
    assert {"power", "color", "size"} <= names
    assert not names & {"azimuth", "elevation", "distance"}
    bindings.write(street, {"light/Bulb/power": (120.0,)}, job.analysis.objects, job.analysis.pivot)
    assert abs(bpy.data.lights["Bulb"].energy - 120.0) < 1e-3


def test_they_light_the_prediction_from_where_they_are(street, tmp_path):
    job = reading.export_scene(street, tmp_path, SubjectChoice(("Cube",)))
    scene = load_scene(tmp_path)
    assert [light.name for light in scene.lights] == ["Bulb", "Bulb"]
    groups = anchors.render_anchor(street, tmp_path / "a.exr", {}, job.analysis.objects, job.analysis.pivot, 64, 32)
    picture = CyclesPicture.load(tmp_path / "a.exr", groups)
    whole, theirs = picture.whole, picture.parts["light/Bulb"]
    assert abs(theirs.mean() / whole.mean() - 1.0) < 0.02
    with torch.no_grad():
        predicted = Proxy(scene, (64, 64)).render({}).linear
    assert abs(predicted.mean() / whole.mean() - 1.0) < 0.1
    left, right = predicted[:, :32].mean(), predicted[:, 32:].mean()
    assert abs(left / right - 1.0) < 0.1
