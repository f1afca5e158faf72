# SPDX-License-Identifier: GPL-3.0-or-later
"""What must be left alone is left alone, and says why; what can be worked around is worked around."""

import bpy
import pytest
import small_scenes as scenes
from mathutils import Matrix
from vibe_render.scene import bindings, snapshot
from vibe_render.scene.nodes import owned
from vibe_render.scene.nodes.inputs import TINT

PIVOT = (0.0, 0.0, 0.0)


def locked(scene, subject, key):
    return bindings.instances(scene, subject, PIVOT)[key].locked


def assert_left_alone(scene, subject, key, value, word):
    before = bindings.read(scene, subject, PIVOT)[key]
    assert word in locked(scene, subject, key)
    assert word in bindings.write(scene, {key: value}, subject, PIVOT)[key]
    assert bindings.read(scene, subject, PIVOT)[key] == before
    assert not snapshot.exists(scene)


def test_keyframes_on_a_socket_a_light_and_a_camera(scene):
    subject = scenes.studio(scene)
    scenes.shader(bpy.data.materials["Body"]).inputs["Roughness"].keyframe_insert("default_value")
    bpy.data.lights["Point"].keyframe_insert("energy")
    scene.camera.keyframe_insert("location")
    assert_left_alone(scene, subject, "material/Body/roughness", (0.9,), "animated")
    assert_left_alone(scene, subject, "light/Point/power", (9.0,), "animated")
    assert_left_alone(scene, subject, "camera/azimuth", (9.0,), "animated")
    assert locked(scene, subject, "material/Body/metallic") == ""
    assert locked(scene, subject, "light/Point/color") == ""
    assert locked(scene, subject, "camera/fov") == ""


def test_keyframes_in_the_nla(scene):
    subject = scenes.studio(scene)
    lamp = bpy.data.lights["Point"]
    lamp.keyframe_insert("energy")
    data = lamp.animation_data
    data.nla_tracks.new().strips.new("Strip", 1, data.action)
    data.action = None
    assert_left_alone(scene, subject, "light/Point/power", (9.0,), "animated")


def test_drivers(scene):
    subject = scenes.studio(scene)
    scene.world.node_tree.nodes["Background"].inputs["Strength"].driver_add("default_value")
    scene.view_settings.driver_add("exposure")
    assert_left_alone(scene, subject, "world/strength", (3.0,), "driven")
    assert_left_alone(scene, subject, "film/exposure", (3.0,), "driven")
    assert locked(scene, subject, "film/gamma") == ""


def test_parents_and_constraints(scene):
    subject = scenes.studio(scene)
    bpy.data.objects["Point"].parent = subject[0]
    bpy.data.objects["Spot"].constraints.new("TRACK_TO").target = subject[0]
    assert_left_alone(scene, subject, "light/Point/elevation", (9.0,), "parent")
    assert_left_alone(scene, subject, "light/Spot/distance", (9.0,), "constrained")
    assert locked(scene, subject, "light/Spot/power") == ""


def test_a_parented_light_is_read_where_it_is(scene):
    subject = scenes.studio(scene)
    lamp = bpy.data.objects["Point"]
    lamp.parent = subject[0]
    lamp.matrix_parent_inverse = Matrix.Identity(4)
    lamp.location, subject[0].location = (0.0, -3.0, 0.0), (0.0, 0.0, 3.0)
    assert bindings.read(scene, subject, PIVOT)["light/Point/elevation"][0] == pytest.approx(45.0, abs=1e-3)


def test_lights_that_share_their_data_have_it_once(scene):
    subject = scenes.studio(scene)
    twin = bpy.data.objects.new("Zwilling", bpy.data.lights["Point"])
    scene.collection.objects.link(twin)
    assert locked(scene, subject, "light/Point/power") == ""
    assert_left_alone(scene, subject, "light/Zwilling/power", (9.0,), "shares")
    assert locked(scene, subject, "light/Zwilling/azimuth") == ""


def test_library_data(scene, tmp_path):
    subject = scenes.studio(scene)
    bpy.data.libraries.write(str(tmp_path / "library.blend"), {bpy.data.materials["Body"]}, fake_user=True)
    with bpy.data.libraries.load(str(tmp_path / "library.blend"), link=True) as (there, here):
        here.materials = there.materials
    subject[0].data.materials[0] = here.materials[0]
    key = f"material/{here.materials[0].name_full}/roughness"
    assert_left_alone(scene, subject, key, (0.9,), "library.blend")


def test_library_overrides(scene, tmp_path):
    subject = scenes.studio(scene)
    bpy.data.libraries.write(str(tmp_path / "library.blend"), {bpy.data.objects["Point"]}, fake_user=True)
    with bpy.data.libraries.load(str(tmp_path / "library.blend"), link=True) as (there, here):
        here.objects = there.objects
    lamp = here.objects[0].override_create()
    scene.collection.objects.link(lamp)
    assert_left_alone(scene, subject, f"light/{lamp.name_full}/power", (9.0,), "library.blend")
    assert locked(scene, subject, f"light/{lamp.name_full}/azimuth") == ""


def test_computed_values(scene):
    subject = scenes.textured(scene)
    assert_left_alone(scene, subject, "material/Painted/roughness", (0.9,), "Image Texture")
    parameters = bindings.instances(scene, subject, PIVOT)
    assert "material/Painted/base_color" not in parameters
    assert parameters["material/Painted/tint"].locked == ""
    assert "world/color" not in parameters
    assert {"world/tint", "world/rotation"} <= parameters.keys()


def test_a_value_node_is_followed_and_a_shared_one_stays(scene):
    subject = scenes.studio(scene)
    material = bpy.data.materials["Body"]
    tree, node = material.node_tree, scenes.shader(material)
    number, reroute = tree.nodes.new("ShaderNodeValue"), tree.nodes.new("NodeReroute")
    tree.links.new(number.outputs[0], reroute.inputs[0])
    tree.links.new(reroute.outputs[0], node.inputs["Roughness"])
    bindings.write(scene, {"material/Body/roughness": (0.25,)}, subject, PIVOT)
    assert number.outputs[0].default_value == 0.25
    tree.links.new(number.outputs[0], node.inputs["Metallic"])
    bindings.write(scene, {"material/Body/roughness": (0.75,)}, subject, PIVOT)
    assert number.outputs[0].default_value == 0.25
    values = bindings.read(scene, subject, PIVOT)
    assert (values["material/Body/roughness"], values["material/Body/metallic"]) == ((0.75,), (0.25,))


def grouped(material):
    """Moves the shader of a material into a node group; its Roughness becomes the group's input."""
    tree = material.node_tree
    group = bpy.data.node_groups.new("Paint", "ShaderNodeTree")
    group.interface.new_socket("Grain", in_out="INPUT", socket_type="NodeSocketFloat")
    group.interface.new_socket("BSDF", in_out="OUTPUT", socket_type="NodeSocketShader")
    entry, exit_ = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    inner = group.nodes.new("ShaderNodeBsdfPrincipled")
    group.links.new(entry.outputs["Grain"], inner.inputs["Roughness"])
    group.links.new(inner.outputs["BSDF"], exit_.inputs["BSDF"])
    tree.nodes.remove(scenes.shader(material))
    outer = tree.nodes.new("ShaderNodeGroup")
    outer.node_tree = group
    tree.links.new(outer.outputs["BSDF"], tree.nodes["Material Output"].inputs["Surface"])
    return outer, inner


def test_a_shader_inside_a_group(scene):
    subject = scenes.studio(scene)
    outer, inner = grouped(bpy.data.materials["Body"])
    values = {"material/Body/roughness": (0.25,), "material/Body/metallic": (0.75,)}
    assert bindings.write(scene, values, subject, PIVOT) == {}
    assert outer.inputs["Grain"].default_value == 0.25
    assert inner.inputs["Metallic"].default_value == 0.75
    assert locked(scene, subject, "material/Body/metallic") == ""  # the snapshot is no second user
    other = bpy.data.materials["Ground"].node_tree.nodes.new("ShaderNodeGroup")
    other.node_tree = outer.node_tree
    assert bindings.write(scene, {"material/Body/metallic": (0.25,)}, subject, PIVOT) == {}
    assert inner.inputs["Metallic"].default_value == 0.75  # the other material's
    assert outer.inputs["Grain"].default_value == 0.25
    assert bindings.read(scene, subject, PIVOT)["material/Body/metallic"] == (0.25,)


def test_a_tint_inside_a_shared_group_is_in_a_copy_of_it(scene):
    subject = scenes.studio(scene)
    outer, inner = grouped(bpy.data.materials["Body"])
    tree = outer.node_tree
    noise = tree.nodes.new("ShaderNodeTexNoise")
    tree.links.new(noise.outputs["Color"], inner.inputs["Base Color"])
    assert locked(scene, subject, "material/Body/tint") == ""
    bpy.data.materials["Ground"].node_tree.nodes.new("ShaderNodeGroup").node_tree = tree
    assert bindings.write(scene, {"material/Body/tint": (0.5, 1.0, 1.0)}, subject, PIVOT) == {}
    assert inner.inputs["Base Color"].links[0].from_node == noise
    assert owned.group_nodes(outer.node_tree, TINT.name)


def test_other_shaders_have_what_they_share_with_the_principled_one(scene):
    subject = scenes.studio(scene)
    tree = bpy.data.materials["Body"].node_tree
    diffuse = tree.nodes.new("ShaderNodeBsdfDiffuse")
    tree.links.new(diffuse.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    bindings.write(scene, {"material/Body/base_color": (0.1, 0.2, 0.3)}, subject, PIVOT)
    assert tuple(diffuse.inputs["Color"].default_value)[:3] == pytest.approx((0.1, 0.2, 0.3))
    parameters = bindings.instances(scene, subject, PIVOT)
    assert [i.parameter.name for i in parameters.values() if i.owner == "Body"] == ["base_color"]
