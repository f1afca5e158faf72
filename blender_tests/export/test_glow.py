# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene that glowing surfaces light: words about light are about them, wherever they hang."""

import bpy
import dump
import pytest
import small_scenes as scenes
from vibe_render.export import reading
from vibe_render.scene import bindings, prepare, snapshot
from vibe_render.scene.subject import SubjectChoice

from proxy_renderer.goals.resolve import goals_of
from proxy_renderer.optimize.scene_facts import described
from proxy_renderer.optimize.stage import set_stage
from proxy_renderer.planning.planner import plan
from proxy_renderer.scene import load_scene
from proxy_renderer.words.parser import parse


@pytest.fixture
def panel(scene):
    """A cube under a large glowing panel that the camera does not see; a dial on it glows as well."""
    subject = scenes.cube(scene, "Cube", (0.0, 0.0, 0.0), 2.0)
    scenes.principled("Paint", subject)
    scenes.camera(scene)
    scenes.world(scene).node_tree.nodes["Background"].inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    for name, place, size, strength in (("Panel", (0.0, 0.0, 5.0), 2.0, 12.0), ("Dial", (0.9, -1.1, 0.9), 0.02, 5.0)):
        material = scenes.principled(name, scenes.cube(scene, name, place, size))
        scenes.shader(material).inputs["Emission Color"].default_value = (1.0, 1.0, 1.0, 1.0)
        scenes.shader(material).inputs["Emission Strength"].default_value = strength
    return scene


def planned(scene, prompt, folder):
    reading.export_scene(scene, folder, SubjectChoice(("Cube",)))
    addition = set_stage([load_scene(folder)], prompt)
    data = addition.scenes[0]
    known = described(data)
    goals = goals_of(parse(prompt, known))
    return plan(goals, dict(data.instances), known, light=addition.plan)


def test_no_key_is_added_where_a_panel_lights_the_scene(panel):
    prepare.prepare_scene(panel)
    assert "Vibe Key" not in panel.objects


def test_a_glowing_curve_whose_emission_is_mixed_in_lights_the_scene(panel):
    panel.objects["Panel"].hide_render = True
    curve = bpy.data.curves.new("Tube", "FONT")
    curve.body, curve.extrude, curve.size = "NEON", 0.2, 3.0
    tube = bpy.data.objects.new("Tube", curve)
    tube.location = (-2.0, -2.0, 2.0)
    panel.collection.objects.link(tube)
    material = scenes.principled("Neon", tube)
    tree = material.node_tree
    mix, glow = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("MixShader", "Emission"))
    glow.inputs["Strength"].default_value = 30.0
    tree.links.new(scenes.shader(material).outputs[0], mix.inputs[1])
    tree.links.new(glow.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    prepare.prepare_scene(panel)
    assert "Vibe Key" not in panel.objects


def test_a_dial_does_not_light_a_scene(panel):
    panel.objects["Panel"].hide_render = True
    prepare.prepare_scene(panel)
    assert panel.objects["Vibe Key"].data.energy > 0


def test_warm_light_is_the_panels_color_and_not_the_dials(panel, tmp_path):
    entries = planned(panel, "warm light", tmp_path)
    color = entries["material/Panel/emission_color"]
    assert color.priority is not None
    assert color.upper[2] < 0.6 < color.upper[0]
    assert entries["material/Dial/emission_color"].priority is None


def test_dim_light_turns_the_panel_down_from_what_it_is(panel, tmp_path):
    entry = planned(panel, "dim light", tmp_path)["material/Panel/emission"]
    assert 12.0 * 0.15 < entry.lower[0] < entry.upper[0] < 12.0 * 0.7


def test_a_panel_that_a_word_names_is_meant(panel, tmp_path):
    side = scenes.principled("Window", scenes.cube(panel, "Window", (-5.0, 0.0, 0.0), 2.0))
    scenes.shader(side).inputs["Emission Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    scenes.shader(side).inputs["Emission Strength"].default_value = 12.0
    entries = planned(panel, "warm panel, cold blue window light", tmp_path)
    warm, cold = (entries[f"material/{name}/emission_color"] for name in ("Panel", "Window"))
    assert cold.upper[0] < cold.lower[2]
    assert warm.upper[2] < warm.lower[0]


def test_light_from_a_side_that_no_panel_can_take_is_added(panel, tmp_path):
    assert "light/Vibe Key/azimuth" in planned(panel, "light from the left", tmp_path)


def test_a_glow_whose_color_nodes_compute_gets_a_tint(panel, tmp_path):
    tree = bpy.data.materials["Panel"].node_tree
    ramp = tree.nodes.new("ShaderNodeValToRGB")
    for stop in ramp.color_ramp.elements:
        stop.color = (0.6, 0.7, 1.0, 1.0)
    tree.links.new(ramp.outputs["Color"], scenes.shader(bpy.data.materials["Panel"]).inputs["Emission Color"])
    before = dump.contents()
    entries = planned(panel, "warm light", tmp_path)
    tint = entries["material/Panel/emission_color"]
    assert tint.priority is not None
    assert tint.upper[2] < 0.5 * tint.lower[0]
    assert not any("Panel: Emission Color" in note for note in entries.notes)
    analysis = reading.read_scene(panel, SubjectChoice(("Cube",))).analysis
    assert bindings.write(panel, {"material/Panel/emission_color": tint.lower}, analysis.objects, analysis.pivot) == {}
    read = bindings.read(panel, analysis.objects, analysis.pivot)["material/Panel/emission_color"]
    assert read == pytest.approx(tint.lower, abs=1e-5)
    snapshot.revert(panel)
    assert dump.difference(before, dump.contents()) == {}
