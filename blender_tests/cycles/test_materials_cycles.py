# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials, alpha and the transparent film: the proxy's picture against Cycles'."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
import torch
from marks import few_of
from mathutils import Vector
from vibe_render.core import compat
from vibe_render.export import reading
from vibe_render.render import final_render
from vibe_render.scene.subject import SubjectChoice

from proxy_renderer.color.tensors import ciede2000, lab_from_srgb
from proxy_renderer.engine.pictures import load_picture
from proxy_renderer.render.proxy import Proxy, Render
from proxy_renderer.scene import load_scene

SIZE, SAMPLES = 96, 64


@pytest.fixture
def stage(scene: bpy.types.Scene) -> bpy.types.Scene:
    """A floor, an area light, a gray world, and a camera that looks at (0, 0, 1)."""
    scene.render.resolution_x, scene.render.resolution_y = 96, 80
    _paint(_add("plane", size=30), "Floor", Base_Color=(0.5, 0.45, 0.4), Roughness=0.7)
    lamp = bpy.data.lights.new("Lamp", "AREA")
    lamp.energy, lamp.size = 400.0, 1.0
    _aim("Lamp", lamp, (3, -3, 4))
    scene.camera = _aim("Camera", bpy.data.cameras.new("Camera"), (0, -6, 2))
    scene.world = bpy.data.worlds.new("World")
    compat.enable_nodes(scene.world)
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.2, 0.22, 0.26, 1)
    return scene


def _add(kind: str, **more) -> bpy.types.Object:
    getattr(bpy.ops.mesh, f"primitive_{kind}_add")(**more)
    return bpy.context.object


def _ball(name: str, **inputs) -> bpy.types.Material:
    thing = _add("uv_sphere", radius=1.0, location=(0, 0, 1), segments=48, ring_count=24)
    bpy.ops.object.shade_smooth()
    return _paint(thing, name, **inputs)


def _paint(thing: bpy.types.Object, name: str, **inputs) -> bpy.types.Material:
    """Names an object and gives it a Principled material; "_" in an input's name stands for a space."""
    thing.name = name
    material = bpy.data.materials.new(name)
    compat.enable_nodes(material)
    sockets = material.node_tree.nodes["Principled BSDF"].inputs
    for key, value in inputs.items():
        sockets[key.replace("_", " ")].default_value = (*value, 1) if isinstance(value, tuple) else value
    thing.data.materials.append(material)
    return material


def _aim(name: str, data: bpy.types.ID, place: tuple[float, float, float]) -> bpy.types.Object:
    thing = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(thing)
    thing.location = place
    thing.rotation_euler = (Vector(place) - Vector((0, 0, 1))).to_track_quat("Z", "Y").to_euler()
    return thing


def _compare(scene: bpy.types.Scene, folder: Path) -> tuple[torch.Tensor, Render, list[str]]:
    """CIEDE2000 (H, W) between proxy and Cycles, the proxy's render, and the export's warnings."""
    job = reading.export_scene(scene, folder / "job", SubjectChoice())
    final_render.render_picture(scene, folder / "cycles.png", SIZE, SAMPLES)
    cycles = torch.from_numpy(load_picture(folder / "cycles.png"))
    with torch.no_grad():
        render = Proxy(load_scene(folder / "job"), (cycles.shape[1], cycles.shape[0])).render({})
    lab = lab_from_srgb(cycles), lab_from_srgb(render.display)
    return ciede2000(*lab), render, job.warnings


def test_transparent_film_shows_black_and_covers_what_is_hit(stage, tmp_path):
    _ball("Ball", Base_Color=(0.6, 0.15, 0.1))
    bpy.data.objects.remove(bpy.data.objects["Floor"])
    stage.render.film_transparent = True
    difference, render, _ = _compare(stage, tmp_path)
    assert render.alpha[0, 0] == 0
    assert render.alpha[40, 48] == 1
    assert 0 < render.alpha.mean() < 0.6
    assert difference.mean() < 1.0


def _node(tree: bpy.types.NodeTree, kind: str, **inputs) -> bpy.types.Node:
    made = tree.nodes.new(f"ShaderNode{kind}")
    for name, value in inputs.items():
        made.inputs[name].default_value = value
    return made


def _pattern(material: bpy.types.Material, socket: str, low: tuple, high: tuple) -> None:
    """Feeds an input of the Principled BSDF with noise in object coordinates."""
    tree = material.node_tree
    place, noise, ramp = _node(tree, "TexCoord"), _node(tree, "TexNoise", Scale=2.0), _node(tree, "ValToRGB")
    for element, at, shade in zip(ramp.color_ramp.elements, (0.4, 0.6), (low, high), strict=True):
        element.position, element.color = at, (*shade, 1)
    tree.links.new(place.outputs["Object"], noise.inputs["Vector"])
    tree.links.new(noise.outputs[0], ramp.inputs[0])
    tree.links.new(ramp.outputs[0], tree.nodes["Principled BSDF"].inputs[socket])


@pytest.mark.parametrize(
    ("socket", "low", "high", "inputs", "most"),
    [
        ("Base Color", (0.7, 0.1, 0.05), (0.05, 0.2, 0.6), {}, 2.0),
        ("Roughness", (0.1,) * 3, (0.7,) * 3, {"Base_Color": (0.9, 0.6, 0.3), "Metallic": 1.0}, 2.5),
        ("Metallic", (0.0,) * 3, (1.0,) * 3, {"Base_Color": (0.9, 0.6, 0.3), "Roughness": 0.4}, 2.0),
        ("Emission Color", (0.0,) * 3, (1, 0.3, 0.05), {"Emission_Strength": 3.0}, 2.0),
        ("Alpha", (0.0,) * 3, (1.0,) * 3, {"Base_Color": (0.3, 0.6, 0.2)}, 3.0),
    ],
)
def test_procedural_networks_arrive_per_pixel(stage, tmp_path, socket, low, high, inputs, most):
    _pattern(_ball("Ball", **inputs), socket, low, high)
    difference, _, warnings = _compare(stage, tmp_path)
    assert difference.mean() < most
    assert not warnings


def test_bumps_arrive_per_pixel(stage, tmp_path):
    tree = _ball("Ball", Base_Color=(0.6, 0.4, 0.2), Roughness=0.3).node_tree
    noise, bump = _node(tree, "TexNoise", Scale=3.0), _node(tree, "Bump", Strength=0.8, Distance=0.3)
    place = _node(tree, "TexCoord")
    tree.links.new(place.outputs["Object"], noise.inputs["Vector"])
    tree.links.new(noise.outputs[0], bump.inputs["Height"])
    tree.links.new(bump.outputs[0], tree.nodes["Principled BSDF"].inputs["Normal"])
    difference, _, warnings = _compare(stage, tmp_path)
    assert difference.mean() < 2.0
    assert not warnings


def test_patterns_in_a_shared_node_group(stage, tmp_path):
    group = bpy.data.node_groups.new("Pattern", "ShaderNodeTree")
    group.interface.new_socket("BSDF", in_out="OUTPUT", socket_type="NodeSocketShader")
    shader, cells, end = (_node(group, k) for k in ("BsdfPrincipled", "TexVoronoi", "TexCoord"))
    group.links.new(end.outputs["Object"], cells.inputs["Vector"])
    group.links.new(cells.outputs["Color"], shader.inputs["Base Color"])
    group.links.new(shader.outputs[0], group.nodes.new("NodeGroupOutput").inputs[0])
    for material in (_ball("Ball"), bpy.data.materials["Floor"]):
        outer = material.node_tree
        node = outer.nodes.new("ShaderNodeGroup")
        node.node_tree = group
        outer.links.new(node.outputs[0], outer.nodes["Material Output"].inputs["Surface"])
    assert _compare(stage, tmp_path)[0].mean() < 3.0


def _leaf() -> bpy.types.Image:
    """A disc: inside color and opaque, outside transparent."""
    y, x = np.mgrid[0:128, 0:128] / 128 - 0.5
    inside = np.hypot(x, y) < 0.35
    image = bpy.data.images.new("Leaf", 128, 128, alpha=True)
    image.pixels.foreach_set(np.stack([x + 0.5, y * 0 + 0.5, y + 0.5, inside], -1).astype(np.float32).ravel())
    image.pack()
    return image


@pytest.mark.parametrize("way", few_of(["Alpha", "Mix Shader", "Mix Shader, turned"], ["Mix Shader"]))
def test_leaf_cards_are_cut_out_and_cast_their_shadow(stage, tmp_path, way):
    card = _add("plane", size=3, location=(0, 0, 1.3), rotation=(1.2, 0, 0.3))
    tree = _paint(card, "Card").node_tree
    shader, leaf = tree.nodes["Principled BSDF"], _node(tree, "TexImage")
    leaf.image = _leaf()
    tree.links.new(leaf.outputs["Color"], shader.inputs["Base Color"])
    if way == "Alpha":
        tree.links.new(leaf.outputs["Alpha"], shader.inputs["Alpha"])
    else:
        mix, clear, turn = _node(tree, "MixShader"), _node(tree, "BsdfTransparent"), _node(tree, "Invert")
        turned = way.endswith("turned")
        tree.links.new(leaf.outputs["Alpha"], turn.inputs["Color"])
        tree.links.new((turn.outputs[0] if turned else leaf.outputs["Alpha"]), mix.inputs[0])
        for number, part in zip((1, 2), (shader, clear) if turned else (clear, shader), strict=True):
            tree.links.new(part.outputs[0], mix.inputs[number])
        tree.links.new(mix.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    difference, _, warnings = _compare(stage, tmp_path)
    assert difference.mean() < 1.5
    assert not warnings


@pytest.mark.parametrize("alpha", few_of([0.3, 0.7], [0.3]))
def test_half_transparent_things(stage, tmp_path, alpha):
    _ball("Ball", Base_Color=(0.6, 0.15, 0.1), Alpha=alpha)
    assert _compare(stage, tmp_path)[0].mean() < 1.5


def test_measuring_leaves_node_trees_alone(stage, tmp_path):
    _pattern(_ball("Ball"), "Roughness", (0.1,) * 3, (0.7,) * 3)
    tree = bpy.data.materials["Ball"].node_tree
    before = [(n.name, n.select) for n in tree.nodes], len(tree.links), tree.nodes.active.name
    reading.export_scene(stage, tmp_path / "job", SubjectChoice())
    assert ([(n.name, n.select) for n in tree.nodes], len(tree.links), tree.nodes.active.name) == before
    assert "Vibe Bake" not in bpy.data.scenes


def _surface(material: bpy.types.Material, kind: str, **inputs) -> bpy.types.Node:
    """Puts another shader in the place of the Principled BSDF."""
    tree = material.node_tree
    node = _node(tree, kind, **inputs)
    tree.links.new(node.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    return node


@pytest.mark.parametrize(("kind", "most"), [("BsdfToon", 4.0), ("BsdfSheen", 4.0), ("BsdfHairPrincipled", 15.0)])
def test_rare_shaders_are_approximated_with_a_warning(stage, tmp_path, kind, most):
    _surface(_ball("Ball"), kind, Color=(0.7, 0.3, 0.2, 1))
    difference, _, warnings = _compare(stage, tmp_path)
    assert difference.mean() < most
    assert any("Ball" in w and "approximated" in w for w in warnings)


def test_shader_to_rgb_is_left_out_as_cycles_does(stage, tmp_path):
    material = _ball("Ball", Base_Color=(0.6, 0.3, 0.2))
    flat = _surface(material, "Emission", Strength=0.3)
    toon = _node(material.node_tree, "ShaderToRGB")
    material.node_tree.links.new(material.node_tree.nodes["Principled BSDF"].outputs[0], toon.inputs[0])
    material.node_tree.links.new(toon.outputs[0], flat.inputs["Color"])
    difference, _, warnings = _compare(stage, tmp_path)
    assert difference.mean() < 1.5
    assert any("Shader to RGB" in warning and "Ball" in warning for warning in warnings)


@pytest.mark.parametrize("share", few_of([0.2, 0.6, "Fresnel"], [0.2]))
def test_the_old_plastic_of_diffuse_and_glossy(stage, tmp_path, share):
    material = _ball("Ball")
    mix, tree = _surface(material, "MixShader"), material.node_tree
    diffuse = _node(tree, "BsdfDiffuse", Color=(0.6, 0.1, 0.1, 1))
    glossy = _node(tree, "BsdfGlossy", Color=(0.9, 0.9, 0.9, 1), Roughness=0.2)
    for number, part in ((1, diffuse), (2, glossy)):
        tree.links.new(part.outputs[0], mix.inputs[number])
    if share == "Fresnel":
        tree.links.new(_node(tree, share, IOR=1.6).outputs[0], mix.inputs[0])
    else:
        mix.inputs[0].default_value = share
    difference, _, warnings = _compare(stage, tmp_path)
    assert difference.mean() < 2.5
    assert "The mix of shaders is approximated in Ball." in warnings


@pytest.mark.slow
def test_metals_are_mirrors_in_mirrors_too(stage, tmp_path):
    """Gold between gold: taken for matte paint where another shows them, they would glow orange."""
    for name, x, roughness in (("Left", -1.05, 0.1), ("Right", 1.05, 0.3)):
        material = _ball(name, Base_Color=(0.9, 0.65, 0.3), Metallic=1.0, Roughness=roughness)
        bpy.data.objects[material.name].location.x = x
    assert _compare(stage, tmp_path)[0].mean() < 1.8


@pytest.mark.parametrize(
    ("roughness", "tint", "most"), few_of([(0.0, 1.0, 1.7), (0.0, 0.4, 2.1), (0.3, 1.0, 2.0)], [(0.3, 1.0, 2.0)])
)
def test_glass_lets_light_through(stage, tmp_path, roughness, tint, most):
    """Were its shadow as dark as a stone's, the floor below would be far off."""
    _ball("Ball", Base_Color=(tint, 1.0, tint), Transmission_Weight=1.0, Roughness=roughness)
    assert _compare(stage, tmp_path)[0].mean() < most


@pytest.mark.parametrize("tint", [(0.3, 0.6, 1.0), (0.0, 0.0, 0.0)])
def test_the_edge_tint_of_metals_colors_reflections_too(stage, tmp_path, tint):
    _ball("Ball", Base_Color=(0.9, 0.65, 0.3), Metallic=1.0, Roughness=0.25, Specular_Tint=tint)
    assert _compare(stage, tmp_path)[0].mean() < 1.6


@pytest.mark.slow
def test_a_mirror_shows_the_ground_that_the_camera_does_not_see(stage, tmp_path):
    """A chrome ball on a checker board, most of which lies outside the picture."""
    _ball("Ball", Base_Color=(0.9, 0.9, 0.9), Metallic=1.0, Roughness=0.0)
    tree = bpy.data.materials["Floor"].node_tree
    board = _node(tree, "TexChecker", Scale=0.7, Color1=(0.8, 0.8, 0.8, 1), Color2=(0.05, 0.05, 0.05, 1))
    place = _node(tree, "TexCoord")
    tree.links.new(place.outputs["Object"], board.inputs["Vector"])
    tree.links.new(board.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    difference, _, warnings = _compare(stage, tmp_path)
    assert not warnings
    assert difference.mean() < 1.9


def _mixed(tree: bpy.types.NodeTree, first: bpy.types.Node, second: bpy.types.Node, fac) -> bpy.types.Node:
    mix = _node(tree, "MixShader")
    for number, part in ((1, first), (2, second)):
        tree.links.new(part.outputs[0], mix.inputs[number])
    tree.links.new(fac, mix.inputs[0])
    tree.links.new(mix.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    return mix


@pytest.mark.parametrize(("mix", "most"), [("car paint", 1.4), ("two paints", 2.0), ("glowing veins", 3.0)])
def test_mixes_arrive_as_their_sum(stage, tmp_path, mix, most):
    """One of the shaders alone was 1.8, 5.9 and 7.5 off."""
    tree = _ball("Ball").node_tree
    red, gray, green = (0.6, 0.1, 0.05, 1), (0.8, 0.8, 0.8, 1), (0.05, 0.4, 0.1, 1)
    noise, place = _node(tree, "TexChecker", Scale=1.5), _node(tree, "TexCoord")
    tree.links.new(place.outputs["Object"], noise.inputs["Vector"])
    if mix == "car paint":
        parts = [_node(tree, "BsdfGlossy", Color=c, Roughness=r) for c, r in ((red, 0.5), (gray, 0.1))]
        _mixed(tree, *parts, _node(tree, "LayerWeight").outputs["Fresnel"])
    elif mix == "two paints":
        parts = [_node(tree, "BsdfDiffuse", Color=c) for c in (red, green)]
        _mixed(tree, *parts, noise.outputs["Fac"])
    else:
        glow = _node(tree, "Emission", Color=green, Strength=2.0)
        _mixed(tree, _node(tree, "BsdfDiffuse", Color=red), glow, noise.outputs["Fac"])
    assert _compare(stage, tmp_path)[0].mean() < most
