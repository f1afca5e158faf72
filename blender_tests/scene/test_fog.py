# SPDX-License-Identifier: GPL-3.0-or-later
"""Fog in its box has the density it says, leaves the world its light, and costs nothing where there is none."""

import bpy
import numpy as np
import pytest
import small_scenes as scenes
from mathutils import Vector
from vibe_render.scene import bindings, fog, scene_context, snapshot
from vibe_render.scene.nodes import owned

SIZE = 24
PIVOT = (0.0, 0.0, 0.0)
DISTANCE = 6.0  # from the camera to the wall
VIEW = 4.0  # height of the picture, meters


def write(scene, subject, **values):
    keyed = {f"volume/{name}": np.atleast_1d(value) for name, value in values.items()}
    assert bindings.write(scene, keyed, subject, PIVOT) == {}


def rendered(scene, tmp_path, samples=16):
    """(H, W, 3) linear, row 0 at the bottom."""
    scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", samples, False
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    settings = scene.render.image_settings
    settings.file_format, settings.color_depth, settings.exr_codec = "OPEN_EXR", "32", "ZIP"
    scene.render.filepath = str(tmp_path / "out.exr")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    pixels = np.array(image.pixels[:]).reshape(SIZE, SIZE, 4)[..., :3]
    bpy.data.images.remove(image)
    return pixels


@pytest.fixture
def wall(scene):
    """A glowing wall across the view of an orthographic camera whose rays are level; the subject is out of its way."""
    plane = scenes.cube(scene, "Wall", (0.0, DISTANCE / 2.0 + 4.0, 0.0), 8.0)
    material = scenes.principled("Glow", plane)
    scenes.shader(material).inputs["Base Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    scenes.shader(material).inputs["Emission Strength"].default_value = 1.0
    scenes.shader(material).inputs["Specular IOR Level"].default_value = 0.0
    camera = scenes.camera(scene, (0.0, -DISTANCE / 2.0, 0.0))
    camera.rotation_euler[0] = np.pi / 2.0
    camera.data.type, camera.data.ortho_scale = "ORTHO", VIEW
    scenes.light(scene, "POINT").data.energy = 0.0
    return scene, [scenes.cube(scene, "Subject", (9.0, 0.0, 0.0), 2.0)]


@pytest.mark.parametrize(
    "values",
    [
        {"density": 0.15},
        {"density": 0.3, "falloff": 0.8, "offset": 0.5},
        {"density": 0.2, "falloff": 3.0, "offset": 0.0},
    ],
    ids=["even", "height", "thin"],
)
def test_extinction(wall, tmp_path, values):
    scene, subject = wall
    write(scene, subject, color=(0.0, 0.0, 0.0), **values)  # absorbs only; but there was no fog to have a color
    write(scene, subject, color=(0.0, 0.0, 0.0))
    transmitted = rendered(scene, tmp_path, samples=64).mean(axis=(1, 2))
    height = ((np.arange(SIZE) + 0.5) / SIZE - 0.5) * VIEW
    above = np.maximum(height - (-1.0) - values.get("offset", 0.0), 0.0)  # the subject's base is at -1
    extinction = values["density"] * np.exp(-values.get("falloff", 0.0) * above)
    np.testing.assert_allclose(transmitted, np.exp(-extinction * DISTANCE), atol=0.02)


def test_color_is_the_albedo(wall, tmp_path):
    scene, subject = wall
    scenes.shader(bpy.data.materials["Glow"]).inputs["Emission Strength"].default_value = 0.0
    sun = scenes.light(scene, "SUN")
    sun.data.energy, sun.rotation_euler = 10.0, (0.0, 0.0, 0.0)
    write(scene, subject, density=0.1, color=(0.8, 0.4, 0.2))
    glow = rendered(scene, tmp_path, samples=64)[SIZE // 2].mean(axis=0)
    assert glow[0] > 0.02
    np.testing.assert_allclose(glow / glow[0], (1.0, 0.5, 0.25), rtol=0.02)


def test_the_world_shines_through_and_through_a_world_volume_it_does_not(scene, tmp_path):
    subject = [scenes.cube(scene, "Subject")]
    scenes.camera(scene)
    tree = scenes.world(scene).node_tree
    tree.nodes["Background"].inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    write(scene, subject, density=0.03)
    assert rendered(scene, tmp_path).mean() > 0.3
    snapshot.revert(scene)
    volume = tree.nodes.new("ShaderNodeVolumePrincipled")
    volume.inputs["Density"].default_value = 0.03
    tree.links.new(volume.outputs["Volume"], tree.nodes["World Output"].inputs["Volume"])
    assert rendered(scene, tmp_path).mean() < 1e-6


def test_no_box_without_density(scene):
    subject = scenes.studio(scene)
    write(scene, subject, density=0.0, color=(0.1, 0.2, 0.3), falloff=1.0)
    assert fog.find_fog(scene) is None
    assert not snapshot.exists(scene)


def test_the_box_holds_camera_and_subject_and_is_out_of_the_artists_way(scene):
    subject = scenes.studio(scene)
    scene.camera.location = (0.0, -30.0, 12.0)
    context = scene_context.SceneContext(scene, subject, Vector(PIVOT))
    planned = fog.fog_domain(context)
    write(scene, subject, density=0.1, color=(0.1, 0.2, 0.3))
    box = fog.find_fog(scene)
    assert (box.display_type, box.hide_select, box.name, box.hide_render) == ("WIRE", True, "Vibe Fog", False)
    box_domain = fog.fog_domain(context)
    for a, b in zip(planned.center, box_domain.center, strict=True):
        assert a == pytest.approx(b, abs=1e-4)
    for a, b in zip(planned.half_size, box_domain.half_size, strict=True):
        assert a == pytest.approx(b, abs=1e-4)
    assert box_domain.base == planned.base == pytest.approx(0.0, abs=1e-6)
    low, high = box_domain.center - box_domain.half_size, box_domain.center + box_domain.half_size
    for point in (scene.camera.location, *(subject[0].matrix_world @ Vector(c) for c in subject[0].bound_box)):
        assert all(a < p < b for a, p, b in zip(low, point, high, strict=True))
    assert box not in scene_context.meshes(scene)
    assert not [i for i in bindings.instances(scene, subject, PIVOT).values() if i.owner == "Vibe Fog"]


def test_density_0_hides_the_box_and_density_shows_it_again(scene):
    subject = scenes.studio(scene)
    write(scene, subject, density=0.1)
    write(scene, subject, density=0.0)
    assert fog.find_fog(scene).hide_render
    assert bindings.read(scene, subject, PIVOT)["volume/density"] == (0.0,)
    write(scene, subject, density=0.2)
    assert not fog.find_fog(scene).hide_render
    assert len([o for o in bpy.data.objects if o.get(owned.MARK) == owned.FOG]) == 1


def test_the_artists_world_volume_is_used(scene):
    subject = scenes.foggy(scene)
    parameters = bindings.instances(scene, subject, PIVOT)
    assert parameters["volume/density"].value == pytest.approx((0.03,))
    assert "volume/falloff" not in parameters
    write(scene, subject, density=0.2, anisotropy=0.4)
    volume = scene.world.node_tree.nodes["Principled Volume"]
    assert volume.inputs["Density"].default_value == pytest.approx(0.2)
    assert fog.find_fog(scene) is None
