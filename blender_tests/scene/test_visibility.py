# SPDX-License-Identifier: GPL-3.0-or-later
"""What the camera sees of a scene, against Blender's own rays."""

import bpy
import numpy as np
import pytest
from mathutils import Vector
from vibe_render.export import analysis
from vibe_render.scene.geometry.triangles import camera_rays, ray_camera
from vibe_render.scene.stage import build_demo


def blenders(scene):
    """The object that each ray meets, by Blender's own casting; "" for none."""
    starts, directions = camera_rays(ray_camera(scene), 48)
    graph = bpy.context.evaluated_depsgraph_get()
    lens, ahead = scene.camera.data, -np.array(scene.camera.matrix_world.normalized())[:3, 2]
    names = np.full(starts.shape[:2], "", object)
    for index in np.ndindex(names.shape):
        way = Vector(directions[index])
        start = Vector(starts[index]) + way * (lens.clip_start / (directions[index] @ ahead))
        met = scene.ray_cast(graph, start, way)
        names[index] = met[4].name if met[0] else ""
    return names


@pytest.mark.parametrize(
    ("kind", "lens", "shift"), [("PERSP", 50, 0.0), ("PERSP", 12, 0.3), ("PERSP", 200, 0.0), ("ORTHO", 2, 0.0)]
)
def test_rays_meet_what_blenders_own_meet(kind, lens, shift):
    """Things behind the camera and between the rays are left out before; what is met stays the same."""
    scene = build_demo()
    bpy.ops.mesh.primitive_cube_add(size=60)  # around everything, the camera included
    camera = scene.camera.data
    camera.type, camera.shift_x = kind, shift
    camera.lens, camera.ortho_scale = lens, lens
    bpy.context.view_layer.update()
    visible_scene = analysis.capture(scene).visible_scene()
    names = np.array([name for name, _ in visible_scene.geometry.objects] + [""], object)[visible_scene.visible.object]
    assert len(set(names.ravel())) > 2
    assert (names == blenders(scene)).mean() > 0.99  # edges are rounded otherwise
