# SPDX-License-Identifier: GPL-3.0-or-later
"""The compositor group computes the contract's formulas, written here once more in numpy."""

import bpy
import numpy as np
import pytest
import small_scenes as scenes
from grade_formula import IDENTITY, reference
from vibe_render.core import compat
from vibe_render.scene import bindings, snapshot
from vibe_render.scene.nodes import grade, owned

WIDTH, HEIGHT = 48, 32
PIVOT = (0.0, 0.0, 0.0)


@pytest.fixture
def picture():
    """Linear colors from black to bright highlights, with an alpha that is not 1."""
    pixels = 2.0 ** np.random.default_rng(5).uniform(-8.0, 3.0, (HEIGHT, WIDTH, 4))
    pixels[0, 0, :3] = 0.0
    pixels[..., 3] = np.linspace(0.25, 1.0, WIDTH)
    return pixels.astype(np.float32)


@pytest.fixture
def stage(scene, picture):
    """A scene whose compositor shows the picture."""
    tree = scenes.compositor(scene)
    image = bpy.data.images.new("Known", WIDTH, HEIGHT, alpha=True, float_buffer=True)
    image.alpha_mode, image.use_half_precision = "PREMUL", False
    image.pixels.foreach_set(picture.ravel())
    node = tree.nodes.new("CompositorNodeImage")
    node.image = image
    tree.links.new(node.outputs["Image"], compat.compositor_output(tree))
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scenes.camera(scene)
    return scene


def composited(scene, tmp_path):
    """(H, W, 4) as the compositor hands it to the view transform, row 0 at the bottom."""
    scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", 1, False
    settings = scene.render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth = "OPEN_EXR", "RGBA", "32"
    settings.exr_codec, scene.render.compositor_precision = "ZIP", "FULL"
    scene.render.filepath = str(tmp_path / "out.exr")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    pixels = np.array(image.pixels[:]).reshape(image.size[1], image.size[0], 4)
    bpy.data.images.remove(image)
    return pixels


def apply(scene, **values):
    keyed = {f"film/{name}": np.atleast_1d(value) for name, value in values.items()}
    assert bindings.write(scene, keyed, (), PIVOT) == {}


@pytest.mark.parametrize(
    "values",
    [
        {"grade_exposure": 1.3},
        {"lift": (0.8, 1.1, 1.25)},
        {"midtone": (0.7, 1.0, 1.4)},
        {"gain": (0.6, 1.0, 1.5)},
        {"lift": (0.75, 1.0, 1.2), "midtone": (1.4, 0.8, 1.0), "gain": (1.5, 0.6, 1.2)},
        {"contrast": 0.5},
        {"contrast": 1.9},
        {"saturation": 0.0},
        {"saturation": 2.0},
        {"hue": -75.0},
        {"grade_gamma": 1.8},
        {"vignette": 0.9},
        {
            "grade_exposure": -0.7, "lift": (0.9, 1.05, 1.1), "midtone": (1.2, 0.9, 1.0), "gain": (1.1, 0.9, 0.8),
            "contrast": 1.4, "saturation": 1.6, "hue": 40.0, "grade_gamma": 0.8, "vignette": 0.5,
        },
    ],
    ids=lambda values: "+".join(values) if len(values) < 5 else "all",
)  # fmt: skip
def test_formulas(stage, picture, tmp_path, values):
    apply(stage, **values)
    out = composited(stage, tmp_path)
    wanted = reference(picture[..., :3].astype(np.float64), **values)
    np.testing.assert_allclose(out[..., :3], wanted, rtol=2e-3, atol=2e-4)
    np.testing.assert_allclose(out[..., 3], picture[..., 3], atol=1e-5)


def test_identity_changes_nothing(stage, picture, tmp_path):
    apply(stage, vignette=0.5)  # makes the group
    apply(stage, vignette=0.0)
    np.testing.assert_allclose(composited(stage, tmp_path), picture, rtol=1e-4, atol=1e-5)


def test_glare_spreads_highlights_and_only_those(stage, tmp_path):
    image = bpy.data.images["Known"]
    pixels = np.full((HEIGHT, WIDTH, 4), 0.2, np.float32)
    pixels[12:20, 20:28, :3] = 8.0
    pixels[..., 3] = 1.0
    image.pixels.foreach_set(pixels.ravel())
    apply(stage, glare=1.0)
    bloom = composited(stage, tmp_path)[..., :3] - pixels[..., :3]
    assert bloom.min() >= -1e-4
    assert bloom[16, 30].min() > 0.05  # close by
    assert bloom[16, 30].min() > 2.0 * bloom[2, 2].max()  # far away
    image.pixels.foreach_set(np.where(pixels > 1.0, 0.8, pixels).ravel())
    assert composited(stage, tmp_path)[16, 30, 0] == pytest.approx(0.2, abs=1e-3)


def test_identity_makes_no_group(scene):
    scenes.camera(scene)
    apply(scene, **IDENTITY)
    assert compat.compositor(scene) is None
    assert not bpy.data.node_groups
    assert not snapshot.exists(scene)


def test_a_scene_without_compositing_renders_through_the_grade(scene, tmp_path):
    scenes.camera(scene)
    scenes.world(scene).node_tree.nodes["Background"].inputs["Color"].default_value = (0.2, 0.4, 0.8, 1.0)
    scene.render.resolution_x, scene.render.resolution_y = 16, 16
    apply(scene, grade_exposure=1.0)
    np.testing.assert_allclose(composited(scene, tmp_path)[8, 8], (0.4, 0.8, 1.6, 1.0), rtol=1e-3)


def test_film_transparency_survives(scene, tmp_path):
    scenes.camera(scene)
    scene.render.resolution_x, scene.render.resolution_y = 16, 16
    scene.render.film_transparent = True
    apply(scene, saturation=0.5)
    assert np.abs(composited(scene, tmp_path)).max() == 0.0


def test_the_artists_chain_stays_before_the_grade(scene, tmp_path):
    scenes.camera(scene)
    scenes.world(scene).node_tree.nodes["Background"].inputs["Color"].default_value = (0.1, 0.1, 0.1, 1.0)
    tree = scenes.compositor(scene)
    next(n for n in tree.nodes if n.bl_idname == "CompositorNodeExposure").inputs["Exposure"].default_value = 2.0
    scene.render.resolution_x, scene.render.resolution_y = 16, 16
    apply(scene, grade_gamma=2.0)
    np.testing.assert_allclose(composited(scene, tmp_path)[8, 8, :3], 0.16, rtol=1e-3)
    (node,) = owned.group_nodes(compat.compositor(scene), grade.NAME)
    assert node.label == "Vibe Grade"
    assert node.use_custom_color
    assert node.parent.label == "Vibe Render"


def test_compositing_that_was_switched_off_stays_out(scene, tmp_path):
    scenes.camera(scene)
    scenes.world(scene).node_tree.nodes["Background"].inputs["Color"].default_value = (0.1, 0.1, 0.1, 1.0)
    tree = scenes.compositor(scene)
    next(n for n in tree.nodes if n.bl_idname == "CompositorNodeExposure").inputs["Exposure"].default_value = 2.0
    scene.render.use_compositing = False
    scene.render.resolution_x, scene.render.resolution_y = 16, 16
    apply(scene, grade_exposure=1.0)
    np.testing.assert_allclose(composited(scene, tmp_path)[8, 8, :3], 0.2, rtol=1e-3)
    snapshot.revert(scene)
    assert not scene.render.use_compositing
    scene.render.use_compositing = True
    np.testing.assert_allclose(composited(scene, tmp_path)[8, 8, :3], 0.4, rtol=1e-3)


def test_an_output_without_a_picture_is_locked(scene):
    tree = scenes.compositor(scene)
    tree.links.clear()
    parameters = bindings.instances(scene, (), PIVOT)
    assert "no picture" in parameters["film/vignette"].locked
    assert parameters["film/exposure"].locked == ""
