# SPDX-License-Identifier: GPL-3.0-or-later
"""Final pictures: the artist's output settings stay, whatever they are."""

import bpy
import numpy as np
import pytest
import small_scenes as scenes
from dump import difference, dump
from vibe_render.core import compat
from vibe_render.render import final_render
from vibe_render.scene import bindings, copies


def layers(picture):
    if hasattr(picture, "media_type"):
        picture.media_type = "MULTI_LAYER_IMAGE"
    picture.file_format, picture.color_depth = "OPEN_EXR_MULTILAYER", "32"


def video(picture):
    if hasattr(picture, "media_type"):
        picture.media_type = "VIDEO"
    picture.file_format = "FFMPEG"


def old_video(picture):
    """As files of Blender before 5 open: the color mode is one that Blender does not take back."""
    video(picture)
    ffmpeg = bpy.context.scene.render.ffmpeg
    ffmpeg.format, ffmpeg.codec = "MKV", "FFV1"
    picture.color_mode = "RGBA"
    ffmpeg.codec = "H264"
    with pytest.raises(TypeError):
        picture.color_mode = picture.color_mode


@pytest.mark.parametrize("output", [layers, video, old_video])
def test_the_artists_output_stays(scene, tmp_path, output):
    subject = scenes.studio(scene)
    scenes.compositor(scene)
    output(scene.render.image_settings)
    scene.render.filepath = "//mine/"
    before = dump()
    final_render.render_picture(scene, tmp_path / "after.png", 32, 1)
    final_render.render_mask(scene, tmp_path / "mask.png", 32, subject)
    copies.evaluate_render(scene, lambda depsgraph: len(depsgraph.objects))
    apart = difference(before, dump())
    assert {path for path in apart if "Render Result" not in path} == set()  # any render makes that
    assert scene.render.image_settings.file_format in ("FFMPEG", "OPEN_EXR_MULTILAYER")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["after.png", "mask.png"]


def test_the_artists_compositor_is_in_the_picture_and_its_files_are_not_written(scene, tmp_path):
    scenes.studio(scene)
    tree = scenes.compositor(scene)
    output = compat.compositor_output(tree)
    files = tree.nodes.new("CompositorNodeOutputFile")
    place = "directory" if hasattr(files, "directory") else "base_path"
    setattr(files, place, str(tmp_path / "theirs"))
    final_render.render_picture(scene, tmp_path / "before.png", 32, 4)
    invert = tree.nodes.new("CompositorNodeInvert")
    source = output.links[0].from_socket
    tree.links.new(source, invert.inputs["Color"])
    tree.links.new(invert.outputs["Color"], output)
    final_render.render_picture(scene, tmp_path / "after.png", 32, 4)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["after.png", "before.png"]
    before, after = (_pixels(tmp_path / f"{name}.png") for name in ("before", "after"))
    assert np.abs(before - after).mean() > 0.05
    assert not files.mute


def test_fog_has_no_noise(scene, tmp_path):
    """Albedo and normals have noise in it too, which a denoiser that trusts them would put into the picture."""
    subject = scenes.studio(scene)
    bindings.write(scene, {"volume/density": (0.15,), "volume/color": (0.9, 0.9, 0.9)}, subject, (0.0, 0.0, 0.0))
    final_render.render_picture(scene, tmp_path / "fog.png", 96, 32)
    pixels = _pixels(tmp_path / "fog.png").reshape(-1, 96, 3)
    steps = np.abs(np.diff(pixels, axis=1)).mean(-1)
    assert np.median(steps) < 0.0025  # of neighbors in what has few edges


def _pixels(path):
    image = bpy.data.images.load(str(path))
    return np.array(image.pixels[:]).reshape(-1, 4)[:, :3]
