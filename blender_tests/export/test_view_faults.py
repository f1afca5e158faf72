# SPDX-License-Identifier: GPL-3.0-or-later
"""What spoils a picture is said before anything is searched for, with the name of the object."""

import bpy
import pytest
from faulty_scenes import AIM, aim, darkness, plain
from small_scenes import cube
from vibe_render.core.compat import start_compositor
from vibe_render.core.journal import Journal
from vibe_render.export import reading
from vibe_render.render import final_render
from vibe_render.render.final_render import black_note
from vibe_render.scene.subject import SubjectChoice

from proxy_renderer.schema import VibeError


def exported(scene, folder):
    return reading.export_scene(scene, folder, SubjectChoice())


@pytest.fixture
def boxed(scene):
    """A scene whose camera stands in a closed box."""
    plain(scene)
    return scene, cube(scene, "Box", tuple(scene.camera.location), 0.5)


def test_a_camera_inside_something(boxed, tmp_path):
    scene, _ = boxed
    job = exported(scene, tmp_path)
    assert job.view_notes == job.warnings[:1]
    assert 'inside "Box"' in job.view_notes[0]


def test_what_only_renders_show_and_fills_the_picture(boxed, tmp_path):
    scene, box = boxed
    box.hide_viewport = True
    with pytest.raises(VibeError, match='"Box" fills the picture') as refused:
        exported(scene, tmp_path)
    assert "Outliner" in refused.value.remedy


def test_a_usual_view(scene, tmp_path):
    plain(scene)
    aim(scene.camera, (0.9, -2.1, 1.0), AIM)
    assert exported(scene, tmp_path).view_notes == []


def test_a_black_picture(scene, tmp_path):
    subject = plain(scene)
    final_render.render_picture(scene, tmp_path / "lit.png", 32, 1)
    darkness(scene, subject)
    final_render.render_picture(scene, tmp_path / "dark.png", 32, 1)
    assert black_note(scene, tmp_path / "lit.png") == ""
    assert "no light" in black_note(scene, tmp_path / "dark.png")


def test_a_compositor_that_gives_nothing(scene, tmp_path):
    plain(scene)
    tree = start_compositor(Journal(), scene)
    for link in list(tree.links):
        tree.links.remove(link)
    final_render.render_picture(scene, tmp_path / "cut.png", 32, 1)
    assert "output of its compositor" in black_note(scene, tmp_path / "cut.png")


def test_the_picture_is_in_another_scene(scene, tmp_path):
    plain(scene)
    menu = bpy.data.scenes.new("Menu")
    menu.camera = scene.camera
    with pytest.raises(VibeError, match='"Menu" has no mesh') as refused:
        exported(menu, tmp_path)
    assert f'"{scene.name}" has meshes' in refused.value.remedy
