# SPDX-License-Identifier: GPL-3.0-or-later
"""Computed colors are tinted, and environments turned, by nodes of ours that compute what they say."""

import bpy
import numpy as np
import pytest
import small_scenes as scenes
from vibe_render.core.color import LUMA
from vibe_render.scene import bindings
from vibe_render.scene.nodes import owned
from vibe_render.scene.nodes.inputs import TINT

PIVOT = (0.0, 0.0, 0.0)
PAINT = (0.6, 0.3, 0.1)


def rendered(scene, tmp_path, samples=4, size=8):
    """Mean linear color of the picture."""
    scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", samples, False
    scene.render.resolution_x = scene.render.resolution_y = size
    settings = scene.render.image_settings
    settings.file_format, settings.color_depth, settings.exr_codec = "OPEN_EXR", "32", "ZIP"
    scene.render.filepath = str(tmp_path / "out.exr")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    pixels = np.array(image.pixels[:]).reshape(size, size, 4)[..., :3]
    bpy.data.images.remove(image)
    return pixels.mean(axis=(0, 1))


def write(scene, subject, **values):
    keyed = {name.replace("__", "/"): np.atleast_1d(value) for name, value in values.items()}
    assert bindings.write(scene, keyed, subject, PIVOT) == {}


@pytest.mark.parametrize(
    ("color", "recolor"),
    [((1.0, 1.0, 1.0), 0.0), ((0.5, 1.0, 1.5), 0.0), ((1.0, 1.0, 1.0), 1.0), ((0.2, 0.9, 0.4), 0.6)],
)
def test_the_tint_of_a_texture(scene, tmp_path, color, recolor):
    wall = scenes.cube(scene, "Wall", size=4.0)
    material = scenes.principled("Paint", wall)
    node, tree = scenes.shader(material), material.node_tree
    node.inputs["Specular IOR Level"].default_value = 0.0
    source = tree.nodes.new("ShaderNodeRGB")
    source.outputs[0].default_value = (*PAINT, 1.0)
    curve = tree.nodes.new("ShaderNodeGamma")
    tree.links.new(source.outputs[0], curve.inputs["Color"])
    tree.links.new(curve.outputs["Color"], node.inputs["Base Color"])
    camera = scenes.camera(scene, (0.0, -4.0, 0.0))
    camera.rotation_euler[0] = np.pi / 2.0
    camera.data.type, camera.data.ortho_scale = "ORTHO", 1.0
    # A white world around a convex body: what leaves it is its albedo.
    scenes.world(scene).node_tree.nodes["Background"].inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    write(scene, [wall], material__Paint__tint=color, material__Paint__recolor=recolor)
    paint = np.array(PAINT)
    wanted = np.array(color) * (paint + recolor * (paint @ LUMA - paint))
    np.testing.assert_allclose(rendered(scene, tmp_path, samples=64), wanted, rtol=0.01)


def test_an_identity_adds_nothing_and_two_materials_share_one_group(scene):
    subject = scenes.textured(scene)
    write(scene, subject, material__Painted__tint=(1.0, 1.0, 1.0), material__Painted__recolor=0.0, world__rotation=0.0)
    assert not bpy.data.node_groups.get("Vibe Tint")
    write(scene, subject, material__Painted__tint=(0.5, 1.0, 1.0), world__tint=(1.0, 0.5, 1.0))
    assert len([g for g in bpy.data.node_groups if owned.MARK in g]) == 1
    (node,) = owned.group_nodes(bpy.data.materials["Painted"].node_tree, TINT.name)
    assert (node.label, node.use_custom_color, node.parent.label) == ("Vibe Tint", True, "Vibe Render")


def surrounded(scene):
    """A world whose environment has another color in each direction; nothing else is in view."""
    scenes.camera(scene, (0.0, 0.0, 0.0)).rotation_euler[0] = np.pi / 2.0
    scene.camera.data.angle = 0.2
    tree = scenes.world(scene).node_tree
    scene.world.cycles.sampling_method = "NONE"  # nothing here is lit, and its importance map takes seconds
    image = bpy.data.images.new("Sky", 64, 32, float_buffer=True)
    u = np.linspace(0.0, 1.0, 64, endpoint=False)
    row = np.stack([u, 1.0 - u, 0.5 + 0.5 * np.sin(2.0 * np.pi * u), np.ones_like(u)], -1)
    image.pixels.foreach_set(np.tile(row, (32, 1, 1)).astype(np.float32).ravel())
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = image
    tree.links.new(texture.outputs["Color"], tree.nodes["Background"].inputs["Color"])
    return tree, texture


@pytest.mark.parametrize("existing", ["", "POINT", "TEXTURE"])
def test_rotation_turns_the_looked_up_direction(scene, tmp_path, existing):
    tree, texture = surrounded(scene)
    if existing:
        mapping, place = tree.nodes.new("ShaderNodeMapping"), tree.nodes.new("ShaderNodeTexCoord")
        mapping.vector_type = existing
        tree.links.new(place.outputs["Generated"], mapping.inputs["Vector"])
        tree.links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
    scene.camera.rotation_euler[2] = np.radians(50.0)  # counter-clockwise, from +Y towards -X
    aside = rendered(scene, tmp_path)
    scene.camera.rotation_euler[2] = 0.0
    ahead = rendered(scene, tmp_path)
    write(scene, (), world__rotation=50.0)
    np.testing.assert_allclose(rendered(scene, tmp_path), aside, atol=2e-3)
    assert np.abs(ahead - aside).max() > 0.1
    assert bindings.read(scene, (), PIVOT)["world/rotation"] == pytest.approx((50.0,), abs=1e-3)
    assert len([n for n in tree.nodes if n.bl_idname == "ShaderNodeMapping"]) == 1
