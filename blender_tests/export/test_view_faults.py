# SPDX-License-Identifier: GPL-3.0-or-later
"""What spoils a picture is said before anything is searched for, with the name of the object."""

from contextlib import nullcontext

import bpy
import pytest
from faulty_scenes import AIM, aim, plain
from small_scenes import cube
from vibe_render.core.compat import start_compositor
from vibe_render.core.journal import Journal
from vibe_render.export import notes, reading
from vibe_render.render import final_render
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


def cut_off(scene):
    tree = start_compositor(Journal(), scene)
    for link in list(tree.links):
        tree.links.remove(link)


def black_world(scene):
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.0


def capped(scene):
    cube(scene, "Cap", tuple(scene.camera.location * 0.95 + AIM * 0.05), 0.1).scale = (50.0, 0.1, 50.0)
    aim(bpy.data.objects["Sun"], (0.0, 3.0, 3.0))
    bpy.data.lights["Sun"].energy *= 0.2  # what the floor throws back on its face is no light
    black_world(scene)


def film_is_dark(scene):
    scene.cycles.film_exposure = 0.0


def view_is_dark(scene):
    scene.view_settings.exposure = -15.0


def lights_are_off(scene):
    bpy.data.lights["Sun"].energy = 0.0
    black_world(scene)


CAUSES = {
    cut_off: ("output of its compositor", False),
    capped: ('"Cap" fills the picture', False),
    film_is_dark: ("hardly exposed", False),
    view_is_dark: ("hardly exposed", False),
    lights_are_off: ("no light reaches", True),
}


@pytest.mark.parametrize("cause", CAUSES, ids=lambda cause: cause.__name__)
def test_a_black_picture_has_a_cause_that_light_may_cure(scene, tmp_path, cause):
    plain(scene)
    aim(scene.camera, (0.0, -3.5, 1.0), AIM)
    cause(scene)
    job = exported(scene, tmp_path)
    final_render.render_picture(scene, tmp_path / "before.png", 32, 1)
    assert final_render.is_black(tmp_path / "before.png")
    words, cured = CAUSES[cause]
    with pytest.raises(VibeError, match=words) as refused:
        notes.check_shows(scene, job.filling, lit=False)
    assert refused.value.remedy
    with nullcontext() if cured else pytest.raises(VibeError, match=words):
        notes.check_shows(scene, job.filling, lit=True)


def test_a_lit_picture_is_not_black(scene, tmp_path):
    plain(scene)
    final_render.render_picture(scene, tmp_path / "lit.png", 32, 1)
    assert not final_render.is_black(tmp_path / "lit.png")


def test_an_excluded_collection_is_named_where_nothing_else_is_there(scene, tmp_path):
    plain(scene)
    things = bpy.data.collections.new("Things")
    scene.collection.children.link(things)
    for thing in [o for o in scene.collection.objects if o.type == "MESH"]:
        scene.collection.objects.unlink(thing)
        things.objects.link(thing)
    bpy.context.view_layer.layer_collection.children["Things"].exclude = True
    with pytest.raises(VibeError, match="no mesh") as refused:
        exported(scene, tmp_path)
    assert 'Include "Things"' in refused.value.remedy


def test_the_picture_is_in_another_scene(scene, tmp_path):
    plain(scene)
    menu = bpy.data.scenes.new("Menu")
    menu.camera = scene.camera
    with pytest.raises(VibeError, match='"Menu" has no mesh') as refused:
        exported(menu, tmp_path)
    assert f'"{scene.name}" has meshes' in refused.value.remedy
