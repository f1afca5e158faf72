# SPDX-License-Identifier: GPL-3.0-or-later
"""The key light is the one that Cycles shows as the brightest on the subject, whatever its type."""

import math
from pathlib import Path

import bpy
import numpy as np
import pytest
from vibe_render.core import compat
from vibe_render.core.schema_import import schema
from vibe_render.scene import scene_context
from vibe_render.scene.orbits import orbit_matrix
from vibe_render.scene.stage import mesh_object, plain_material, plain_world

SIZE = 16
LEVEL = 0.4  # radiance that each light gives to the plane
DISTANCES = {"SUN": 5.0, "AREA": 3.0, "SPOT": 2.5, "POINT": 4.0}


@pytest.fixture
def lights(scene):
    """A white diffuse plane that faces its camera, and one light of each type in front of it, all switched off."""
    white = plain_material("White", (1.0, 1.0, 1.0), roughness=1.0)
    shader = next(n for n in compat.node_tree(white).nodes if n.bl_idname == "ShaderNodeBsdfPrincipled")
    shader.inputs["Specular IOR Level"].default_value = 0.0
    corners = np.array([(-1, 0, -1), (1, 0, -1), (1, 0, 1), (-1, 0, 1)], float)
    mesh_object(scene, "Plane", corners, [(0, 1, 2, 3)], white)
    plain_world(scene, (0.0, 0.0, 0.0), 0.0)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.matrix_world, camera.data.angle = (orbit_matrix((0.0, 0.0, 0.0), 0.0, 0.0, 6.0), math.radians(2.0))
    scene.collection.objects.link(camera)
    scene.camera = camera
    return {kind: _light(scene, kind, distance) for kind, distance in DISTANCES.items()}


def _light(scene, kind, distance):
    data = bpy.data.lights.new(kind, kind)
    data.energy = 0.0
    if kind == "AREA":
        data.size = 0.05
    thing = bpy.data.objects.new(kind, data)
    thing.matrix_world = orbit_matrix((0.0, 0.0, 0.0), 0.0, 0.0, distance)
    thing.visible_camera = False
    scene.collection.objects.link(thing)
    return thing


def _measured(scene, lights, kind, path: Path) -> float:
    """Radiance of the plane's middle in a Cycles render in which this light alone shines."""
    for other, thing in lights.items():
        thing.hide_render = other != kind
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising = 256, False
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    settings = scene.render.image_settings
    settings.file_format, settings.color_depth = "OPEN_EXR", "32"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(str(path))
    pixels = np.array(image.pixels[:], np.float32).reshape(-1, 4)[:, :3]
    bpy.data.images.remove(image)
    for thing in lights.values():
        thing.hide_render = False
    return float(pixels.mean())


def test_the_brightest_light_in_cycles_is_the_key(scene, lights, tmp_path):
    picture = tmp_path / "light.exr"
    for kind, thing in lights.items():  # equal effect by measurement, not by a formula of ours
        thing.data.energy = 100.0
        thing.data.energy *= LEVEL / _measured(scene, lights, kind, picture)
    levels = {kind: _measured(scene, lights, kind, picture) for kind in lights}
    assert all(math.isclose(level, LEVEL, rel_tol=0.01) for level in levels.values()), levels
    for brighter, thing in lights.items():
        thing.data.energy *= 1.2
        assert _measured(scene, lights, brighter, picture) > 1.15 * max(levels.values())
        roles = scene_context.light_roles(
            scene_context.SceneContext(scene, [bpy.data.objects["Plane"]], thing.location * 0)
        )
        assert roles == {other: "key" if other is thing else "fill" for other in lights.values()}
        thing.data.energy /= 1.2


@pytest.mark.parametrize("kind", DISTANCES)
def test_the_schema_has_the_calibration_of_cycles(scene, lights, tmp_path, kind):
    lights[kind].data.energy = schema.radiometry.unit_energy(kind, DISTANCES[kind])
    assert _measured(scene, lights, kind, tmp_path / "light.exr") == pytest.approx(1.0, rel=0.01)


def test_a_lights_own_exposure_counts(scene, lights):
    if "exposure" not in bpy.types.Light.bl_rna.properties:
        pytest.skip("This Blender's lights have no exposure.")
    for kind, thing in lights.items():
        thing.data.energy = schema.radiometry.unit_energy(kind, DISTANCES[kind])
    lights["POINT"].data.exposure = 0.5
    context = scene_context.SceneContext(scene, [bpy.data.objects["Plane"]], lights["POINT"].location * 0)
    assert scene_context.light_roles(context)[lights["POINT"]] == "key"
