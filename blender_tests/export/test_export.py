# SPDX-License-Identifier: GPL-3.0-or-later
"""What is written to the job folder, against what the scene was made of."""

import json
from pathlib import Path

import bpy
import numpy as np
import pytest
from dump import difference, dump
from mathutils import Matrix
from vibe_render.export import reading, world_light
from vibe_render.export.textures import shrink
from vibe_render.export.view import ocio_config
from vibe_render.render import bake
from vibe_render.scene.subject import SubjectChoice

from proxy_renderer.scene import load_scene
from proxy_renderer.schema import VibeError


@pytest.fixture
def stage(scene):
    """A camera at (0, -6, 0) that looks along +Y, and a light."""
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.matrix_world = Matrix.Translation((0, -6, 0)) @ Matrix.Rotation(np.pi / 2, 4, "X")
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
    lamp.location = (2, -3, 3)
    for thing in (camera, lamp):
        scene.collection.objects.link(thing)
    scene.camera = camera
    scene.render.resolution_x, scene.render.resolution_y = 64, 48
    return scene


def cube(name="Cube", location=(0, 0, 0), size=2.0):
    bpy.ops.mesh.primitive_cube_add(size=size, location=location)
    bpy.context.object.name = name
    return bpy.context.object


def material(name, thing):
    new_material = bpy.data.materials.new(name)
    new_material.use_nodes = True
    thing.data.materials.append(new_material)
    return new_material, new_material.node_tree, new_material.node_tree.nodes["Principled BSDF"]


def contents():
    """The file's data but for the picture that every render leaves."""
    return {path: value for path, value in dump().items() if "[Render Result]" not in path}


def job_of(scene, tmp_path, choice=None):
    job = reading.export_scene(scene, tmp_path / "job", choice or SubjectChoice())
    return job, load_scene(tmp_path / "job")


def test_modifiers_are_those_of_the_final_render(stage, tmp_path):
    smooth = cube().modifiers.new("Smooth", "SUBSURF")
    smooth.levels, smooth.render_levels = 0, 2
    _, scene = job_of(stage, tmp_path)
    assert len(scene.mesh.faces) == 6 * 4**2 * 2


def test_hidden_things_are_left_out_and_instances_are_placed(stage, tmp_path):
    cube("Gone", (0, 0, 0)).hide_render = True
    original = cube("Original", (-1, 0, 0), size=0.5)
    group = bpy.data.collections.new("Group")
    group.objects.link(original)
    stage.collection.objects.unlink(original)
    for number, place in enumerate(((-0.5, 0, 0), (2.5, 0, 1))):
        copy = bpy.data.objects.new(f"Copy {number}", None)
        copy.instance_type, copy.instance_collection, copy.location = "COLLECTION", group, place
        stage.collection.objects.link(copy)
    _, scene = job_of(stage, tmp_path)
    assert [o.name for o in scene.objects] == ["Original", "Original"]
    low, high = scene.mesh.vertices.min(0), scene.mesh.vertices.max(0)
    np.testing.assert_allclose(low, (-1.75, -0.25, -0.25), atol=1e-5)
    np.testing.assert_allclose(high, (1.75, 0.25, 1.25), atol=1e-5)


@pytest.mark.parametrize(("strength", "is_light"), [(7.0, True), (0.0, False)])
def test_a_softbox_that_the_camera_does_not_see_comes_with_its_light(stage, tmp_path, strength, is_light):
    """Behind the camera, and hidden from it: its values light the picture, and a vibe may turn it while it glows."""
    cube()
    softbox = cube("Softbox", (0, -9, 0))
    softbox.visible_camera = softbox.visible_shadow = False
    _, _, shader = material("Soft", softbox)
    shader.inputs["Emission Strength"].default_value = strength
    job, scene = job_of(stage, tmp_path)
    assert {o.name: o.hidden for o in scene.objects} == {"Cube": (), "Softbox": ("camera", "shadow")}
    assert scene.value("material/Soft/emission") == pytest.approx((strength,))
    assert ("material/Soft/emission" in scene.instances) == is_light
    assert not job.warnings


def test_what_is_hidden_from_the_camera_is_not_the_subject(stage, tmp_path):
    cube("Seen", (0, 3, 0))
    cube("Unseen", (0, 0, 0)).visible_camera = False
    _, scene = job_of(stage, tmp_path)
    assert {o.name: o.subject for o in scene.objects} == {"Seen": True, "Unseen": False}


def test_curves_texts_and_metaballs_come_once(stage, tmp_path):
    bpy.ops.object.text_add(location=(-1, 0, 0), rotation=(np.pi / 2, 0, 0))
    bpy.context.object.data.extrude = 0.1
    bpy.ops.curve.primitive_bezier_circle_add(location=(1, 0, 0))
    bpy.context.object.data.bevel_depth = 0.1
    bpy.ops.object.metaball_add(location=(0, 0, -1), radius=0.5)
    _, scene = job_of(stage, tmp_path)
    assert sorted(o.name for o in scene.objects) == ["BézierCircle", "Mball", "Text"]
    corners = np.sort(scene.mesh.vertices[scene.mesh.faces].reshape(-1, 9).round(4), axis=1)
    assert len(np.unique(corners, axis=0)) > 0.8 * len(corners)  # nothing lies twice in one place


@pytest.mark.parametrize("scale", [(1, 1, 1), (-1, 1, 1), (2, -0.5, 1)])
def test_normals_point_outwards_also_when_mirrored(stage, tmp_path, scale):
    cube().scale = scale
    _, scene = job_of(stage, tmp_path)
    corners = scene.mesh.vertices[scene.mesh.faces]
    facet = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    facet /= np.linalg.norm(facet, axis=1, keepdims=True)
    outwards = corners.mean(1) / np.linalg.norm(corners.mean(1), axis=1, keepdims=True)
    assert (np.sum(facet * outwards, 1) > 0).all()
    np.testing.assert_allclose(scene.mesh.normals, np.repeat(facet[:, None], 3, 1), atol=1e-5)


def test_custom_normals_survive(stage, tmp_path):
    mesh = cube().data
    tilted = np.array([0.0, -0.6, 0.8])
    mesh.normals_split_custom_set([tilted] * len(mesh.loops))
    _, scene = job_of(stage, tmp_path)
    np.testing.assert_allclose(scene.mesh.normals.reshape(-1, 3), np.tile(tilted, (36, 1)), atol=2e-3)


def test_each_face_has_its_material_and_its_role(stage, tmp_path):
    thing = cube()
    for name in ("Red", "Blue"):
        material(name, thing)
    thing.data.polygons[0].material_index = 1
    floor = cube("Floor", (0, 0, -1.1), size=1.0)
    floor.scale = (20, 20, 0.1)
    material("Ground", floor)
    _, scene = job_of(stage, tmp_path)
    names = [scene.materials[i].name for i in scene.mesh.material]
    assert (names.count("Red"), names.count("Blue"), names.count("Ground")) == (10, 2, 12)
    assert {m.name: m.role for m in scene.materials} == {"Red": "subject", "Blue": "subject", "Ground": "surroundings"}
    assert {o.name: o.subject for o in scene.objects} == {"Cube": True, "Floor": False}
    np.testing.assert_allclose(scene.pivot, (0, 0, 0), atol=1e-5)


def test_image_textures_are_linear_and_mapped(stage, tmp_path):
    _, tree, shader = material("Painted", cube())
    image = bpy.data.images.new("Paint", 4, 2)
    image.pixels.foreach_set(np.tile(np.float32([0.5, 0.25, 1.0, 1.0]), 8))
    texture, mapping = tree.nodes.new("ShaderNodeTexImage"), tree.nodes.new("ShaderNodeMapping")
    uv = tree.nodes.new("ShaderNodeTexCoord")
    texture.image = image
    mapping.inputs["Scale"].default_value, mapping.inputs["Location"].default_value = (2, 3, 1), (0.5, 0, 0)
    tree.links.new(uv.outputs["UV"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], shader.inputs["Base Color"])
    job, scene = job_of(stage, tmp_path)
    assert scene.materials[0].texture.image.shape == (2, 4, 3)
    np.testing.assert_allclose(scene.materials[0].texture.image[0, 0], (0.2140, 0.0508, 1.0), atol=2e-3)
    np.testing.assert_allclose(scene.mesh.uvs.reshape(-1, 2).max(0), (0.875 * 2 + 0.5, 1.0 * 3), atol=1e-5)
    assert job.warnings == []
    assert "material/Painted/tint" in scene.instances
    assert "material/Painted/base_color" not in scene.instances


def test_a_network_over_uvs_is_baked(stage, tmp_path):
    _, tree, shader = material("Checked", cube())
    checker, uv = tree.nodes.new("ShaderNodeTexChecker"), tree.nodes.new("ShaderNodeTexCoord")
    checker.inputs["Color1"].default_value, checker.inputs["Color2"].default_value = ((1, 0, 0, 1), (0, 0, 0.5, 1))
    checker.inputs["Scale"].default_value = 2.0
    tree.links.new(uv.outputs["UV"], checker.inputs["Vector"])
    tree.links.new(checker.outputs["Color"], shader.inputs["Base Color"])
    _, scene = job_of(stage, tmp_path)
    image = scene.materials[0].texture.image
    quarter = image.shape[0] // 4
    corners = image[quarter :: 2 * quarter, quarter :: 2 * quarter][:2, :2]
    np.testing.assert_allclose(corners[0, 0], (0, 0, 0.5), atol=0.02)  # at u = v = 1/4
    np.testing.assert_allclose(corners[0, 1], (1, 0, 0), atol=0.02)
    np.testing.assert_allclose(corners[1, 1], (0, 0, 0.5), atol=0.02)


def test_other_networks_come_as_the_camera_sees_them(stage, tmp_path):
    _, tree, shader = material("Veined", cube(size=2.0))
    split, position = tree.nodes.new("ShaderNodeSeparateXYZ"), tree.nodes.new("ShaderNodeNewGeometry")
    tree.links.new(position.outputs["Position"], split.inputs["Vector"])
    greater = tree.nodes.new("ShaderNodeMath")
    greater.operation = "GREATER_THAN"
    greater.inputs[1].default_value = 0.0
    tree.links.new(split.outputs["X"], greater.inputs[0])  # white on the right half, black on the left
    for socket in ("Base Color", "Roughness", "Sheen Weight"):
        tree.links.new(greater.outputs["Value"], shader.inputs[socket])
    job, scene = job_of(stage, tmp_path)
    row = scene.materials[0]
    assert row.texture.window is not None
    for texture in (row.texture, row.maps["roughness"]):
        middle = texture.image[texture.image.shape[0] // 2]
        quarter = len(middle) // 4
        np.testing.assert_allclose(middle[2:quarter], 0.0, atol=1e-6)
        np.testing.assert_allclose(middle[-quarter:-2], 1.0, atol=1e-6)
    roughness = scene.instances["material/Veined/roughness"]
    assert roughness.value[0] == pytest.approx(0.5, abs=0.06)
    assert roughness.locked
    assert scene.value("material/Veined/sheen")[0] == pytest.approx(0.5, abs=0.06)
    assert "Sheen Weight is shown as its average in Veined." in job.warnings


def test_other_shaders_are_approximated(stage, tmp_path):
    _, tree, shader = material("Gold", cube())
    tree.nodes.remove(shader)
    glossy = tree.nodes.new("ShaderNodeBsdfAnisotropic")
    glossy.inputs["Color"].default_value, glossy.inputs["Roughness"].default_value = (0.9, 0.6, 0.2, 1), 0.3
    tree.links.new(glossy.outputs["BSDF"], tree.nodes["Material Output"].inputs["Surface"])
    job, scene = job_of(stage, tmp_path)
    values = {name: scene.value(f"material/Gold/{name}") for name in ("base_color", "metallic", "roughness")}
    assert values["metallic"] == (1.0,)
    np.testing.assert_allclose(values["base_color"], (0.9, 0.6, 0.2), atol=1e-6)
    np.testing.assert_allclose(values["roughness"], (0.3,), atol=1e-6)
    assert any("Gold" in warning for warning in job.warnings)


def test_a_baked_world_lies_as_the_picture_that_it_was_made_of(stage):
    height, width = 32, 64
    rng = np.random.default_rng(0)
    blocks = rng.random((4, 8, 3)).repeat(8, 0).repeat(8, 1)  # (H, W, 3), row 0 at the bottom
    image = bpy.data.images.new("Blocks", width, height, float_buffer=True)
    image.pixels.foreach_set(np.concatenate([blocks, np.ones((height, width, 1))], -1).astype(np.float32).ravel())
    world = bpy.data.worlds.new("World")
    world.use_nodes = True
    texture = world.node_tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = image
    background = world.node_tree.nodes["Background"]
    background.inputs["Strength"].default_value = 7.0
    world.node_tree.links.new(texture.outputs["Color"], background.inputs["Color"])
    direct = world_light.pictures(world)[0]
    np.testing.assert_allclose(direct, blocks, atol=1e-6)
    gamma = world.node_tree.nodes.new("ShaderNodeGamma")  # not a plain picture any more, but the same
    world.node_tree.links.new(texture.outputs["Color"], gamma.inputs["Color"])
    world.node_tree.links.new(gamma.outputs["Color"], background.inputs["Color"])
    baked = world_light.pictures(world)[0]
    baked = shrink(baked, width)
    assert np.abs(baked - blocks).mean() < 0.03  # the borders of blocks are interpolated
    for other in (baked[::-1], baked[:, ::-1], np.roll(baked, 8, 1)):
        assert np.abs(other - blocks).mean() > 0.15


def test_film_camera_and_lights(stage, tmp_path):
    cube()
    stage.view_settings.look = "AgX - Punchy"
    stage.camera.data.shift_x = 0.1
    _, scene = job_of(stage, tmp_path)
    assert Path(scene.film.ocio).is_file()
    assert scene.film.ocio == ocio_config()
    assert (scene.film.view, scene.film.look) == ("AgX", "AgX - Punchy")
    assert scene.camera.shift == pytest.approx((0.1, 0.0))
    assert scene.resolution == (64, 48)
    (lamp,) = scene.lights
    assert (lamp.name, lamp.type, lamp.role) == ("Lamp", "POINT", "key")
    assert scene.value("camera/distance")[0] == pytest.approx(6.0)
    assert scene.value("camera/azimuth")[0] == pytest.approx(0.0, abs=1e-4)


def test_exporting_changes_nothing_but_what_is_missing(stage, tmp_path):
    _, tree, shader = material("Veined", cube())
    noise = tree.nodes.new("ShaderNodeTexNoise")
    tree.links.new(noise.outputs["Color"], shader.inputs["Base Color"])
    stage.world = bpy.data.worlds.new("World")
    stage.world.use_nodes = True
    sky = stage.world.node_tree.nodes.new("ShaderNodeTexSky")
    stage.world.node_tree.links.new(sky.outputs["Color"], stage.world.node_tree.nodes["Background"].inputs["Color"])
    before = contents()
    job_of(stage, tmp_path)
    bpy.context.scene.pop("vibe_snapshot")
    assert difference(before, contents()) == {}
    content = json.loads((tmp_path / "job" / "scene.json").read_text())
    assert content["world"]["kind"] == "environment"


@pytest.mark.parametrize("kind", ["voronoi", "noise", "white_noise"])
def test_a_texture_of_one_dimension_has_no_place(stage, tmp_path, kind):
    _, tree, shader = material("Striped", cube())
    node = tree.nodes.new(
        {"voronoi": "ShaderNodeTexVoronoi", "noise": "ShaderNodeTexNoise", "white_noise": "ShaderNodeTexWhiteNoise"}[
            kind
        ]
    )
    setattr(node, "noise_dimensions" if kind != "voronoi" else "voronoi_dimensions", "1D")
    tree.links.new(node.outputs["Color"], shader.inputs["Base Color"])
    _, scene = job_of(stage, tmp_path)
    assert "material/Striped/tint" in scene.instances


def test_a_failure_takes_back_what_was_added(stage, tmp_path):
    before = contents()
    with pytest.raises(VibeError, match="no mesh"):
        reading.export_scene(stage, tmp_path, SubjectChoice())
    assert difference(before, contents()) == {}


def test_a_camera_that_sees_nothing(stage, tmp_path):
    cube(location=(0, -30, 0))
    with pytest.raises(VibeError, match="camera sees no mesh"):
        job_of(stage, tmp_path)


def test_a_panoramic_camera(stage, tmp_path):
    cube()
    stage.camera.data.type = "PANO"
    with pytest.raises(VibeError, match="panoramic"):
        job_of(stage, tmp_path)


def test_the_subject_can_be_named_or_selected(stage, tmp_path):
    cube("Left", (-1.5, 0, 0), 1.0)
    right = cube("Right", (1.5, 0, 0), 1.0)
    group = bpy.data.collections.new("Group")
    stage.collection.children.link(group)
    group.objects.link(right)

    def chosen(choice):
        _, scene = job_of(stage, tmp_path, choice)
        return {o.name for o in scene.objects if o.subject}

    assert chosen(SubjectChoice()) == {"Left", "Right"}
    assert chosen(SubjectChoice(objects=("Left",))) == {"Left"}
    assert chosen(SubjectChoice(objects=("Group",))) == {"Right"}
    bpy.ops.object.select_all(action="DESELECT")
    right.select_set(True)
    assert chosen(SubjectChoice(selected=True)) == {"Right"}
    with pytest.raises(VibeError, match="no object or collection 'Rihgt'"):
        chosen(SubjectChoice(objects=("Rihgt",)))


def test_walls_skies_and_things_behind_are_not_the_subject(stage, tmp_path):
    cube("Thing", size=1.0)
    cube("Hidden", (0, 30, 0), 1.0)
    for name, size in (("Room", 20.0), ("Sky", 500.0)):
        cube(name, size=size)
    bpy.ops.mesh.primitive_plane_add(size=12, location=(0, 3, 0), rotation=(np.pi / 2, 0, 0))
    bpy.context.object.name = "Wall"
    job, scene = job_of(stage, tmp_path)
    assert {o.name for o in scene.objects if o.subject} == {"Thing"}
    np.testing.assert_allclose(job.analysis.pivot, (0, 0, 0), atol=1e-5)


def test_what_lies_among_the_parts_of_a_thing_is_a_part_and_what_carries_it_is_not(stage, tmp_path):
    """A car: its chassis carries the hood, and its mirror is tiny; the table carries all of it."""
    for name, location, size in (
        ("Doors", (0.4, 0, 0), (1.2, 1, 0.8)),
        ("Chassis", (0, 0, -0.35), (2, 1.02, 0.15)),
        ("Hood", (-0.6, 0, -0.2), (0.8, 1, 0.15)),
        ("Mirror", (0.2, -0.52, 0.1), (0.1, 0.03, 0.1)),
        ("Table", (0, 0, -0.6), (4, 3, 0.2)),
    ):
        cube(name, location, 1.0).scale = size
    bpy.context.view_layer.update()
    _, scene = job_of(stage, tmp_path)
    assert {o.name for o in scene.objects if o.subject} == {"Doors", "Chassis", "Hood", "Mirror"}


def test_pixels_of_gray_images_have_three_channels(scene):
    image = bpy.data.images.new("Gray", 2, 2, float_buffer=True)
    assert bake.image_pixels(image).shape == (2, 2, 3)
