# SPDX-License-Identifier: GPL-3.0-or-later
"""The example scenes: each is built and has what a finished scene has, within its budget of triangles."""

import importlib
import math
import re
import sys
from pathlib import Path

import bpy
import pytest
from mathutils import Vector

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
SCENES = ("interior", "product", "street", "landscape", "bust", "car")
MOST = 60_000
PRIMITIVES = re.compile(r"(Cube|Sphere|Plane|Cylinder|Mesh|Material|Curve|Object)\b|.*\.\d{3}$")


@pytest.fixture(params=SCENES)
def example(request, tmp_path, monkeypatch):
    """A scene, built by its own script, saved and opened again."""
    monkeypatch.syspath_prepend(str(EXAMPLES))
    monkeypatch.setattr(sys, "argv", ["blender", "--", str(tmp_path / "made" / "scene.blend")])
    script = importlib.import_module(request.param)
    script.b.run(script.build)
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "made" / "scene.blend"))
    return bpy.context.scene


def triangles(scene):
    """How many triangles the scene's objects have with their modifiers."""
    count = 0
    for each in bpy.context.evaluated_depsgraph_get().object_instances:
        if each.object.type in {"MESH", "CURVE", "FONT"} and not each.object.original.hide_render:
            mesh = each.object.to_mesh()
            mesh.calc_loop_triangles()
            count += len(mesh.loop_triangles)
            each.object.to_mesh_clear()
    return count


def middle(obj):
    """The middle of an object's bounding box, in the scene."""
    return obj.matrix_world @ (sum((Vector(corner) for corner in obj.bound_box), Vector()) / 8)


def in_frame(scene, place):
    """Whether the camera's picture holds a point."""
    frame = scene.camera.data.view_frame(scene=scene)
    local = scene.camera.matrix_world.inverted() @ place
    across, up = max(c.x for c in frame) / -frame[0].z, max(c.y for c in frame) / -frame[0].z
    return local.z < 0 and abs(local.x / local.z) < across and abs(local.y / local.z) < up


def test_an_example_is_a_finished_scene(example):
    assert example.camera
    assert example.world
    assert example.render.engine == "CYCLES"
    assert example.view_settings.view_transform == "AgX"
    lights = [o for o in example.objects if o.type == "LIGHT"]
    assert lights
    solid = [o for o in example.objects if o.type in {"MESH", "CURVE", "FONT"}]
    assert all(o.material_slots and o.material_slots[0].material for o in solid)
    names = [o.name for o in example.objects] + [m.name for m in bpy.data.materials]
    assert [name for name in names if PRIMITIVES.match(name)] == []
    assert len({m.name for m in bpy.data.materials}) >= 8
    assert 10_000 < triangles(example) < MOST
    bpy.context.view_layer.update()
    shown = [o for o in solid if in_frame(example, middle(o))]
    assert len(shown) > len(solid) / 4
    assert all(math.isfinite(c) for o in solid for corner in o.bound_box for c in corner)
