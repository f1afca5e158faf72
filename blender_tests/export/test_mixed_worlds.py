# SPDX-License-Identifier: GPL-3.0-or-later
"""Worlds of several Backgrounds: the camera sees one and another lights, both are predicted, all change, all come back."""

import bpy
import dump
import numpy as np
import pytest
import small_scenes as scenes
import torch
from marks import few_of
from vibe_render.core import compat
from vibe_render.export import reading
from vibe_render.render import anchors
from vibe_render.scene import bindings, snapshot
from vibe_render.scene.nodes import backgrounds
from vibe_render.scene.subject import SubjectChoice

from proxy_renderer.goals.resolve import goals_of
from proxy_renderer.planning.planner import plan
from proxy_renderer.render.cycles import CyclesPicture
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import load_scene
from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import SceneDescription

RED, BLUE = (0.8, 0.1, 0.05), (0.1, 0.2, 0.9)


def background(tree, color, strength):
    node = tree.nodes.new("ShaderNodeBackground")
    node.inputs["Color"].default_value, node.inputs["Strength"].default_value = (*color, 1.0), strength
    return node.outputs[0]


def by_camera_rays(tree):
    """A red backdrop; blue light."""
    mix, path = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeLightPath")
    tree.links.new(path.outputs["Is Camera Ray"], mix.inputs[0])
    tree.links.new(background(tree, BLUE, 2.0), mix.inputs[1])
    tree.links.new(background(tree, RED, 0.5), mix.inputs[2])
    return mix.outputs[0]


def by_height(tree):
    """Blue above, red below."""
    mix, place, split = (tree.nodes.new(f"ShaderNode{n}") for n in ("MixShader", "TexCoord", "SeparateXYZ"))
    tree.links.new(place.outputs["Generated"], split.inputs[0])
    tree.links.new(split.outputs["Z"], mix.inputs[0])
    tree.links.new(background(tree, RED, 1.0), mix.inputs[1])
    tree.links.new(background(tree, BLUE, 2.0), mix.inputs[2])
    return mix.outputs[0]


def in_a_group(tree):
    """The first, in a node group whose output is added to a faint Background."""
    group = bpy.data.node_groups.new("My Sky", "ShaderNodeTree")
    group.interface.new_socket("Sky", in_out="OUTPUT", socket_type="NodeSocketShader")
    group.links.new(by_camera_rays(group), group.nodes.new("NodeGroupOutput").inputs[0])
    node, add = tree.nodes.new("ShaderNodeGroup"), tree.nodes.new("ShaderNodeAddShader")
    node.node_tree = group
    tree.links.new(node.outputs[0], add.inputs[0])
    tree.links.new(background(tree, (0.1, 0.1, 0.1), 1.0), add.inputs[1])
    return add.outputs[0]


def by_strength(tree):
    """One Background, a fifth as bright to the camera."""
    only, path, math = (
        background(tree, BLUE, 1.0),
        tree.nodes.new("ShaderNodeLightPath"),
        tree.nodes.new("ShaderNodeMath"),
    )
    math.operation, math.inputs[1].default_value, math.inputs[2].default_value = "MULTIPLY_ADD", -1.6, 2.0
    tree.links.new(path.outputs["Is Camera Ray"], math.inputs[0])
    tree.links.new(math.outputs[0], only.node.inputs["Strength"])
    return only


def by_color(tree):
    """One Background, red to the camera and blue to the rest."""
    only, path, mix = (
        background(tree, BLUE, 1.5),
        tree.nodes.new("ShaderNodeLightPath"),
        tree.nodes.new("ShaderNodeMixRGB"),
    )
    tree.links.new(path.outputs["Is Camera Ray"], mix.inputs[0])
    mix.inputs[1].default_value, mix.inputs[2].default_value = (*BLUE, 1.0), (*RED, 1.0)
    tree.links.new(mix.outputs[0], only.node.inputs["Color"])
    return only


def by_camera_rays_and_height(tree):
    """A backdrop of two colors; light of a texture."""
    mix, path = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeLightPath")
    tree.links.new(path.outputs["Is Camera Ray"], mix.inputs[0])
    light = background(tree, BLUE, 2.0)
    texture = tree.nodes.new("ShaderNodeTexGradient")
    tree.links.new(texture.outputs["Color"], light.node.inputs["Color"])
    tree.links.new(light, mix.inputs[1])
    tree.links.new(by_height(tree), mix.inputs[2])
    return mix.outputs[0]


CAMERA_RAYS = [(by_camera_rays, "color", "backdrop_color"), (by_camera_rays_and_height, "tint", "backdrop_tint")]
"""Builds a world; the parameters that lights and the camera see of it."""


@pytest.fixture(params=few_of([by_height, in_a_group, by_strength, by_color], [by_height]))
def studio(request, scene):
    """A white ball before such a world."""
    fill(scene, request.param)
    return scene


def fill(scene, build):
    """The same, of one of them."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24)
    scenes.principled("White", bpy.context.object)
    bpy.context.object.name = "Ball"
    scenes.camera(scene, (0.0, -4.0, 0.0))
    tree = scenes.world(scene).node_tree
    tree.nodes.remove(tree.nodes["Background"])
    tree.links.new(build(tree), tree.nodes["World Output"].inputs["Surface"])
    scene.render.resolution_x = scene.render.resolution_y = 64


def cycles_and_proxy(scene, job, folder, values):
    data, place = load_scene(folder), (job.analysis.objects, job.analysis.pivot)
    groups = anchors.render_anchor(scene, folder / "a.exr", values, *place, 64, 64)
    with torch.no_grad():
        predicted = Proxy(data, (64, 64)).render({k: torch.tensor(v) for k, v in values.items()}).linear
    return CyclesPicture.load(folder / "a.exr", groups).whole.numpy(), predicted.numpy()


def test_backdrop_and_light_are_predicted_and_change_as_predicted(studio, tmp_path):
    job = reading.export_scene(studio, tmp_path, SubjectChoice(("Ball",)))
    world = {key.removeprefix("world/") for key in job.instances if key.startswith("world/")}
    assert world == {"strength", "tint"}
    for values in ({}, {"world/strength": (0.4,), "world/tint": (1.5, 0.8, 0.5)}):
        cycles, predicted = cycles_and_proxy(studio, job, tmp_path, values)
        for part in (np.s_[:8], np.s_[-8:], np.s_[28:36, 28:36]):  # the world above and below, the ball
            a, b = cycles[part].mean((0, 1)), predicted[part].mean((0, 1))
            assert (np.abs(a - b) < 0.06 * a.max()).all()


@pytest.mark.parametrize(("build", "light", "backdrop"), few_of(CAMERA_RAYS, CAMERA_RAYS[:1]))
def test_what_the_camera_sees_and_what_lights_change_each_by_itself(scene, tmp_path, build, light, backdrop):
    fill(scene, build)
    before = dump.contents()
    job = reading.export_scene(scene, tmp_path, SubjectChoice(("Ball",)))
    color = (0.5, 0.9, 0.3)
    steps = (
        {},
        {f"world/{light}": color, "world/strength": (0.5,)},
        {f"world/{backdrop}": color, "world/backdrop_strength": (0.3,)},
    )
    for values in steps:
        assert values.keys() <= job.instances.keys()
        cycles, predicted = cycles_and_proxy(scene, job, tmp_path, values)
        for part in (np.s_[:8], np.s_[-8:], np.s_[28:36, 28:36]):
            a, b = cycles[part].mean((0, 1)), predicted[part].mean((0, 1))
            assert (np.abs(a - b) < 0.06 * a.max()).all(), (values, a, b)
        assert bindings.write(scene, values, job.analysis.objects, job.analysis.pivot) == {}
        snapshot.revert(scene)
        assert dump.difference(before, dump.contents()) == {}
        job = reading.export_scene(scene, tmp_path, SubjectChoice(("Ball",)))


@pytest.mark.parametrize(
    ("prompt", "seen", "shed"),
    [("white background", True, False), ("warm light", False, True), ("a night scene", True, True)],
)
def test_words_mean_what_is_seen_or_what_lights(scene, tmp_path, prompt, seen, shed):
    fill(scene, by_camera_rays)
    reading.export_scene(scene, tmp_path, SubjectChoice(("Ball",)))
    parsed = parse(prompt, SceneDescription())
    data = load_scene(tmp_path)
    entries = plan(goals_of(parsed), dict(data.instances), SceneDescription())
    named = {key for key, entry in entries.items() if entry.priority is not None and "supports" not in entry.reason}
    assert ("world/backdrop_color" in named) == seen
    assert ("world/color" in named) == shed


def test_strengths_keep_their_relation_and_come_back(studio, tmp_path):
    before = dump.contents()
    job = reading.export_scene(studio, tmp_path, SubjectChoice(("Ball",)))
    place = job.analysis.objects, job.analysis.pivot
    was = np.load(tmp_path / "world_image.npy")
    assert bindings.write(studio, {"world/strength": (0.0,), "world/tint": (0.5, 1.0, 1.0)}, *place) == {}
    assert bindings.write(studio, {"world/strength": (3.0,)}, *place) == {}
    assert bindings.read(studio, *place)["world/strength"] == pytest.approx((3.0,))
    reading.export_scene(studio, tmp_path / "again", SubjectChoice(("Ball",)))
    np.testing.assert_allclose(np.load(tmp_path / "again" / "world_image.npy"), was, atol=1e-3)
    snapshot.revert(studio)
    assert dump.difference(before, dump.contents()) == {}


def test_a_world_is_read_through_the_output_that_cycles_takes(scene):
    world = bpy.data.worlds.new("World")
    tree = compat.enable_nodes(world)
    tree.nodes.clear()
    for target, color in (("EEVEE", RED), ("CYCLES", BLUE)):
        output = tree.nodes.new("ShaderNodeOutputWorld")
        output.target = target
        tree.links.new(background(tree, color, 1.0), output.inputs["Surface"])
    seen = backgrounds.single_background(world).node
    assert seen.inputs["Color"].default_value[:3] == pytest.approx(BLUE)
    seen.mute = True
    assert backgrounds.single_background(world) is None
