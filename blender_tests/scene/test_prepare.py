# SPDX-License-Identifier: GPL-3.0-or-later
"""What a scene lacks is added so that there is a picture, and nothing is added that it has."""

import bpy
import numpy as np
import pytest
import small_scenes as scenes
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Vector
from vibe_render.core import compat
from vibe_render.core.schema_import import schema
from vibe_render.scene import bindings, prepare, snapshot
from vibe_render.scene.nodes import owned

PIVOT = (0.0, 0.0, 0.0)


def test_a_bare_mesh_gets_everything(scene):
    subject = scenes.bare(scene)
    prepare.prepare_scene(scene, subject)
    added = snapshot.mark(scene)
    assert scene.world
    assert owned.MARK in scene.camera
    assert subject[0].material_slots[0].material
    parameters = bindings.instances(scene, subject, PIVOT)
    assert parameters["light/Vibe Key/power"].role == "key"
    assert parameters["light/Vibe Key/power"].value[0] > 0.0
    prepare.prepare_scene(scene, subject)
    assert snapshot.mark(scene) == added


@pytest.mark.parametrize("size", [(1920, 1080), (600, 1200)])
@pytest.mark.parametrize("scale", [0.01, 1.0, 300.0])
def test_the_new_camera_sees_the_whole_subject(scene, size, scale):
    scene.render.resolution_x, scene.render.resolution_y = size
    subject = scenes.cube(scene, "Cube", (3.0, 2.0, 1.0), scale)
    prepare.prepare_scene(scene, [subject])
    corners = [world_to_camera_view(scene, scene.camera, subject.matrix_world @ Vector(c)) for c in subject.bound_box]
    assert all(0.0 < p.x < 1.0 and 0.0 < p.y < 1.0 for p in corners)
    assert max(p.x for p in corners) - min(p.x for p in corners) > 0.2
    data = scene.camera.data
    assert all(data.clip_start < p.z < data.clip_end for p in corners)


def test_a_new_key_light_exposes_a_gray_subject_well(scene, tmp_path):
    subject = scenes.bare(scene)
    prepare.prepare_scene(scene, subject)
    scene.render.engine, scene.cycles.samples = "CYCLES", 16
    scene.render.resolution_x = scene.render.resolution_y = 32
    scene.render.filepath = str(tmp_path / "out.png")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    middle = np.array(image.pixels[:]).reshape(32, 32, 4)[10:22, 10:22, :3]
    assert 0.3 < middle.mean() < 0.85


def test_a_scene_that_its_world_lights_keeps_its_look(scene):
    subject = scenes.bare(scene)
    scenes.world(scene).node_tree.nodes["Background"].inputs["Color"].default_value = (0.5, 0.5, 0.5, 1.0)
    prepare.prepare_scene(scene, subject)
    assert bpy.data.lights["Vibe Key"].energy == 0.0


def test_nothing_is_added_to_a_scene_that_has_all(scene):
    prepare.prepare_scene(scene, scenes.studio(scene))
    assert not snapshot.exists(scene)


def test_a_rim_light_comes_when_values_are_for_it_and_goes_with_revert(scene):
    subject = scenes.studio(scene)
    values = {"light/Vibe Rim/power": (77.0,), "light/Vibe Rim/color": (0.1, 0.2, 1.0)}
    assert bindings.write(scene, values, subject, PIVOT) == {}
    parameters = bindings.instances(scene, subject, PIVOT)
    assert parameters["light/Vibe Rim/power"].value == (77.0,)
    assert parameters["light/Vibe Rim/power"].role == "rim"
    snapshot.revert(scene)
    assert "Vibe Rim" not in bpy.data.objects
    assert "Vibe Rim" not in bpy.data.lights


@pytest.mark.skipif(compat.COMPOSITOR_IS_GROUP, reason="Blender 5 has no materials without nodes")
def test_a_material_without_nodes_has_its_color(scene):
    subject = scenes.bare(scene)
    plain = bpy.data.materials.new("Plain")
    subject[0].data.materials.append(plain)
    assert bindings.write(scene, {"material/Plain/base_color": (0.1, 0.2, 0.3)}, subject, PIVOT) == {}
    assert tuple(plain.diffuse_color) == pytest.approx((0.1, 0.2, 0.3, 1.0))


@pytest.mark.parametrize("kind", ["AREA", "SPOT"])
def test_a_light_for_the_background_faces_away_from_the_subject(scene, kind):
    subject = scenes.bare(scene)
    prepare.prepare_scene(scene, subject)
    name = schema.added_lights.light_name("background", kind)
    for azimuth in (170.0, 60.0):
        bindings.write(scene, {f"light/{name}/azimuth": (azimuth,)}, subject, PIVOT)
        turned = scene.objects[name].matrix_world
        shines, away = turned.to_3x3() @ Vector((0.0, 0.0, -1.0)), turned.translation.normalized()
        assert shines.normalized().dot(away) > 0.7
        assert shines.z < 0.0  # the floor before a wall is lit too
