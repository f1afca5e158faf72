# SPDX-License-Identifier: GPL-3.0-or-later
"""Bare meshes on the stage: all formats, all stages, framed; and the demo scene."""

import bpy
import numpy as np
import pytest
from vibe_render.core.schema_import import options
from vibe_render.export import analysis
from vibe_render.render import final_render
from vibe_render.scene.stage import DEMO_SUBJECT, build_demo, build_stage
from vibe_render.scene.subject import SubjectChoice

from proxy_renderer.schema import VibeError

TETRAHEDRON = [(0.0, 0.0, 0.0), (7.0, 0.0, 0.0), (0.0, 5.0, 0.0), (0.0, 0.0, 3.0)]
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]


def write_mesh(path):
    """A tetrahedron in the format of the suffix."""
    vertices = "".join(f"v {x} {y} {z}\n" for x, y, z in TETRAHEDRON)
    if path.suffix == ".obj":
        path.write_text(vertices + "".join("f {} {} {}\n".format(*(i + 1 for i in f)) for f in FACES))
    elif path.suffix == ".ply":
        head = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        head += "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
        path.write_text(head + vertices.replace("v ", "") + "".join("3 {} {} {}\n".format(*f) for f in FACES))
    elif path.suffix == ".stl":
        loops = ("".join("vertex {} {} {}\n".format(*TETRAHEDRON[i]) for i in f) for f in FACES)
        facets = "".join(f"facet normal 0 0 0\nouter loop\n{loop}endloop\nendfacet\n" for loop in loops)
        path.write_text(f"solid t\n{facets}endsolid t\n")
    else:
        bpy.ops.wm.read_factory_settings(use_empty=True)
        mesh = bpy.data.meshes.new("t")
        mesh.from_pydata(TETRAHEDRON, [], FACES)
        bpy.context.scene.collection.objects.link(bpy.data.objects.new("t", mesh))
        bpy.ops.export_scene.gltf(filepath=str(path))
    return path


@pytest.mark.parametrize("suffix", [".obj", ".ply", ".stl", ".glb"])
def test_every_format_stands_on_the_stage_and_fills_the_picture(tmp_path, suffix):
    scene = build_stage(write_mesh(tmp_path / f"thing{suffix}"))
    staged = analysis.analyze(scene, SubjectChoice(selected=True))
    low, high = np.array(staged.low), np.array(staged.high)
    assert low[2] == pytest.approx(0.0, abs=1e-5)
    assert np.linalg.norm(high - low) / 2 == pytest.approx(1.0, abs=1e-4)
    np.testing.assert_allclose((low + high)[:2], 0.0, atol=1e-5)
    rows, columns = np.nonzero(np.isin(staged.visible.object, np.nonzero(staged.is_subject)[0]))
    assert min(rows.min(), columns.min()) >= 2  # within the frame, and large in it
    assert max(rows.max(), columns.max()) <= 45
    assert max(np.ptp(rows), np.ptp(columns)) >= 24


def test_a_mesh_stands_as_its_skeleton_poses_it(tmp_path):
    """The file has its mesh ten times as large as it is shown."""
    path = write_mesh(tmp_path / "still.glb")
    armature = bpy.data.objects.new("Bones", bpy.data.armatures.new("Bones"))
    thing = bpy.data.objects["t"]
    bpy.context.scene.collection.objects.link(armature)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    armature.data.edit_bones.new("All").tail = (0.0, 0.0, 1.0)
    bpy.ops.object.mode_set(mode="POSE")
    armature.pose.bones["All"].scale = (0.1, 0.1, 0.1)
    bpy.ops.object.mode_set(mode="OBJECT")
    thing.parent = armature
    thing.modifiers.new("Bones", "ARMATURE").object = armature
    thing.vertex_groups.new(name="All").add(range(4), 1.0, "REPLACE")
    bpy.ops.export_scene.gltf(filepath=str(path), export_rest_position_armature=False)
    staged = analysis.analyze(build_stage(path), SubjectChoice(selected=True))
    size = np.linalg.norm(np.array(staged.high) - np.array(staged.low)) / 2
    assert size == pytest.approx(1.0, abs=1e-3)
    assert {o.name for o in staged.objects} == {"t"}


@pytest.mark.parametrize("kind", options.STAGES)
def test_the_stage_is_not_the_subject_and_fills_the_frame(tmp_path, kind):
    scene = build_stage(write_mesh(tmp_path / "thing.obj"), kind)
    staged = analysis.analyze(scene, SubjectChoice())
    names = [name for (name, _), chosen in zip(staged.geometry.objects, staged.is_subject, strict=True) if chosen]
    assert names == ["thing"]
    assert ("Stage" in staged.geometry.materials) == (kind != "none")
    if kind == "cyclorama":
        assert (staged.visible.object >= 0).all()
    assert scene.view_settings.view_transform == "AgX"


def test_the_picture_is_well_exposed(tmp_path):
    scene = build_stage(write_mesh(tmp_path / "thing.obj"))
    final_render.render_picture(scene, tmp_path / "before.png", 48, 4)
    image = bpy.data.images.load(str(tmp_path / "before.png"))
    assert tuple(image.size) == (48, 48)
    values = np.empty(48 * 48 * 4, np.float32)
    image.pixels.foreach_get(values)
    gray = values.reshape(-1, 4)[:, :3].mean(1)
    assert 0.3 < gray.mean() < 0.7
    assert gray.max() < 0.98
    assert np.quantile(gray, 0.95) - np.quantile(gray, 0.05) > 0.15


def test_the_mask_shows_the_subject_alone(tmp_path):
    scene = build_stage(write_mesh(tmp_path / "thing.obj"))
    staged = analysis.analyze(scene, SubjectChoice(selected=True))
    settings = scene.render.film_transparent, scene.cycles.samples, scene.world
    final_render.render_mask(scene, tmp_path / "mask.png", 48, staged.objects)
    assert (scene.render.film_transparent, scene.cycles.samples, scene.world) == settings
    assert not any(thing.is_holdout for thing in scene.objects)
    image = bpy.data.images.load(str(tmp_path / "mask.png"))
    values = np.empty(48 * 48 * 4, np.float32)
    image.pixels.foreach_get(values)
    mask = values.reshape(48, 48, 4)[..., 0]
    on_subject = np.isin(staged.visible.object, np.nonzero(staged.is_subject)[0])
    assert np.abs(mask - on_subject).mean() < 0.02
    assert ((mask > 0.02) & (mask < 0.98)).any()  # antialiased


NEW = '{"asset": {"version": "2.0"}, "extensionsUsed": ["ADOBE_new_one"], "extensionsRequired": ["ADOBE_new_one"]}'


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("a.obj", "hello\n", "no mesh with faces"),
        ("a.ply", "hello\n", "a.ply"),
        ("a.glb", "hello\n", "a.glb cannot be read"),
        ("a.stl", "hello\n", "a.stl"),
        ("a.fbx", "hello\n", "is not a mesh that can be staged"),
        ("point.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n", "no size"),
        ("short.gltf", "{}", "short.gltf cannot be read"),
        ("new.gltf", NEW, "ADOBE_new_one"),
    ],
)
def test_broken_files(tmp_path, name, content, said):
    (tmp_path / name).write_text(content)
    with pytest.raises(VibeError, match=said):
        build_stage(tmp_path / name)


def test_a_missing_file_and_an_unknown_stage(tmp_path):
    with pytest.raises(VibeError, match="There is no file"):
        build_stage(tmp_path / "missing.obj")
    with pytest.raises(VibeError, match="no stage 'beach'"):
        build_stage(write_mesh(tmp_path / "thing.obj"), "beach")


def test_the_demo_has_what_a_demo_needs():
    scene = build_demo()
    staged = analysis.analyze(scene, SubjectChoice((DEMO_SUBJECT,)))
    assert [o.name for o in staged.objects] == [DEMO_SUBJECT]
    assert len(staged.geometry.materials) >= 4
    assert sum(o.type == "LIGHT" for o in scene.objects) == 2
    share = np.isin(staged.visible.object, np.nonzero(staged.is_subject)[0]).mean()
    assert 0.08 < share < 0.5
