# SPDX-License-Identifier: GPL-3.0-or-later
"""A Draco-compressed glTF renders as the same file without compression does."""

import bpy
import numpy as np
from packed_mesh import pack
from vibe_render.scene.stage import build_stage

from proxy_renderer.blender.meshes import prepared


def export(path):
    """A textured ball with a metal hat, as Blender itself exports it."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    picture = bpy.data.images.new("Checks", 8, 8)
    pixels = np.ones((8, 8, 4), np.float32)
    pixels[::2, ::2, :2] = 0.1
    picture.pixels.foreach_set(pixels.ravel())
    picture.pack()
    bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=12)
    ball = bpy.context.object
    ball.name = "Ball"
    bpy.ops.mesh.primitive_cube_add(size=0.6, location=(0, 0, 1.3))
    hat = bpy.context.object
    hat.name, hat.parent = "Hat", ball
    for thing in (ball, hat):
        material = bpy.data.materials.new(f"{thing.name} paint")
        if not material.node_tree:  # Blender 5 makes it at once
            material.use_nodes = True
        shader = material.node_tree.nodes["Principled BSDF"]
        if thing is hat:
            shader.inputs["Metallic"].default_value = 1.0
            shader.inputs["Coat Weight"].default_value = 0.7
        else:
            texture = material.node_tree.nodes.new("ShaderNodeTexImage")
            texture.image = picture
            material.node_tree.links.new(texture.outputs["Color"], shader.inputs["Base Color"])
        thing.data.materials.append(material)
    bpy.ops.export_scene.gltf(filepath=str(path), export_format="GLB")
    return path


def look_at(path, folder):
    """The names, parents, materials and UV maps of a staged mesh, what its materials are, and a picture of it."""
    scene = build_stage(path)
    scene.render.engine, scene.cycles.samples = "CYCLES", 8
    scene.render.resolution_x = scene.render.resolution_y = 64
    scene.render.filepath = str(folder / f"{path.stem}.png")
    bpy.ops.render.render(write_still=True)
    picture = bpy.data.images.load(scene.render.filepath)
    things = {
        o.name: (o.parent and o.parent.name, o.active_material.name, len(o.data.uv_layers), len(o.data.polygons))
        for o in bpy.context.selected_objects
    }
    shaders = {
        m.name: [
            n.inputs[name].default_value
            for name in ("Metallic", "Coat Weight")
            for n in m.node_tree.nodes
            if n.type == "BSDF_PRINCIPLED"
        ]
        for m in bpy.data.materials
        if m.name.endswith("paint")
    }
    return things, shaders, np.array(picture.pixels).reshape(64, 64, 4)


def test_it_renders(tmp_path):
    plain = export(tmp_path / "plain.glb")
    packed = pack(plain, tmp_path / "packed.glb")
    things, shaders, picture = look_at(plain, tmp_path)
    assert set(things) == {"Ball", "Hat"}
    assert picture[..., :3].std() > 0.05
    with prepared(packed) as place:
        others, their_shaders, other = look_at(place, tmp_path)
    assert others == things
    assert their_shaders == shaders
    assert np.abs(other - picture).mean() < 0.002
