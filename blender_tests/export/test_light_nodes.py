# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights whose color and strength nodes compute: predicted as Cycles renders them, and changed where the value is."""

import bpy
import dump
import pytest
import small_scenes as scenes
import torch
from vibe_render.core import compat
from vibe_render.export import reading
from vibe_render.render import anchors
from vibe_render.scene import bindings, snapshot
from vibe_render.scene.subject import SubjectChoice

from proxy_renderer.render.cycles import CyclesPicture
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import load_scene


@pytest.fixture
def blackbody(scene):
    """A cube by a lamp of 2500 K, by a Blackbody node, three times as bright by a Light Falloff."""
    scenes.principled("Paint", scenes.cube(scene, "Cube", (0.0, 0.0, 0.0), 2.0))
    scenes.camera(scene)
    scenes.world(scene).node_tree.nodes["Background"].inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    data = scenes.light(scene, "POINT", (1.0, -4.0, 3.0)).data
    data.energy = 100.0
    compat.enable_nodes(data)
    tree = data.node_tree
    emission = next(n for n in tree.nodes if n.type == "EMISSION")
    black, falloff = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("Blackbody", "LightFalloff"))
    black.inputs["Temperature"].default_value, falloff.inputs["Strength"].default_value = 2500.0, 3.0
    tree.links.new(black.outputs["Color"], emission.inputs["Color"])
    tree.links.new(falloff.outputs["Quadratic"], emission.inputs["Strength"])
    scene.render.resolution_x = scene.render.resolution_y = 64
    return scene


def test_the_prediction_has_their_color_and_strength(blackbody, tmp_path):
    job = reading.export_scene(blackbody, tmp_path, SubjectChoice(("Cube",)))
    assert not any("nodes of Point" in warning for warning in job.warnings)
    scene = load_scene(tmp_path)
    place = job.analysis.objects, job.analysis.pivot
    groups = anchors.render_anchor(blackbody, tmp_path / "a.exr", {}, *place, 64, 32)
    cycles = CyclesPicture.load(tmp_path / "a.exr", groups).whole.mean((0, 1))
    with torch.no_grad():
        predicted = Proxy(scene, (64, 64)).render({}).linear.mean((0, 1))
    assert ((predicted - cycles).abs() < 0.1 * cycles.max()).all()


def by_ies(tree, emission):
    """Twice as bright below as above, from a file of two angles."""
    text = bpy.data.texts.new("Lamp.ies")
    text.write("IESNA:LM-63-1995\nTILT=NONE\n1 1000 0.004 3 1 1 2 0 0 0\n1 1 1\n0 90 180\n0\n200 150 100\n")
    node = tree.nodes.new("ShaderNodeTexIES")
    node.ies = text
    tree.links.new(node.outputs[0], emission.inputs["Strength"])


def by_checker(tree, emission):
    """Stripes of red and blue: a gobo."""
    place, node = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeTexChecker")
    node.inputs["Color1"].default_value, node.inputs["Color2"].default_value = (1, 0.2, 0, 1), (0, 0.2, 1, 1)
    node.inputs["Scale"].default_value = 25.0
    tree.links.new(place.outputs["Normal"], node.inputs[0])
    tree.links.new(node.outputs["Color"], emission.inputs["Color"])


def by_falloff(tree, emission):
    """Brighter the farther, which no factor says for all distances."""
    node = tree.nodes.new("ShaderNodeLightFalloff")
    node.inputs["Strength"].default_value = 0.5
    tree.links.new(node.outputs["Linear"], emission.inputs["Strength"])


@pytest.mark.parametrize("kind", ["POINT", "SPOT", "AREA", "SUN"])
@pytest.mark.parametrize("pattern", [by_ies, by_checker, by_falloff])
def test_patterns_are_predicted_as_their_average(scene, tmp_path, kind, pattern):
    scenes.principled("Paint", scenes.cube(scene, "Cube", (0.0, 0.0, 0.0), 1.0))
    scenes.camera(scene)
    scenes.world(scene).node_tree.nodes["Background"].inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    lamp = scenes.light(scene, kind, (0.0, -4.0, 3.0))
    lamp.rotation_euler, lamp.data.energy = (0.93, 0.0, 0.0), 2.0 if kind == "SUN" else 200.0
    compat.enable_nodes(lamp.data)
    tree = lamp.data.node_tree
    pattern(tree, next(n for n in tree.nodes if n.type == "EMISSION"))
    scene.render.resolution_x = scene.render.resolution_y = 64
    before = dump.contents()
    job = reading.export_scene(scene, tmp_path, SubjectChoice(("Cube",)))
    assert any("shown as their average" in warning for warning in job.warnings)
    data = load_scene(tmp_path)
    place = job.analysis.objects, job.analysis.pivot
    groups = anchors.render_anchor(scene, tmp_path / "a.exr", {}, *place, 64, 64)
    cycles = CyclesPicture.load(tmp_path / "a.exr", groups).whole.mean((0, 1))
    with torch.no_grad():
        predicted = Proxy(data, (64, 64)).render({}).linear.mean((0, 1))
    assert ((predicted - cycles).abs() < 0.15 * cycles.max()).all(), (predicted, cycles)
    snapshot.revert(scene)
    assert dump.difference(before, dump.contents()) == {}


def test_words_change_the_nodes_own_temperature(blackbody, tmp_path):
    before = dump.contents()
    job = reading.export_scene(blackbody, tmp_path, SubjectChoice(("Cube",)))
    assert job.instances["light/Point/temperature"].value == pytest.approx((2500.0,))
    place = job.analysis.objects, job.analysis.pivot
    assert bindings.write(blackbody, {"light/Point/temperature": (9000.0,)}, *place) == {}
    node = next(n for n in bpy.data.lights["Point"].node_tree.nodes if n.type == "BLACKBODY")
    assert node.inputs["Temperature"].default_value == pytest.approx(9000.0)
    snapshot.revert(blackbody)
    assert dump.difference(before, dump.contents()) == {}
