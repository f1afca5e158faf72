# SPDX-License-Identifier: GPL-3.0-or-later
"""A glow whose strength nodes compute: predicted, turned up and down by an owned factor, and put back exactly."""

import bpy
import dump
import pytest
import small_scenes as scenes
import torch
from vibe_render.export import reading
from vibe_render.render import anchors
from vibe_render.scene import bindings, snapshot
from vibe_render.scene.subject import SubjectChoice

from proxy_renderer.goals.resolve import goals_of
from proxy_renderer.planning.glow import glows
from proxy_renderer.planning.planner import plan
from proxy_renderer.render.cycles import CyclesPicture
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import load_scene
from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import SceneDescription

KEY = "material/Sign/emission"


@pytest.fixture(params=["Principled", "Emission"])
def sign(request, scene):
    """A cube that glows in a checker of 0 and 3, by one of the shaders that glow."""
    material = scenes.principled("Sign", scenes.cube(scene, "Sign", (0.0, 0.0, 0.0), 2.0))
    tree = material.node_tree
    glow = scenes.shader(material)
    if request.param == "Emission":
        glow = tree.nodes.new("ShaderNodeEmission")
        tree.links.new(glow.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    color = glow.inputs["Emission Color" if request.param == "Principled" else "Color"]
    color.default_value = (0.2, 0.8, 0.4, 1.0)
    checker, math = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexChecker", "Math"))
    checker.inputs["Color1"].default_value, checker.inputs["Color2"].default_value = ((1, 1, 1, 1), (0, 0, 0, 1))
    checker.inputs["Scale"].default_value = 2.0
    math.operation, math.inputs[1].default_value = "MULTIPLY", 3.0
    tree.links.new(checker.outputs["Color"], math.inputs[0])
    entry = "Emission Strength" if request.param == "Principled" else "Strength"
    tree.links.new(math.outputs[0], glow.inputs[entry])
    scenes.camera(scene)
    scenes.world(scene).node_tree.nodes["Background"].inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    scene.render.resolution_x = scene.render.resolution_y = 64
    return scene


def test_a_factor_turns_it_down_as_predicted_and_is_reverted(sign, tmp_path):
    before = dump.contents()
    job = reading.export_scene(sign, tmp_path, SubjectChoice(("Sign",)))
    assert (job.instances[KEY].value, job.instances[KEY].locked) == ((1.0,), "")
    assert glows(load_scene(tmp_path))["Sign"].strength == pytest.approx(1.5, abs=0.4)
    place = job.analysis.objects, job.analysis.pivot
    scene = load_scene(tmp_path)
    for values in ({}, {KEY: (0.25,)}):
        groups = anchors.render_anchor(sign, tmp_path / "a.exr", values, *place, 64, 32)
        cycles = CyclesPicture.load(tmp_path / "a.exr", groups).whole.mean((0, 1))
        with torch.no_grad():
            given = {key: torch.tensor(value) for key, value in values.items()}
            predicted = Proxy(scene, (64, 64)).render(given).linear.mean((0, 1))
        assert ((predicted - cycles).abs() < 0.08 * cycles.max()).all()
    assert bindings.write(sign, {KEY: (0.25,)}, *place) == {}
    assert bindings.read(sign, *place)[KEY] == pytest.approx((0.25,))
    again = reading.export_scene(sign, tmp_path / "again", SubjectChoice(("Sign",)))
    assert again.instances[KEY].value == pytest.approx((0.25,))
    assert glows(load_scene(tmp_path / "again"))["Sign"].strength == pytest.approx(1.5, abs=0.4)
    snapshot.revert(sign)
    assert dump.difference(before, dump.contents()) == {}


def test_words_reckon_with_what_the_nodes_give(sign, tmp_path):
    math = next(n for n in bpy.data.materials["Sign"].node_tree.nodes if n.type == "MATH")
    math.inputs[1].default_value = 0.2
    reading.export_scene(sign, tmp_path, SubjectChoice(("Sign",)))
    data = load_scene(tmp_path)
    parsed = parse("glowing sign", SceneDescription())
    entries = plan(goals_of(parsed), dict(data.instances), SceneDescription(emitters=glows(data)))
    shown = [v[0] * glows(data)["Sign"].strength for v in (entries[KEY].lower, entries[KEY].upper)]
    assert shown[1] > shown[0] > 0.1


@pytest.fixture
def fire(scene):
    """A flame: an Emission whose color a ColorRamp gives, mixed with a Transparent BSDF."""
    material = scenes.principled("Flame", scenes.cube(scene, "Fire", (0.0, 0.0, 0.0), 2.0))
    tree = material.node_tree
    names = ("Emission", "BsdfTransparent", "MixShader", "TexGradient", "TexCoord", "ValToRGB")
    glow, clear, mix, gradient, place, ramp = (tree.nodes.new(f"ShaderNode{name}") for name in names)
    ramp.color_ramp.elements[0].color = (1.0, 0.7, 0.0, 1.0)
    ramp.color_ramp.elements[1].color = (1.0, 0.1, 0.0, 1.0)
    glow.inputs["Strength"].default_value = 3.0
    tree.links.new(place.outputs["Generated"], gradient.inputs[0])
    tree.links.new(gradient.outputs["Color"], ramp.inputs[0])
    tree.links.new(ramp.outputs["Color"], glow.inputs["Color"])
    mix.inputs[0].default_value = 0.8
    tree.links.new(clear.outputs[0], mix.inputs[1])
    tree.links.new(glow.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    scenes.camera(scene)
    scenes.world(scene).node_tree.nodes["Background"].inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    scene.render.resolution_x = scene.render.resolution_y = 64
    return scene


@pytest.mark.parametrize("prompt", ["blue fire", "the fire glows blue"])
def test_a_fire_of_a_color_ramp_turns_blue(fire, tmp_path, prompt):
    before = dump.contents()
    job = reading.export_scene(fire, tmp_path, SubjectChoice(("Fire",)))
    data = load_scene(tmp_path)
    parsed = parse(
        prompt, SceneDescription(subject="Fire", objects={"Fire": "subject"}, materials={"Flame": "subject"})
    )
    entries = plan(goals_of(parsed), dict(data.instances), SceneDescription(emitters=glows(data)))
    names = ("emission_color", "recolor")
    keys = [key for key in (f"material/Flame/{name}" for name in names) if entries[key].priority is not None]
    values = {
        key: tuple((a + b) / 2 for a, b in zip(entries[key].lower, entries[key].upper, strict=True)) for key in keys
    }
    place = job.analysis.objects, job.analysis.pivot
    groups = anchors.render_anchor(fire, tmp_path / "a.exr", values, *place, 64, 32)
    cycles = CyclesPicture.load(tmp_path / "a.exr", groups).whole.mean((0, 1))
    with torch.no_grad():
        given = {key: torch.tensor(value) for key, value in values.items()}
        predicted = Proxy(data, (64, 64)).render(given).linear.mean((0, 1))
    assert cycles[2] > 1.5 * cycles[0]
    assert ((predicted - cycles).abs() < 0.08 * cycles.max()).all()
    assert bindings.write(fire, values, *place) == {}
    snapshot.revert(fire)
    assert dump.difference(before, dump.contents()) == {}
