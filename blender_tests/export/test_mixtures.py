# SPDX-License-Identifier: GPL-3.0-or-later
"""Mixes of shaders and what node groups compute arrive in the job folder; what is approximated is said in few lines."""

import bpy
import numpy as np
import pytest
import small_scenes as scenes
from vibe_render.export import notes, reading
from vibe_render.scene.subject import SubjectChoice

from proxy_renderer.scene import load_scene

RED, GREEN, GRAY = (0.8, 0.1, 0.05, 1.0), (0.1, 0.5, 0.1, 1.0), (0.8, 0.8, 0.8, 1.0)


@pytest.fixture
def stage(scene):
    """A cube that faces the camera."""
    scenes.cube(scene, "Cube", size=2.0)
    scenes.camera(scene, (0.0, -6.0, 0.0)).rotation_euler[0] = np.pi / 2.0
    scenes.light(scene, "POINT")
    scene.render.resolution_x, scene.render.resolution_y = 64, 48
    return scene


def bare(name, obj):
    """A material's tree with nothing but its output."""
    tree = scenes.principled(name, obj).node_tree
    tree.nodes.remove(scenes.shader(bpy.data.materials[name]))
    return tree


def node(tree, kind, *links, **inputs):
    """A node; `links` are pairs of an input and the output that goes there."""
    made = tree.nodes.new(f"ShaderNode{kind}")
    for name, value in inputs.items():
        made.inputs[name].default_value = value
    for entry, source in links:
        tree.links.new(source, made.inputs[entry])
    return made


def mixed(tree, first, second, fac):
    made = node(tree, "MixShader", (1, first.outputs[0]), (2, second.outputs[0]))
    if isinstance(fac, float):
        made.inputs[0].default_value = fac
    else:
        tree.links.new(fac, made.inputs[0])
    return made


def shown(tree, shader):
    tree.links.new(shader.outputs[0], tree.nodes["Material Output"].inputs["Surface"])


def right_half(tree):
    """1 on the right half of the picture, 0 on the left."""
    place = node(tree, "NewGeometry")
    split = node(tree, "SeparateXYZ", (0, place.outputs["Position"]))
    greater = node(tree, "Math", (0, split.outputs["X"]))
    greater.operation, greater.inputs[1].default_value = "GREATER_THAN", 0.0
    return greater.outputs[0]


def job_of(stage, tmp_path):
    job = reading.export_scene(stage, tmp_path / "job", SubjectChoice())
    return job, load_scene(tmp_path / "job")


def halves(texture):
    """Means (C,) of a picture's left and right quarters."""
    row = texture.image[texture.image.shape[0] // 2]
    quarter = len(row) // 4
    return row[2:quarter].mean(0), row[-quarter:-2].mean(0)


def test_two_paints_arrive_as_their_mix(stage, tmp_path):
    tree = bare("Paint", bpy.data.objects["Cube"])
    paints = [node(tree, "BsdfDiffuse", Color=color) for color in (RED, GREEN)]
    shown(tree, mixed(tree, *paints, right_half(tree)))
    _, scene = job_of(stage, tmp_path)
    left, right = halves(scene.materials[0].texture)
    np.testing.assert_allclose(left, RED[:3], atol=0.02)
    np.testing.assert_allclose(right, GREEN[:3], atol=0.02)
    assert "material/Paint/tint" in scene.instances


def test_a_transparent_shader_deep_in_mixes_is_alpha(stage, tmp_path):
    tree = bare("Net", bpy.data.objects["Cube"])
    inner = mixed(tree, node(tree, "BsdfDiffuse"), node(tree, "BsdfTransparent"), right_half(tree))
    shown(tree, mixed(tree, inner, node(tree, "BsdfTransparent"), 0.25))
    _, scene = job_of(stage, tmp_path)
    left, right = halves(scene.materials[0].maps["alpha"])
    assert (left.item(), right.item()) == (pytest.approx(0.75, abs=0.02), pytest.approx(0.0, abs=0.02))
    assert scene.materials[0].alpha == pytest.approx(0.375, abs=0.05)


def test_a_surface_of_transparent_shaders_alone_is_clear(stage, tmp_path):
    tree = bare("Air", bpy.data.objects["Cube"])
    shown(tree, node(tree, "BsdfTransparent", Color=(1.0, 1.0, 1.0, 1.0)))
    job, scene = job_of(stage, tmp_path)
    assert scene.materials[0].alpha == 0.0
    assert job.warnings == []


def test_car_paint_has_a_lacquer(stage, tmp_path):
    tree = bare("Paint", bpy.data.objects["Cube"])
    base = node(tree, "BsdfGlossy", Color=RED, Roughness=0.5)
    coat = node(tree, "BsdfGlossy", Color=GRAY, Roughness=0.1)
    fresnel = node(tree, "LayerWeight", Blend=0.5).outputs["Fresnel"]
    shown(tree, mixed(tree, base, coat, fresnel))
    _, scene = job_of(stage, tmp_path)
    names = ("metallic", "roughness", "coat", "coat_roughness", "base_color")
    values = {name: scene.value(f"material/Paint/{name}") for name in names}
    assert values["base_color"] == pytest.approx(RED[:3])
    assert [values[name][0] for name in names[:4]] == pytest.approx([1.0, 0.5, 0.8, 0.1])
    assert scene.materials[0].constants["coat_ior"] == pytest.approx(2.0)


def test_a_glow_shows_only_where_it_is_mixed_in(stage, tmp_path):
    tree = bare("Sign", bpy.data.objects["Cube"])
    glow = node(tree, "Emission", Color=RED, Strength=3.0)
    shown(tree, mixed(tree, node(tree, "BsdfDiffuse"), glow, right_half(tree)))
    _, scene = job_of(stage, tmp_path)
    left, right = halves(scene.materials[0].maps["emission_color"])
    np.testing.assert_allclose(left, 0.0, atol=0.02)
    np.testing.assert_allclose(right, 1.0, atol=0.02)
    assert scene.value("material/Sign/emission") == (3.0,)
    assert scene.value("material/Sign/emission_color") == pytest.approx(RED[:3])


@pytest.mark.parametrize("depth", [0, 2])
def test_a_color_inside_groups_is_measured_where_the_camera_does_not_look(stage, tmp_path, depth):
    """Mirrors show it, and its light falls on others: it is not middle gray."""
    behind = scenes.cube(stage, "Behind", (0.0, -12.0, 0.0))
    outer = tree = bare("Wall", behind)
    bpy.data.objects["Cube"].data.materials.append(bpy.data.materials.new("Front"))
    holders = []
    for number in range(depth):
        group = bpy.data.node_groups.new(f"Group {number}", "ShaderNodeTree")
        group.interface.new_socket("BSDF", in_out="OUTPUT", socket_type="NodeSocketShader")
        holder = tree.nodes.new("ShaderNodeGroup")
        holder.node_tree = group
        holders.append((tree, holder))
        tree = group
    gamma = node(tree, "Gamma", Color=(0.9, 0.4, 0.1, 1.0), Gamma=2.0)
    last = node(tree, "BsdfDiffuse", ("Color", gamma.outputs[0]))
    for where, holder in reversed(holders):
        end = holder.node_tree.nodes.new("NodeGroupOutput")
        holder.node_tree.links.new(last.outputs[0], end.inputs[0])
        last = holder
        assert where.nodes[holder.name] == holder
    shown(outer, last)
    groups = len(bpy.data.node_groups)
    _, scene = job_of(stage, tmp_path)
    (row,) = [m for m in scene.materials if m.name == "Wall"]
    np.testing.assert_allclose(row.texture.image.mean((0, 1)), (0.81, 0.16, 0.01), atol=0.02)
    assert len(bpy.data.node_groups) == groups


def test_warnings_are_one_line_for_each_reason_and_only_of_what_is_seen(stage, tmp_path):
    cube = bpy.data.objects["Cube"]
    for number in range(6):
        ball = cube if number == 0 else scenes.cube(stage, f"Cube {number}", (0.7 * number - 2.1, -2.0, 0.0), 0.5)
        tree = bare(f"Chrome {number}", ball)
        shown(tree, node(tree, "BsdfGlossy"))
    tree = bare("Unseen", scenes.cube(stage, "Behind", (0.0, -12.0, 0.0)))
    shown(tree, node(tree, "BsdfToon"))
    job, _ = job_of(stage, tmp_path)
    (line,) = job.warnings
    assert line.startswith("Glossy BSDF is approximated in Chrome 0, ")
    assert line.endswith(" and 3 more.")


def test_diffuse_and_emission_need_no_warning(stage, tmp_path):
    tree = bare("Chalk", bpy.data.objects["Cube"])
    add = node(tree, "AddShader", (0, node(tree, "BsdfDiffuse").outputs[0]), (1, node(tree, "Emission").outputs[0]))
    shown(tree, add)
    assert job_of(stage, tmp_path)[0].warnings == []


def test_notes_name_three_things_and_five_reasons():
    reasons = {name: ["Hair is left out"] for name in "ABCDE"}
    assert notes.notes_by_reason(reasons) == ["Hair is left out in A, B, C and 2 more."]
    assert notes.notes_by_reason({"A": ["X is Y"], "B": ["X is Y", "Z is Y"]}) == ["X is Y in A and B.", "Z is Y in B."]
    lines = [f"{n}." for n in range(24)]
    assert notes.shortened_notes([*lines, *lines]) == [*lines[:5], "And 19 more."]
    assert notes.shortened_notes(lines[:5]) == lines[:5]
