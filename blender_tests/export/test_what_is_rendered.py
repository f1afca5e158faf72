# SPDX-License-Identifier: GPL-3.0-or-later
"""What hides, replaces or multiplies: the prediction is near the render, or a note names the property."""

import os
import subprocess
import sys
from pathlib import Path

import bpy
import dump
import numpy as np
import pytest
import torch
from marks import few_of
from PIL import Image
from vibe_render.core import names, rendered
from vibe_render.export import reading
from vibe_render.render import anchors, final_render
from vibe_render.scene import bindings, copies, snapshot
from vibe_render.scene.subject import SubjectChoice

from lab.blender.scenes import properties
from lab.blender.scenes.properties import hiding, imaging, lighting
from proxy_renderer.color.tensors import ciede2000, lab_from_srgb
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import load_scene

QUICK = {hiding.disabled_collection, hiding.holdout_material, lighting.glowing_instances, imaging.compositor}
WIDTH = 64
NEAR = 1.5  # CIEDE2000


def prediction_error(scene, folder, values=None):
    """Mean CIEDE2000 between the plain proxy and a Cycles render of a scene, whose job is in the folder."""
    path = folder / "render.png"
    with torch.no_grad():
        data = load_scene(folder)
        height = round(WIDTH * data.resolution[1] / data.resolution[0])
        tensors = {key: torch.tensor(value) for key, value in (values or {}).items()}
        predicted = Proxy(data, (WIDTH, height)).render(tensors).display
        final_render.render_picture(scene, path, WIDTH, 64)
        with Image.open(path) as image:
            flat = Image.new("RGBA", image.size, "black")
            flat.alpha_composite(image.convert("RGBA"))
        shown = torch.from_numpy(np.asarray(flat.convert("RGB"), np.float32) / 255)
        return float(ciede2000(lab_from_srgb(predicted), lab_from_srgb(shown)).mean())


def names_of(graph):
    """The objects that a render's dependency graph shows; texts and the like come a second time as meshes."""
    return {item.object.original.name for item in graph.object_instances if item.show_self}


@pytest.mark.parametrize("add", few_of(properties.HONORED, QUICK), ids=lambda add: add.__name__)
def test_the_prediction_is_near_the_render_and_everything_comes_back(scene, tmp_path, add):
    properties.build(scene, add)
    before = dump.contents()
    final = copies.evaluate_render(scene, names_of)
    assert {thing.original.name for thing, *_ in rendered.instances(scene)} == final
    reading.export_scene(scene, tmp_path, SubjectChoice())
    assert prediction_error(scene, tmp_path) < NEAR
    snapshot.revert(scene)
    assert dump.difference(before, dump.contents()) == {}


@pytest.mark.parametrize("add", properties.REPORTED, ids=lambda add: add.__name__)
def test_a_note_names_what_is_left_out(scene, tmp_path, add):
    properties.build(scene, add)
    warnings = reading.export_scene(scene, tmp_path, SubjectChoice(), measure=False).warnings
    assert any(properties.REPORTED[add] in warning for warning in warnings), warnings


def test_a_plain_scene_needs_no_note(scene):
    properties.build(scene)
    assert rendered.image_notes(scene) == []
    assert [o.name for o in rendered.lights(scene)] == ["Sun"]


@pytest.mark.parametrize("add", [lighting.portal, hiding.disabled_collection, hiding.hidden_instancer])
def test_what_gives_no_light_is_no_light(scene, tmp_path, add):
    properties.build(scene, add)
    job = reading.export_scene(scene, tmp_path, SubjectChoice(), measure=False)
    assert not any(key.startswith("light/Cold") for key in job.instances)
    assert [light.name for light in load_scene(tmp_path).lights] == ["Sun"]


def test_glowing_instances_are_light_enough(scene, tmp_path):
    properties.build(scene, lighting.glowing_instances)
    job = reading.export_scene(scene, tmp_path, SubjectChoice(), measure=False)
    assert not any(key.startswith("light/") for key in job.instances)


def test_the_artists_light_groups_come_back(scene, tmp_path):
    properties.build(scene)
    scene.view_layers[0].lightgroups.add(name="mine")
    scene.objects["Sun"].lightgroup = scene.world.lightgroup = "mine"
    before = dump.contents()
    anchors.render_anchor(scene, tmp_path / "a.exr", {}, size=32, samples=1)
    assert dump.difference(before, dump.contents()) == {}


def test_what_is_no_mesh_is_said_to_be_left_out(scene, tmp_path):
    properties.build(scene)
    scene.collection.objects.link(bpy.data.objects.new("Smoke", bpy.data.volumes.new("Smoke")))
    warnings = reading.export_scene(scene, tmp_path, SubjectChoice(), measure=False).warnings
    assert any("Smoke is a volume object" in warning for warning in warnings)


CONFIG = """ocio_profile_version: 2
search_path: ""
strictparsing: true
luma: [0.2126, 0.7152, 0.0722]
roles:
  aces_interchange: Interchange
  color_picking: Code
  data: Raw
  default_byte: Code
  default_float: Wide
  default_sequencer: Code
  scene_linear: Wide
  texture_paint: Code
file_rules:
  - !<Rule> {name: Default, colorspace: Code}
displays:
  Monitor:
    - !<View> {name: Studio, colorspace: Code}
active_displays: [Monitor]
active_views: [Studio]
colorspaces:
  - !<ColorSpace>
    name: Interchange
  - !<ColorSpace>
    name: Wide
    to_scene_reference: !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}
  - !<ColorSpace>
    name: Code
    to_scene_reference: !<GroupTransform>
      children:
        - !<ExponentWithLinearTransform> {gamma: [2.4, 2.4, 2.4, 1], offset: [0.055, 0.055, 0.055, 0]}
        - !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}
  - !<ColorSpace>
    name: Raw
    isdata: true
"""
"""A studio's color management: no color space has a name that Blender's own has."""


@pytest.mark.parametrize("name", few_of(["file", "ocio://default"], ["file"]))
def test_a_studios_configuration_has_any_names(tmp_path, name):
    config = tmp_path / "studio.ocio"
    config.write_text(CONFIG, encoding="utf-8")
    chosen = str(config) if name == "file" else name
    script = (
        "import sys, bpy; from pathlib import Path; import test_what_is_rendered as tests\n"
        "folder = Path(sys.argv[1]); bpy.ops.wm.read_factory_settings(use_empty=True)\n"
        "scene = bpy.context.scene; subject = tests.properties.build(scene)\n"
        "tests.reading.export_scene(scene, folder, tests.SubjectChoice())\n"
        "tests.final_render.render_mask(scene, folder / 'mask.png', 32, [subject])\n"
        "print('error', tests.prediction_error(scene, folder))\n"
    )
    tests = Path(__file__).parents[1]
    paths = map(str, (tests / "export", tests, tests.parent / "tests", tests.parent, tests.parent / "addon"))
    found = subprocess.run(
        [sys.executable, "-c", script, str(tmp_path / "job")],
        env={**os.environ, "OCIO": chosen, "PYTHONPATH": os.pathsep.join(paths)},
        capture_output=True,
        text=True,
        timeout=500,
    )
    lines = [line for line in found.stdout.splitlines() if line.startswith("error ")]
    assert lines, found.stderr[-2000:]
    assert float(lines[0].split()[1]) < NEAR
    assert load_scene(tmp_path / "job").film.ocio == chosen


def test_a_lamp_of_a_background_set_lights_and_stays(scene, tmp_path):
    properties.build(scene, hiding.background_set)
    job = reading.export_scene(scene, tmp_path, SubjectChoice(), measure=False)
    assert "Set" in job.instances["light/Cold/power"].locked
    left = bindings.write(scene, {"light/Cold/power": (5.0,)}, job.analysis.objects, job.analysis.pivot)
    assert left.keys() == {"light/Cold/power"}


def test_an_override_locks_all_materials_and_says_why(scene, tmp_path):
    properties.build(scene, hiding.material_override)
    job = reading.export_scene(scene, tmp_path, SubjectChoice(), measure=False)
    assert job.analysis.geometry.materials == ["Clay"]
    reasons = {i.locked for key, i in job.instances.items() if key.startswith(("material/", "volume/"))}
    assert all("Clay" in reason for reason in reasons)


def test_the_world_that_a_view_layer_shows_is_the_one_that_changes(scene, tmp_path):
    properties.build(scene, lighting.world_override)
    before = dump.contents()
    job = reading.export_scene(scene, tmp_path, SubjectChoice(), measure=False)
    assert job.instances["world/color"].value == pytest.approx((0.6, 0.3, 0.1))
    bindings.write(scene, {"world/strength": (0.3,)}, job.analysis.objects, job.analysis.pivot)
    background = scene.view_layers[0].world_override.node_tree.nodes["Background"]
    assert background.inputs["Strength"].default_value == pytest.approx(0.3)
    snapshot.revert(scene)
    assert dump.difference(before, dump.contents()) == {}


@pytest.mark.parametrize("add", few_of([lighting.world_in_a_group, lighting.computed_turn], [lighting.computed_turn]))
def test_a_world_inside_a_group_turns_and_dims_in_its_own_scene_alone(scene, tmp_path, add):
    properties.build(scene, add)
    before = dump.contents()
    job = reading.export_scene(scene, tmp_path, SubjectChoice())
    turn = job.instances["world/rotation"].value[0]
    values = {"world/rotation": (turn + 70.0,), "world/strength": (0.5,), "world/tint": (1.0, 0.7, 0.5)}
    assert bindings.write(scene, values, job.analysis.objects, job.analysis.pivot) == {}
    assert bindings.read(scene, job.analysis.objects, job.analysis.pivot)["world/rotation"] == pytest.approx(
        values["world/rotation"]
    )
    group = bpy.data.worlds["Night"].node_tree.nodes["Group"].node_tree
    assert group.name == "HDRI nodes"
    assert len(group.nodes) == 8 + (add is lighting.computed_turn)
    assert prediction_error(scene, tmp_path, values) < NEAR
    snapshot.revert(scene)
    assert dump.difference(before, dump.contents()) == {}


@pytest.mark.parametrize("marks", [b"\xfc\xe4\xf6\xdf", b"\xe4\xb8\xad\xe6"])
def test_names_that_are_no_utf8_become_readable(scene, tmp_path, marks):
    subject = properties.build(scene)
    for block in (subject, subject.data, subject.data.materials[0], subject.data.uv_layers[0]):
        block.name = "ThingXQZJ"
    path = tmp_path / "names.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=False)
    path.write_bytes(path.read_bytes().replace(b"XQZJ", marks))
    bpy.ops.wm.open_mainfile(filepath=str(path))
    job = reading.export_scene(bpy.context.scene, tmp_path / "job", SubjectChoice())
    assert any("no UTF-8" in warning for warning in job.warnings)
    texts = {o.name for o in bpy.context.scene.objects}
    assert "Thing中" in texts or "Thingüäöß" in texts
    assert names.note() == ""
