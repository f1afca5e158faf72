# SPDX-License-Identifier: GPL-3.0-or-later
"""Every parameter is written and read back, or says why it is left alone."""

import math

import bpy
import pytest
import small_scenes as scenes
from vibe_render.core import compat
from vibe_render.scene import bindings, prepare

from proxy_renderer import schema

PIVOT = (0.0, 0.0, 0.0)


def instances(scene, subject):
    return bindings.instances(scene, subject, PIVOT)


def test_every_schema_row_has_exactly_one_binding():
    assert [b.parameter for b in bindings.BINDINGS] == list(schema.PARAMETERS)


def test_the_scenes_of_these_tests_have_every_parameter():
    families = set()
    for build in scenes.ALL.values():
        bpy.ops.wm.read_factory_settings(use_empty=True)
        scene = bpy.context.scene
        families |= {i.parameter.family for i in instances(scene, build(scene)).values()}
    assert families == set(schema.FAMILIES)


@pytest.mark.parametrize("name", scenes.ALL)
@pytest.mark.parametrize("level", ["lower", pytest.param("default", marks=pytest.mark.slow), "upper"])
def test_what_is_written_is_read_back(scene, name, level):
    subject = scenes.ALL[name](scene)
    prepare.prepare_scene(scene, subject)
    free = {k: i for k, i in instances(scene, subject).items() if not i.locked}
    # One parameter at a time, so that each has to find or make its own place; fog first, it makes the box.
    bindings.write(scene, {"volume/density": [0.02]}, subject, PIVOT)
    for key, instance in free.items():
        low, high = instance.lower, instance.upper
        default = [min(max(instance.parameter.default, a), b) for a, b in zip(low, high, strict=True)]
        value = {"lower": low, "default": default, "upper": high}[level]
        assert bindings.write(scene, {key: value}, subject, PIVOT) == {}
        assert_equal(bindings.read(scene, subject, PIVOT).get(key, value), value, key)


def assert_equal(read, written, key):
    for a, b in zip(read, written, strict=True):
        error = abs((a - b + 180.0) % 360.0 - 180.0) if key.endswith("azimuth") else abs(a - b)
        assert error <= 2e-4 + 1e-5 * abs(b), (key, read, written)


def test_all_at_once_is_read_back(scene):
    subject = scenes.studio(scene)
    wanted = {k: tuple(0.7 * a + 0.3 * b for a, b in zip(i.lower, i.upper, strict=True))
              for k, i in instances(scene, subject).items() if not i.locked}  # fmt: skip
    assert bindings.write(scene, wanted, subject, PIVOT) == {}
    for key, value in bindings.read(scene, subject, PIVOT).items():
        assert_equal(value, wanted[key], key)


@pytest.mark.parametrize("mode", ["XYZ", "ZYX", "QUATERNION", "AXIS_ANGLE"])
def test_an_orbit_keeps_the_aim_and_comes_back(scene, mode):
    subject = scenes.studio(scene)
    camera = scene.camera
    camera.rotation_mode = mode
    if mode == "QUATERNION":
        camera.rotation_quaternion = (0.7, 0.71, 0.05, 0.02)
    scene.view_layers[0].update()
    before, value = camera.matrix_world.copy(), bindings.read(scene, subject, PIVOT)
    orbit = {k: v for k, v in value.items() if k.startswith("camera/")}
    moved = {"camera/azimuth": (70.0,), "camera/elevation": (-20.0,), "camera/distance": (3.0,)}
    bindings.write(scene, moved, subject, PIVOT)
    assert (camera.matrix_world.translation - before.translation).length > 3.0
    bindings.write(scene, orbit, subject, PIVOT)
    for a, b in zip(before, camera.matrix_world, strict=True):
        assert (a - b).length < 1e-5


def test_a_lamp_straight_above_can_move_away_and_back_in_one_go(scene):
    subject = scenes.studio(scene)
    lamp = bpy.data.objects["Area"]
    lamp.location, lamp.rotation_euler = (0.0, 0.0, 4.0), (0.0, 0.0, 0.3)
    scene.view_layers[0].update()
    before = lamp.matrix_world.copy()
    bindings.write(scene, {"light/Area/azimuth": (50.0,), "light/Area/elevation": (30.0,)}, subject, PIVOT)
    assert lamp.location.z == pytest.approx(2.0, abs=1e-5)
    # It still points at the subject.
    assert (lamp.matrix_world.to_3x3().col[2] - lamp.location.normalized()).length < 1e-5
    bindings.write(scene, {"light/Area/azimuth": (0.0,), "light/Area/elevation": (90.0,)}, subject, PIVOT)
    for a, b in zip(before, lamp.matrix_world, strict=True):
        assert (a - b).length < 1e-5


def test_numbers_mean_what_blender_means(scene):
    subject = scenes.studio(scene)
    values = {
        "camera/fov": (50.0,), "light/Sun/angle": (10.0,), "light/Area/size": (2.0,), "film/hue": (90.0,),
        "light/Point/temperature": (3000.0,), "material/Body/base_color": (0.1, 0.2, 0.3),
    }  # fmt: skip
    area = bpy.data.lights["Area"]
    area.size, area.size_y = 1.0, 0.25
    assert bindings.write(scene, values, subject, PIVOT) == {}
    assert scene.camera.data.angle == pytest.approx(math.radians(50.0))
    assert bpy.data.lights["Sun"].angle == pytest.approx(math.radians(10.0))
    assert (area.size, area.size_y) == (2.0, 0.5)
    assert bpy.data.lights["Point"].use_temperature
    assert not bpy.data.lights["Spot"].use_temperature
    base = scenes.shader(bpy.data.materials["Body"]).inputs["Base Color"].default_value
    assert tuple(base) == pytest.approx((0.1, 0.2, 0.3, 1.0))
    grade = next(n for n in compat.compositor(scene).nodes if n.type == "GROUP")
    assert grade.inputs["Hue"].default_value == pytest.approx(math.pi / 2.0)


def test_roles(scene):
    subject = scenes.studio(scene)
    for lamp in bpy.data.lights:
        lamp.energy = 1.0
    bpy.data.objects["Spot"].location = (0.0, 4.0, 1.0)
    bpy.data.lights["Point"].energy = 5000.0
    parameters = instances(scene, subject)
    assert parameters["light/Point/power"].role == "key"
    assert parameters["light/Spot/power"].role == "rim"
    assert parameters["material/Body/roughness"].role == "subject"
    assert parameters["material/Ground/roughness"].role == "surroundings"


def test_what_the_camera_does_not_see_has_no_parameters(scene):
    subject = scenes.studio(scene)
    behind, hidden = scenes.cube(scene, "Behind", (0.0, -9.0, 1.0)), scenes.cube(scene, "Hidden")
    scenes.principled("Behind", behind)
    scenes.principled("Hidden", hidden)
    hidden.hide_render = True
    owners = {i.owner for i in instances(scene, subject).values()}
    assert "Body" in owners
    assert not {"Behind", "Hidden"} & owners


def test_instances_of_a_collection_are_seen(scene):
    subject = scenes.studio(scene)
    inside = bpy.data.collections.new("Inside")
    twig = scenes.cube(scene, "Twig")
    scenes.principled("Bark", twig)
    inside.objects.link(twig)
    scene.collection.objects.unlink(twig)
    tree = bpy.data.objects.new("Tree", None)
    tree.instance_type, tree.instance_collection = "COLLECTION", inside
    scene.collection.objects.link(tree)
    assert instances(scene, [*subject, tree])["material/Bark/roughness"].role == "subject"


def test_bad_values_change_nothing(scene):
    subject = scenes.studio(scene)
    before = bindings.read(scene, subject, PIVOT)
    for bad in ({"film/exposure": (math.nan,)}, {"film/lift": (1.0,)}, {"film/gamma": (math.inf,)}):
        with pytest.raises(schema.VibeError):
            bindings.write(scene, {"film/exposure": (1.0,), "film/vignette": (0.5,)} | bad, subject, PIVOT)
    assert bindings.read(scene, subject, PIVOT) == before
    assert bindings.write(scene, {"light/Nobody/power": (1.0,)}, subject, PIVOT).keys() == {"light/Nobody/power"}
