# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture that a look is to be like becomes a file, wherever it is; the scene stays as it was."""

import bpy
import numpy as np
import pytest
from PIL import Image
from small_scenes import studio
from vibe_render.core.schema_import import schema
from vibe_render.render import reference
from vibe_render.ui.run import VIBE_OT_run

from proxy_renderer.reference.files import read_reference


@pytest.fixture
def settings(addon):
    studio(addon)
    return addon.vibe


def saved(settings, folder):
    """The picture as the engine reads it, and that Blender has nothing new of it."""
    images = set(bpy.data.images.keys())
    scenes = len(bpy.data.scenes)
    found = read_reference(reference.picture_path(settings.id_data, folder))
    assert set(bpy.data.images.keys()) == images
    assert len(bpy.data.scenes) == scenes
    return found


def drawn(name, light=False, color=(0.8, 0.4, 0.2)):
    """An image that is in Blender only: red below, the color above."""
    image = bpy.data.images.new(name, 8, 4, float_buffer=light)
    pixels = np.ones((4, 8, 4), np.float32)
    pixels[:2, :, :3], pixels[2:, :, :3] = (1.0, 0.0, 0.0), color
    image.pixels.foreach_set(pixels.ravel())
    return image


def test_nothing_is_given_unless_it_is_chosen(settings, tmp_path):
    settings.like = str(tmp_path / "missing.png")
    assert reference.picture_name(settings) == ""
    assert reference.picture_path(settings.id_data, tmp_path) == ""
    assert settings.engine_options(bpy.context).like == ""


def test_a_file_is_found_from_the_blends_folder(settings, tmp_path):
    Image.new("RGB", (6, 4), (10, 200, 30)).save(tmp_path / "still.png")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    settings = bpy.context.scene.vibe
    settings.like_from, settings.like = "FILE", "//still.png"
    assert reference.picture_name(settings) == "still.png"
    assert reference.picture_path(settings.id_data, tmp_path) == str(tmp_path / "still.png")


def test_a_missing_file_is_one_line_and_grays_the_button_out(settings, tmp_path):
    settings.like_from, settings.like = "FILE", str(tmp_path / "missing.png")
    assert "missing.png" in VIBE_OT_run.obstacle(bpy.context)
    with pytest.raises(schema.VibeError, match=r"missing\.png"):
        reference.picture_path(settings.id_data, tmp_path)


def test_an_image_that_is_only_in_blender(settings, tmp_path):
    settings.like_from, settings.like_image = "IMAGE", drawn("Mood")
    found = saved(settings, tmp_path)
    assert found.linear is None
    assert np.allclose(found.display[0, 0], (0.8, 0.4, 0.2), atol=0.003)
    assert np.allclose(found.display[-1, 0], (1.0, 0.0, 0.0), atol=0.003)
    assert bpy.data.images["Mood"].users > 0


def test_light_stays_light(settings, tmp_path):
    settings.like_from, settings.like_image = "IMAGE", drawn("Sky", light=True, color=(4.0, 2.0, 0.25))
    found = saved(settings, tmp_path)
    assert np.allclose(found.linear[0, 0], (4.0, 2.0, 0.25), rtol=0.01)


def test_an_image_whose_file_is_gone(settings, tmp_path):
    Image.new("RGB", (6, 4)).save(tmp_path / "a.png")
    settings.like_from = "IMAGE"
    settings.like_image = bpy.data.images.load(str(tmp_path / "a.png"))
    (tmp_path / "a.png").unlink()
    settings.like_image.reload()
    with pytest.raises(schema.VibeError, match="no pixels"):
        reference.picture_path(settings.id_data, tmp_path)


def test_what_was_rendered_into_a_slot(settings, tmp_path):
    scene = settings.id_data
    settings.like_from = "SLOT"
    scene.render.engine, scene.cycles.samples = "CYCLES", 1
    scene.render.resolution_x = scene.render.resolution_y = 16
    bpy.ops.render.render()
    result = next(image for image in bpy.data.images if image.type == "RENDER_RESULT")
    result.save_render(str(tmp_path / "shown.png"), scene=scene)
    shown, active = read_reference(tmp_path / "shown.png"), result.render_slots.active_index
    settings.like_slot = active + 1
    assert np.abs(saved(settings, tmp_path).display - shown.display).mean() < 0.01
    settings.like_slot = active + 2
    with pytest.raises(schema.VibeError, match="slot"):
        reference.picture_path(scene, tmp_path)
    assert result.render_slots.active_index == active
    settings.like_slot = 99
    with pytest.raises(schema.VibeError, match="slot 99"):
        reference.picture_path(scene, tmp_path)


def test_a_picture_is_enough_to_begin_and_what_is_taken_over_reaches_the_engine(settings):
    settings.prompt = ""
    assert "Describe a mood" in VIBE_OT_run.obstacle(bpy.context)
    settings.like_from, settings.like_image = "IMAGE", drawn("Mood")
    assert "Describe a mood" not in VIBE_OT_run.obstacle(bpy.context)
    assert settings.engine_options(bpy.context).like_only == ()
    settings.like_air = settings.like_materials = False
    settings.like_same = True
    chosen = settings.engine_options(bpy.context)
    assert chosen.like_only == ("light", "grade", "palette")
    assert chosen.like_same


def test_blender_can_paste_pictures():
    assert "clipboard_paste" in dir(bpy.ops.image)


def test_how_panels_say_what_was_asked_for():
    assert reference.request_title("noir", "") == "“noir”"
    assert reference.request_title("", "still.jpg") == "like still.jpg"
    assert reference.request_title("but colder", "still.jpg") == "“but colder” like still.jpg"
