# SPDX-License-Identifier: GPL-3.0-or-later
"""Glowing surfaces as in Cycles: a bulb lights fog, and has a halo; a rough floor mirrors a softbox."""

import bpy
import torch
from vibe_render.core import compat
from vibe_render.export import reading
from vibe_render.render import final_render
from vibe_render.scene.subject import SubjectChoice

from lab.bench.metrics import difference
from lab.blender.scenes.build import build
from lab.blender.scenes.recipe import CameraRecipe, FinishRecipe, FogRecipe, SceneRecipe, WorldRecipe
from proxy_renderer.engine.pictures import load_picture
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import load_scene


def test_the_halo_of_a_bulb_in_fog(tmp_path):
    bulb = FinishRecipe((0.8, 0.8, 0.8), 0.8, inputs={"Emission Strength": 9.0, "Emission Color": (1.0, 0.6, 0.25)})
    iron = FinishRecipe((0.2, 0.1, 0.05), 0.8)
    world = WorldRecipe(1.0, (0.01, 0.01, 0.015))
    ground = FinishRecipe((0.4, 0.35, 0.3), 0.9)
    finishes = (bulb, *(iron,) * 6)
    recipe = SceneRecipe(
        "bulb", "lantern", finishes, (), world, ground=ground, fog=FogRecipe(0.4), view=CameraRecipe(12.0, 10.0)
    )
    scene, subject = build(recipe, 0)
    reading.export_scene(scene, tmp_path, SubjectChoice(tuple(o.name for o in subject)))
    final_render.render_picture(scene, tmp_path / "cycles.png", 64, 96)
    cycles = torch.from_numpy(load_picture(tmp_path / "cycles.png").copy())
    proxy = Proxy(load_scene(tmp_path), (64, 64))
    with torch.no_grad():
        picture = proxy.render({}).display
    assert any(proxy.emitters.clusters.values())
    found = difference(picture, cycles)
    print(found, cycles.mean(), picture.mean())
    assert found.delta_e < 2.0
    assert abs(cycles.mean() - picture.mean()) < 0.04 * cycles.mean()


def test_a_rough_floor_mirrors_softboxes(scene, tmp_path):
    """Blurred, as bright as in Cycles: before, half of what it showed was a sharp picture."""
    compat.enable_nodes(scene.world or _world(scene))
    _plane("Floor", 30.0, (0, 0, 0), (0, 0, 0), Roughness=0.2, Base_Color=(0.2, 0.2, 0.2, 1))
    _plane("Softbox", 2.5, (-1, 3.5, 2.6), (1.1, 0, 0.2), Emission_Strength=8.0, Emission_Color=(1, 1, 1, 1))
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (0, -6, 2), (1.3, 0, 0)
    scene.collection.objects.link(camera)
    scene.camera, scene.render.resolution_x, scene.render.resolution_y = camera, 96, 96
    reading.export_scene(scene, tmp_path, SubjectChoice(("Floor",)))
    final_render.render_picture(scene, tmp_path / "cycles.png", 96, 128)
    cycles = torch.from_numpy(load_picture(tmp_path / "cycles.png").copy())
    with torch.no_grad():
        picture = Proxy(load_scene(tmp_path), (96, 96)).render({}).display
    found = difference(picture[48:], cycles[48:])
    assert found.delta_e < 1.5
    assert found.p95 < 6.0


def _world(scene):
    scene.world = bpy.data.worlds.new("World")
    scene.world.color = (0, 0, 0)
    return scene.world


def _plane(name, size, place, turn, **inputs):
    bpy.ops.mesh.primitive_plane_add(size=size, location=place, rotation=turn)
    material = bpy.data.materials.new(name)
    compat.enable_nodes(material)
    bpy.context.object.name = name
    bpy.context.object.data.materials.append(material)
    sockets = material.node_tree.nodes["Principled BSDF"].inputs
    for key, value in inputs.items():
        sockets[key.replace("_", " ")].default_value = value
