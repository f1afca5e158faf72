# SPDX-License-Identifier: GPL-3.0-or-later
"""Keyframes on node groups survive our renders and exports, which work on copies that share the action; renders show them."""

import bpy
import pytest
import small_scenes as scenes
from vibe_render.core import compat
from vibe_render.export import reading
from vibe_render.render import bake, final_render
from vibe_render.scene.subject import SubjectChoice


def keyed_group(tree, kind, start, socket="NodeSocketFloat"):
    """A group node that hands its input on, keyframed from 0 to 2 in ten frames."""
    group = bpy.data.node_groups.new("Group", kind)
    group.interface.new_socket("Value", in_out="INPUT", socket_type=socket)
    group.interface.new_socket("Value", in_out="OUTPUT", socket_type=socket)
    inside, outside = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    group.links.new(inside.outputs[0], outside.inputs[0])
    node = tree.nodes.new("ShaderNodeGroup" if kind == "ShaderNodeTree" else "CompositorNodeGroup")
    node.node_tree = group
    for frame, value in ((1, start), (11, 2.0)):
        node.inputs[0].default_value = value
        node.inputs[0].keyframe_insert("default_value", frame=frame)
    return node


@pytest.fixture
def keyed(scene):
    """A studio whose material, world and compositor have keyframes on groups: the scene and their trees."""
    scenes.studio(scene)
    compositor = scenes.compositor(scene)
    material, world = bpy.data.materials["Body"].node_tree, scene.world.node_tree
    node = keyed_group(material, "ShaderNodeTree", 0.0)
    material.links.new(node.outputs[0], scenes.shader(bpy.data.materials["Body"]).inputs["Roughness"])
    node = keyed_group(world, "ShaderNodeTree", 0.5)
    world.links.new(node.outputs[0], world.nodes["Background"].inputs["Color"])
    node = keyed_group(compositor, "CompositorNodeTree", -8.0)
    exposure = next(n for n in compositor.nodes if n.bl_idname == "CompositorNodeExposure")
    compositor.links.new(node.outputs[0], exposure.inputs["Exposure"])
    return scene, (material, world, compositor)


def test_exports_and_renders_leave_them(keyed, tmp_path):
    scene, trees = keyed
    light = []
    for frame in (1, 11):
        scene.frame_set(frame)
        reading.export_scene(scene, tmp_path / str(frame), SubjectChoice())
        final_render.render_picture(scene, tmp_path / f"{frame}.png", 32, 2)
        light.append(float(bake.read_file(tmp_path / f"{frame}.png")[..., :3].mean()))
        assert [len(list(compat.curves(tree))) for tree in trees] == [1, 1, 1]
    assert light[0] < 0.1 < light[1]
